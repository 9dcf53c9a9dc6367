// Live runs in maps of a few runs, whose tables are made up.
#include <cmath>

#include "cmocka.hpp"
#include "eval/trust_trial.hpp"

using namespace vdna;

namespace
{

constexpr uint32_t runs = 4;

// Run b is the better localised in, the lower b.
record::TrustTables tables()
{
    record::TrustTables tables;
    tables.frames.assign(runs, 3); // three windows of a frame
    tables.own_scale.assign(runs, 0.5);
    tables.correlation.assign(runs, 1);
    for (uint32_t a = 0; a < runs; a++)
        for (uint32_t b = 0; b < runs; b++) {
            vdna_trust_cell cell;
            const double recalls[] = {0.9, 0.7, 0.5, 0.3};
            for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS; i++) {
                const double no = i < 3 && a != b ? 1 : NAN;
                cell.nearest[i] = no * (0.1 + 0.05 * b);
                cell.likeness[i] = no * 0.2;
                cell.recall[i] = no * recalls[b];
                cell.distance[i] = no * (1 + b + 0.1 * a);
            }
            tables.cells.push_back(cell);
        }
    return tables;
}

eval::LiveFrames live(uint32_t frames)
{
    eval::LiveFrames live;
    live.frames = frames;
    for (uint32_t i = 0; i < frames; i++)
        for (uint32_t b = 0; b < runs; b++) {
            live.nearest.push_back(0.1 + 0.05 * b + 0.001 * ((i + b) % 2));
            live.likeness.push_back(0.2);
        }
    live.bins = live.bins_early = {1, 2, 3, 4};
    return live;
}

void the_constant_is_the_mean_recall_of_the_other_runs(void **)
{
    const eval::Trial trial = eval::try_trust(tables(), VDNA_TRUST_CENTRED, live(20));
    for (uint32_t b = 0; b < runs; b++)
        assert_true(std::fabs(trial.constant[b] - (0.9 - 0.2 * b)) < 1e-12);
}

void a_clear_choice_settles_early_and_stays(void **)
{
    const eval::Trial trial = eval::try_trust(tables(), VDNA_TRUST_CENTRED, live(20));
    assert_int_equal(trial.settled_frames, VDNA_TRUST_SETTLED_FRAMES);
    assert_int_equal(trial.settled_choice, 0);
    assert_int_equal(trial.full.answer.choice, 0);
    assert_int_equal(trial.full.answer.frames, 20);
    assert_int_equal(trial.early->answer.frames, VDNA_TRUST_SETTLED_FRAMES);
}

void a_short_warmup_has_no_early_forecast_and_ends_with_its_choice(void **)
{
    const eval::Trial trial = eval::try_trust(tables(), VDNA_TRUST_CENTRED, live(9));
    assert_false(trial.early.has_value());
    assert_int_equal(trial.settled_frames, 0);
    assert_int_equal(trial.settled_choice, trial.full.answer.choice);
    assert_int_equal(trial.full.predictions[0].reason, VDNA_TRUST_REASON_NONE);
}

void the_angle_is_that_of_nearest_distances_alone(void **)
{
    // Half the angle of a prediction is theirs, and half that of transfer.
    const eval::Trial trial = eval::try_trust(tables(), VDNA_TRUST_CENTRED, live(20));
    for (uint32_t b = 0; b < runs; b++) {
        const vdna_trust_prediction &p = trial.full.predictions[b];
        const double angle = (trial.full.angle[b] + std::asin(std::sqrt(p.transfer))) / 2;
        assert_true(std::fabs(std::asin(std::sqrt(p.recall)) - angle) < 1e-9);
    }
}

void some_runs_keep_what_is_theirs(void **)
{
    const std::vector<uint32_t> some = {1, 3};
    const record::TrustTables part = eval::tables_of(tables(), some);
    assert_true(part.frames.size() == 2 && part.cells.size() == 4);
    assert_true(part.cells[1].recall[0] == 0.3 && part.cells[2].recall[0] == 0.7);
    const eval::LiveFrames frames = eval::frames_in(live(2), runs, some);
    assert_true(frames.frames == 2 && frames.nearest.size() == 4 && frames.likeness.size() == 4);
    assert_true(frames.nearest[1] == live(2).nearest[3] && frames.nearest[2] == live(2).nearest[5]);
    assert_true(frames.bins == (std::vector<double>{2, 4}));
}

void two_runs_have_too_few_labels_to_predict(void **)
{
    const std::vector<uint32_t> some = {0, 1};
    const eval::Trial trial = eval::try_trust(eval::tables_of(tables(), some), VDNA_TRUST_CENTRED,
                                              eval::frames_in(live(20), runs, some));
    assert_int_equal(trial.full.predictions[0].reason, VDNA_TRUST_REASON_FEW_RUNS);
    assert_true(std::isnan(trial.full.angle[0]) && trial.full.predictions[0].nearest > 0);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_constant_is_the_mean_recall_of_the_other_runs),
        cmocka_unit_test(a_clear_choice_settles_early_and_stays),
        cmocka_unit_test(a_short_warmup_has_no_early_forecast_and_ends_with_its_choice),
        cmocka_unit_test(the_angle_is_that_of_nearest_distances_alone),
        cmocka_unit_test(some_runs_keep_what_is_theirs),
        cmocka_unit_test(two_runs_have_too_few_labels_to_predict),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
