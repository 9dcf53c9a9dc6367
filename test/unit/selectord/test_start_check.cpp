// A network must give the same numbers for the same picture before the daemon is ready.
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "selectord/start_check.hpp"

using namespace vdna;

namespace
{

// What is added to the stub's embedding, and grows by `step` with each run.
float added = 0, step = 0;
std::vector<float> embedding;

vdna_status run_and_add(void *state, const vdna_image *image, vdna_error *error,
                        vdna_backbone_frame *out_frame)
{
    const vdna_status status = vdna_backbone_plugin()->run(state, image, error, out_frame);
    embedding.assign(out_frame->embedding, out_frame->embedding + out_frame->dim);
    embedding[0] += added;
    added += step;
    out_frame->embedding = embedding.data();
    return status;
}

vdna_status refuse(void *, const vdna_image *, vdna_error *error, vdna_backbone_frame *)
{
    std::strcpy(error->text, "not this one");
    return VDNA_ERR_UNSUPPORTED;
}

// What is wrong with a network; "" if nothing is.
std::string refusal(vdna_status (*run)(void *, const vdna_image *, vdna_error *,
                                       vdna_backbone_frame *),
                    float first, float growth)
{
    added = first;
    step = growth;
    vdna_backbone_operations operations = *vdna_backbone_plugin();
    operations.run = run;
    const Backbone backbone(operations);
    try {
        selectord::require_repeatable(backbone);
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

void a_network_that_repeats_itself_is_accepted(void **)
{
    assert_string_equal(refusal(run_and_add, 0.5F, 0).c_str(), "");
}

void one_that_gives_other_numbers_the_second_time_is_refused(void **)
{
    assert_non_null(
        std::strstr(refusal(run_and_add, 0, 1e-6F).c_str(), "other numbers for the same picture"));
}

void one_that_gives_numbers_that_are_not_finite_is_refused(void **)
{
    assert_non_null(std::strstr(refusal(run_and_add, NAN, 0).c_str(), "no finite numbers"));
}

void one_that_takes_no_such_picture_is_left_to_the_frames(void **)
{
    assert_string_equal(refusal(refuse, 0, 0).c_str(), "");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_network_that_repeats_itself_is_accepted),
        cmocka_unit_test(one_that_gives_other_numbers_the_second_time_is_refused),
        cmocka_unit_test(one_that_gives_numbers_that_are_not_finite_is_refused),
        cmocka_unit_test(one_that_takes_no_such_picture_is_left_to_the_frames),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
