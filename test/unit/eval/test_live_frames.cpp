#include <cmath>
#include <cstring>

#include "cmocka.hpp"
#include "eval/live_frames.hpp"

using namespace vdna;

namespace
{

eval::Traversal traversal_of(const std::vector<float> &embeddings,
                             const std::vector<float> &last_layer)
{
    eval::Traversal traversal{"stored", "", {}, {}};
    traversal.recording.frames = static_cast<uint32_t>(embeddings.size() / 2);
    traversal.recording.embeddings = embeddings;
    traversal.recording.last_layer = last_layer;
    return traversal;
}

vdna_identity two_numbers()
{
    vdna_identity identity{};
    identity.dim = 2;
    return identity;
}

void a_frame_is_measured_to_the_nearest_of_each_run(void **)
{
    const eval::Traversal one = traversal_of({0, 2, 3, 4}, {127, 0, 0, 127}),
                          other = traversal_of({0, 8}, {0, 127});
    const eval::StoredRun stored(one, two_numbers()), farther(other, two_numbers());
    eval::LiveFrames live;
    const float embedding[] = {0, 2}, last_layer[] = {127, 0};
    eval::measure(embedding, last_layer, {&stored, &farther}, live);
    assert_int_equal(live.frames, 1);
    assert_true(live.nearest[0] == 0 && std::fabs(live.nearest[1] - 6 / 4.0) < 1e-6);
    assert_true(live.likeness[0] == 0 && std::fabs(live.likeness[1] - std::sqrt(2.0)) < 1e-6);
}

void without_a_last_layer_there_is_no_likeness(void **)
{
    const eval::Traversal one = traversal_of({0, 2}, {});
    const eval::StoredRun stored(one, two_numbers());
    assert_true(!stored.experience().last_layer && stored.experience().last_layer_dim == 0);
    eval::LiveFrames live;
    const float embedding[] = {0, 2};
    eval::measure(embedding, nullptr, {&stored}, live);
    assert_true(live.nearest.size() == 1 && live.likeness.empty());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_measured_to_the_nearest_of_each_run),
        cmocka_unit_test(without_a_last_layer_there_is_no_likeness),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
