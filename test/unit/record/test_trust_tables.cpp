// What a map knows about itself, on experiences of two neurons.
#include <cmath>
#include <cstring>
#include <limits>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/histogram.hpp>
#include <vdna/emd.h>
#include <vdna/geodesy.h>
#include <vdna/int8.h>

#include "cmocka.hpp"
#include "record/played_recall.hpp"
#include "record/trust_tables.hpp"

using vdna::record::KnownTables;
using vdna::record::make_trust_tables;
using vdna::record::Members;
using vdna::record::TrustTables;

namespace
{

constexpr uint32_t bins = 8;
const std::vector<float> range = {-2, 2, -2, 2};

// A drive past the places 0 to frames - 1, as its camera of this offset sees it.
struct Drive {
    explicit Drive(const char *name, uint32_t frames = 18, float offset = 0)
        : dna(range, bins), places(frames), codes(2 * size_t{frames}), scales(frames)
    {
        for (uint32_t f = 0; f < frames; f++) {
            const float x = static_cast<float>(f) * 0.1f;
            const float values[] = {std::cos(x) + offset, std::sin(x)};
            const vdna_activations tap = {values, 2, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
            embeddings.insert(embeddings.end(), values, values + 2);
            vdna_int8_encode(values, 2, &codes[2 * size_t{f}], &scales[f]);
            dna.add(&tap, 1, name);
            places[f] = f;
        }
        std::strncpy(experience.name, name, sizeof experience.name - 1);
        std::strcpy(experience.identity.taps, "top:2:1");
        std::strcpy(experience.identity.embedding, "mid last=top centred");
        experience.identity.neurons = experience.identity.dim = 2;
        experience.identity.bins = bins;
        experience.identity.range = range.data();
        experience.frames = frames;
        experience.counts = dna->counts;
        experience.mass = dna->mass;
        experience.embeddings = embeddings.data();
        experience.frame_place = places.data();
        experience.last_layer = codes.data();
        experience.last_layer_scale = scales.data();
        experience.last_layer_dim = 2;
    }
    Drive(const Drive &) = delete;

    void put_at(const std::vector<double> &positions, const char *frame)
    {
        position = positions;
        experience.frame_position = position.data();
        std::strncpy(experience.position_frame, frame, sizeof experience.position_frame - 1);
    }

    vdna::Histogram dna;
    std::vector<float> embeddings;
    std::vector<int64_t> places;
    std::vector<int8_t> codes;
    std::vector<float> scales;
    std::vector<double> position;
    vdna_experience experience{};
};

double no_distance(size_t, uint32_t, uint32_t, size_t)
{
    return std::numeric_limits<double>::quiet_NaN();
}

template <typename Number>
bool equal_bits(const std::vector<Number> &a, const std::vector<Number> &b)
{
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Number)) == 0;
}

void each_run_is_played_in_every_other_but_not_in_itself(void **)
{
    const Drive day("day"), dusk("dusk", 18, 0.05f), night("night", 30, 0.3f);
    const Members members = {&day.experience, &dusk.experience, &night.experience};
    const TrustTables tables = make_trust_tables(members, 1, no_distance);
    assert_true((tables.frames == std::vector<uint32_t>{18, 18, 30}));
    for (const double correlation : tables.correlation)
        assert_true(correlation > 0);
    for (size_t i = 0; i < 9; i++) {
        const vdna_trust_cell &cell = tables.cells[i];
        assert_int_equal(std::isnan(cell.nearest[0]), i % 4 == 0);
        assert_int_equal(std::isnan(cell.likeness[0]), i % 4 == 0);
        assert_true(std::isnan(cell.distance[0]));
    }
    const double played = vdna::record::played_recall(day.experience, dusk.experience, 1);
    for (const double recall : {tables.cells[1].recall[0], tables.cells[1].recall[6]})
        assert_float_equal(recall, played, 0);
    assert_true(tables.cells[1].nearest[0] < tables.cells[2].nearest[0]);
    double own = 0;
    vdna_trust_run run{};
    run.embeddings = day.embeddings.data();
    run.place = day.places.data();
    run.frames = 18;
    run.dim = 2;
    assert_int_equal(vdna_trust_own_scale(&run, 1, &own), VDNA_OK);
    assert_float_equal(tables.own_scale[0], own, 0);

    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = 3;
    const vdna_trust_tables view = tables.view();
    config.tables = &view;
    std::vector<double> memory(vdna_trust_mem_size(&config) / sizeof(double) + 1);
    vdna_trust *trust = nullptr;
    assert_int_equal(
        vdna_trust_init(&config, memory.data(), memory.size() * sizeof(double), &trust), VDNA_OK);
}

void a_further_run_costs_a_row_and_a_column(void **)
{
    const Drive a("a"), b("b", 20, 0.1f), c("c", 19, 0.2f), d("d", 5, 0.15f);
    const Members all = {&a.experience, &d.experience, &b.experience, &c.experience};
    std::vector<std::pair<size_t, size_t>> asked;
    const auto distance = [&](size_t run, uint32_t first, uint32_t, size_t candidate) {
        if (first == 0)
            asked.emplace_back(run, candidate);
        return static_cast<double>(10 * run + candidate);
    };
    const TrustTables anew = make_trust_tables(all, 1, distance);
    assert_int_equal(asked.size(), 12);

    const TrustTables before =
        make_trust_tables({&a.experience, &b.experience, &c.experience}, 1,
                          [](size_t run, uint32_t, uint32_t, size_t candidate) {
                              const size_t now[] = {0, 2, 3};
                              return static_cast<double>(10 * now[run] + now[candidate]);
                          });
    asked.clear();
    const TrustTables further =
        make_trust_tables(all, 1, distance, KnownTables{before.view(), {0, 2, 3}});
    assert_true((asked == std::vector<std::pair<size_t, size_t>>{
                              {0, 1}, {1, 0}, {1, 2}, {1, 3}, {2, 1}, {3, 1}}));
    assert_true(equal_bits(further.cells, anew.cells));
    assert_true(further.frames == anew.frames && further.own_scale == anew.own_scale);
    assert_float_equal(further.correlation[0], before.correlation[0], 0);
    assert_true(std::isnan(further.correlation[1])); // 5 frames are too few to tell
}

void of_two_known_runs_nothing_is_taken_as_they_have_no_correlation_time(void **)
{
    const Drive a("a"), b("b", 20, 0.1f), c("c", 19, 0.2f);
    const TrustTables before = make_trust_tables({&a.experience, &b.experience}, 1, no_distance);
    assert_true(std::isnan(before.correlation[0]));
    const TrustTables tables = make_trust_tables({&a.experience, &b.experience, &c.experience}, 1,
                                                 no_distance, KnownTables{before.view(), {0, 1}});
    assert_true(tables.correlation[0] > 0);
}

void a_run_alone_has_a_scale_and_nothing_else(void **)
{
    const Drive a("a", 5);
    const TrustTables tables =
        make_trust_tables({&a.experience}, 1, vdna::record::distance_of_codes({&a.experience}));
    assert_true(tables.own_scale[0] > 0);
    assert_true(std::isnan(tables.correlation[0]));
    assert_int_equal(tables.cells.size(), 1);
}

void codes_of_the_last_layer_stand_for_its_activations(void **)
{
    const Drive day("day"), night("night", 18, 1);
    const Members members = {&day.experience, &night.experience};
    const TrustTables tables =
        make_trust_tables(members, 1, vdna::record::distance_of_codes(members));

    uint32_t first[VDNA_TRUST_WINDOWS], frames = 0;
    const uint32_t windows = vdna_trust_windows(18, first, &frames);
    for (uint32_t i = 0; i < windows; i++) {
        vdna::Histogram window(range, bins);
        for (uint32_t f = first[i]; f < first[i] + frames; f++) {
            const vdna_activations tap = {&day.embeddings[2 * size_t{f}], 2, 1,
                                          VDNA_LAYOUT_SAMPLES_NEURONS};
            window.add(&tap, 1, "day");
        }
        const vdna_hist_view p = window.view(), q = night.dna.view();
        double exact = 0;
        std::vector<int64_t> scratch(vdna_emd_scratch_size(2) / sizeof(int64_t) + 1);
        assert_int_equal(
            vdna_emd_mean(&p, &q, scratch.data(), scratch.size() * sizeof(int64_t), &exact),
            VDNA_OK);
        assert_float_equal(tables.cells[1].distance[i], exact, 0.2);
        assert_true(exact > 0.5);
    }
}

void other_activations_have_no_distance(void **)
{
    const Drive day("day"), night("night", 18, 0.3f);
    const auto knows = [&](const vdna_experience &changed) {
        return !std::isnan(
            vdna::record::distance_of_codes({&day.experience, &changed})(0, 0, 6, 1));
    };
    assert_true(knows(night.experience));
    vdna_experience other = night.experience;
    std::strcpy(other.identity.embedding, "mid last=topmost centred");
    assert_false(knows(other));
    other.identity.embedding[0] = '\0';
    assert_false(knows(other));
    other = night.experience;
    std::strcpy(other.identity.taps, "top:1:1,low:1:1");
    assert_false(knows(other));
    std::strcpy(other.identity.taps, "top:2:4");
    assert_false(knows(other));
    std::strcpy(other.identity.taps, "top:3:1");
    assert_false(knows(other));
    other = night.experience;
    other.last_layer = nullptr;
    assert_false(knows(other));
}

// Recall of a drive in a copy of itself, by positions 10 metres apart.
double recall_of(Drive &a, Drive &b, const char *frame_a, const char *frame_b, double height)
{
    const auto positions = [](const char *frame, double up) {
        std::vector<double> all;
        for (int f = 0; f < 18; f++) {
            std::array<double, 3> at = {10.0 * f, 0, up};
            if (std::strcmp(frame, VDNA_FRAME_WGS84) == 0)
                vdna_geodesy_to_ecef(51 + 1e-4 * f, 8, up, at.data());
            all.insert(all.end(), at.begin(), at.end());
        }
        return all;
    };
    a.put_at(positions(frame_a, 0), frame_a);
    b.put_at(positions(frame_b, height), frame_b);
    return make_trust_tables({&a.experience, &b.experience}, 5, no_distance).cells[1].recall[0];
}

void positions_compare_horizontally_and_within_their_frame(void **)
{
    Drive a("a"), b("b");
    for (Drive *drive : {&a, &b}) {
        drive->experience.frame_place = nullptr;
        std::strcpy(drive->experience.identity.embedding, "mid last=top"); // about no mean
    }
    assert_float_equal(recall_of(a, b, "yard", "yard", 50), 1, 0);
    assert_float_equal(recall_of(a, b, VDNA_FRAME_WGS84, VDNA_FRAME_WGS84, 50), 1, 0);
    assert_true(std::isnan(recall_of(a, b, "yard", "park", 0)));
    a.experience.frame_place = a.places.data();
    b.experience.frame_place = b.places.data();
    assert_float_equal(recall_of(a, b, "yard", "park", 0), 1, 0);
}

void recall_is_that_of_the_embeddings_localiser(void **)
{
    // So far off that only about the means are they alike.
    Drive a("a", 60), b("b", 60, 10);
    const Members members = {&a.experience, &b.experience};
    const double centred = make_trust_tables(members, 3, no_distance).cells[1].recall[0];
    for (Drive *drive : {&a, &b})
        std::strcpy(drive->experience.identity.embedding, "mid last=top");
    const double euclidean = make_trust_tables(members, 3, no_distance).cells[1].recall[0];
    std::printf("recall %.3f about the means, %.3f without\n", centred, euclidean);
    assert_true(centred > euclidean + 0.2);
}

void what_cannot_be_compared_is_named(void **)
{
    Drive a("a"), b("b");
    b.experience.identity.dim = 1;
    try {
        make_trust_tables({&a.experience, &b.experience}, 1, no_distance);
        fail_msg("expected an Error");
    } catch (const vdna::Error &error) {
        assert_non_null(std::strstr(error.what(), "a in b"));
    }
    const Members many(VDNA_TRUST_RUNS_MAX + 1, &a.experience);
    try {
        make_trust_tables(many, 1, no_distance);
        fail_msg("expected an Error");
    } catch (const vdna::Error &error) {
        assert_non_null(std::strstr(error.what(), "expected at most 4096"));
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(each_run_is_played_in_every_other_but_not_in_itself),
        cmocka_unit_test(a_further_run_costs_a_row_and_a_column),
        cmocka_unit_test(of_two_known_runs_nothing_is_taken_as_they_have_no_correlation_time),
        cmocka_unit_test(a_run_alone_has_a_scale_and_nothing_else),
        cmocka_unit_test(codes_of_the_last_layer_stand_for_its_activations),
        cmocka_unit_test(other_activations_have_no_distance),
        cmocka_unit_test(positions_compare_horizontally_and_within_their_frame),
        cmocka_unit_test(recall_is_that_of_the_embeddings_localiser),
        cmocka_unit_test(what_cannot_be_compared_is_named),
    };
    return cmocka_run_group_tests_name("trust_tables", tests, nullptr, nullptr);
}
