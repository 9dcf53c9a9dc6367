// Activations kept in memory, all or none.
#include "cmocka.hpp"
#include "record/activation_store.hpp"

using vdna::record::ActivationStore;

namespace
{

// Two taps: two neurons with one sample, and one neuron with two.
struct Output {
    float first[2], second[2];
    vdna_activations taps[2] = {{first, 2, 1, VDNA_LAYOUT_SAMPLES_NEURONS},
                                {second, 1, 2, VDNA_LAYOUT_NEURONS_SAMPLES}};
    vdna_backbone_frame frame()
    {
        vdna_backbone_frame frame{};
        frame.taps = taps;
        frame.tap_count = 2;
        return frame;
    }
};

constexpr size_t frame_bytes = 4 * sizeof(float);

void frames_come_back_as_they_were_though_the_network_went_on(void **)
{
    ActivationStore store(2 * frame_bytes);
    Output output{{1, 2}, {3, 4}};
    store.add(output.frame());
    output.first[0] = 5;
    output.second[1] = 6;
    store.add(output.frame());
    assert_true(store.complete());

    const std::vector<vdna_activations> taps = store.taps(0);
    assert_int_equal(taps.size(), 2);
    assert_int_equal(taps[0].neurons, 2);
    assert_int_equal(taps[1].samples, 2);
    assert_int_equal(taps[1].layout, VDNA_LAYOUT_NEURONS_SAMPLES);
    assert_true(taps[0].values[0] == 1 && taps[1].values[1] == 4);
    assert_true(store.taps(1)[0].values[0] == 5 && store.taps(1)[1].values[1] == 6);
}

void one_byte_too_few_keeps_none(void **)
{
    ActivationStore store(2 * frame_bytes - 1);
    Output output{{1, 2}, {3, 4}};
    store.add(output.frame());
    assert_true(store.complete());
    store.add(output.frame());
    assert_false(store.complete());
    store.add(output.frame());
    assert_false(store.complete());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_back_as_they_were_though_the_network_went_on),
        cmocka_unit_test(one_byte_too_few_keeps_none),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
