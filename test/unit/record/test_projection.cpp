// Projections to principal directions, on frames small enough to know them.
#include <cmath>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "record/projection.hpp"

using vdna::record::principal_directions;
using vdna::record::Projection;
using vdna::record::Recording;

namespace
{

Recording recording_of(std::vector<float> embeddings, uint32_t raw_dim)
{
    Recording recording;
    recording.frames = static_cast<uint32_t>(embeddings.size() / raw_dim);
    recording.embeddings = std::move(embeddings);
    return recording;
}

void assert_directions(const Projection &projection, const std::vector<double> &expected)
{
    assert_int_equal(projection.directions.size(), expected.size());
    for (size_t i = 0; i < expected.size(); i++)
        assert_float_equal(projection.directions[i], expected[i], 1e-7);
}

// Two drives that vary most along (3, 4, 0), then about along the third axis.
const Recording first = recording_of({6, 8, 1, 0, 0, 0, -6, -8, -1, 0, 0, 0}, 3);
const Recording second = recording_of({100, 100, 2, 100, 100, -2}, 3);

void the_directions_are_those_of_most_variance_about_each_parts_mean(void **)
{
    const Projection projection = principal_directions({&first, &second}, 3, 2, "test");
    assert_int_equal(projection.raw_dim, 3);
    // Those of numpy.linalg.eigh.
    assert_directions(projection, {0.596773796, 0.795698392, 0.103562095, //
                                   -0.062137257, -0.082849676, 0.994622990});
}

void fewer_frames_than_numbers_give_the_same_directions(void **)
{
    // The same numbers, and some that never vary.
    const Recording wide = recording_of({6,  8,  1,  7, 7, 7, 0, 0, 0, 7, 7, 7, //
                                         -6, -8, -1, 7, 7, 7, 0, 0, 0, 7, 7, 7},
                                        6);
    const Projection few = principal_directions({&wide}, 6, 1, "test");
    const Projection many = principal_directions({&first}, 3, 1, "test");
    assert_directions(few, {many.directions[0], many.directions[1], many.directions[2], 0, 0, 0});
}

void dims_that_the_frames_do_not_vary_in_are_refused(void **)
{
    const auto assert_refused = [](const std::vector<const Recording *> &parts, uint32_t raw_dim,
                                   uint32_t dims, const std::string &sentence) {
        try {
            principal_directions(parts, raw_dim, dims, "backbone made");
            fail();
        } catch (const vdna::Error &error) {
            if (std::string(error.what()).find(sentence) == std::string::npos)
                fail_msg("expected \"%s\" in: %s", sentence.c_str(), error.what());
        }
    };
    assert_refused({&first, &second}, 3, 3,
                   "backbone made: 3 numbers of each embedding are to be kept ('dims'), but the 6 "
                   "frames of 2 experiences vary in 2 directions");
    const Recording two = recording_of({1, 2, 3, 4, 5, 6, 7, 9}, 4);
    assert_refused({&two}, 4, 2, "the 2 frames of 1 experience vary in 1 directions");
    const Recording still = recording_of({1, 2, 1, 2, 1, 2}, 2);
    assert_refused({&still}, 2, 1, "vary in 0 directions");
}

void a_recording_is_projected_as_live_frames_are(void **)
{
    vdna_identity identity{};
    identity.dim = 3;
    Recording recording = first;
    vdna::record::project(recording, identity); // nothing is left out
    assert_true(recording.embeddings == first.embeddings);

    const Projection projection{{0, 0, 1, 0.5f, 0.25f, 0}, 3};
    projection.set_in(identity);
    assert_int_equal(identity.dim, 2);
    assert_int_equal(identity.raw_dim, 3);
    vdna::record::project(recording, identity);
    assert_true((recording.embeddings == std::vector<float>{1, 5, 0, 0, -1, -5, 0, 0}));

    // What an experience says is read back.
    const Projection read = vdna::record::projection_of(identity);
    assert_true(read.directions == projection.directions && read.raw_dim == 3);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_directions_are_those_of_most_variance_about_each_parts_mean),
        cmocka_unit_test(fewer_frames_than_numbers_give_the_same_directions),
        cmocka_unit_test(dims_that_the_frames_do_not_vary_in_are_refused),
        cmocka_unit_test(a_recording_is_projected_as_live_frames_are),
    };
    return cmocka_run_group_tests_name("projection", tests, nullptr, nullptr);
}
