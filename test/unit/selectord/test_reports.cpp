// Localisation messages: the place and the position of a map frame.
#include <cmath>
#include <cstring>

#include <vdna/geodesy.h>

#include "cmocka.hpp"
#include "selectord/reports.hpp"

namespace
{

// An experience of two frames, the second without ground truth.
struct Chosen {
    explicit Chosen(const char *frame, double x, double y, double z)
        : positions{x, y, z, NAN, NAN, NAN}
    {
        std::strcpy(experience.name, "winter");
        std::strcpy(experience.position_frame, frame);
        experience.frames = 2;
        experience.frame_utime = utimes;
        experience.frame_place = places;
        experience.frame_position = positions;
    }
    vdna_msg_localisation_t message(uint32_t frame) const
    {
        return vdna::selectord::nearest_in(experience, {4, frame, 0}, 7);
    }
    int64_t utimes[2] = {10, 20};
    int64_t places[2] = {3, VDNA_PLACE_NONE};
    double positions[6];
    vdna_experience experience{};
};

void a_local_position_goes_out_in_metres_with_its_frame(void **)
{
    const Chosen chosen("hall-3", 1, 2, 3);
    const vdna_msg_localisation_t message = chosen.message(0);
    assert_int_equal(message.has_place, 1);
    assert_int_equal(message.place, 3);
    assert_int_equal(message.has_position, 1);
    assert_string_equal(message.position_frame, "hall-3");
    assert_true(message.position[0] == 1 && message.position[1] == 2 && message.position[2] == 3);
    assert_true(message.distance == 2);
}

void gps_goes_out_in_degrees_as_it_came(void **)
{
    double ecef[3];
    vdna_geodesy_to_ecef(48.1, 11.5, 531.8, ecef);
    const Chosen chosen(VDNA_FRAME_WGS84, ecef[0], ecef[1], ecef[2]);
    const vdna_msg_localisation_t message = chosen.message(0);
    assert_string_equal(message.position_frame, VDNA_FRAME_WGS84);
    assert_float_equal(message.position[0], 48.1, 1e-9);
    assert_float_equal(message.position[1], 11.5, 1e-9);
    assert_float_equal(message.position[2], 531.8, 1e-4);
}

void a_map_frame_without_truth_gives_neither_place_nor_position(void **)
{
    const Chosen chosen("local", 1, 2, 3);
    const vdna_msg_localisation_t message = chosen.message(1);
    assert_int_equal(message.frame, 1);
    assert_int_equal(message.frame_utime, 20);
    assert_int_equal(message.has_place, 0);
    assert_int_equal(message.has_position, 0);
    assert_string_equal(message.position_frame, "");
    assert_true(message.place == 0 && message.position[0] == 0 && message.position[2] == 0);
}

void the_nearest_frame_alone_has_no_confidence(void **)
{
    const vdna_msg_localisation_t message = Chosen("local", 1, 2, 3).message(1);
    assert_int_equal(message.validity, VDNA_MSG_LOCALISATION_T_VALID);
    assert_int_equal(message.nearest_frame, 1);
    assert_int_equal(message.moving, 1);
    assert_true(std::isnan(message.confidence));
    assert_true(std::isnan(message.predicted_recall));
    assert_true(std::isnan(message.predicted_low) && std::isnan(message.predicted_high));
}

void a_place_below_the_least_confidence_is_unsure(void **)
{
    const Chosen chosen("local", 1, 2, 3);
    const vdna_localise_answer answer = {0, 1, 0, 0, 0.75, 0.5, 0.125};
    const auto message = [&](double min_confidence) {
        return vdna::selectord::position_in(chosen.experience, answer, min_confidence, 7);
    };
    assert_int_equal(message(0.76).validity, VDNA_MSG_LOCALISATION_T_UNSURE);
    const vdna_msg_localisation_t sure = message(0.75);
    assert_int_equal(sure.validity, VDNA_MSG_LOCALISATION_T_VALID);
    assert_int_equal(sure.frame, 0);
    assert_int_equal(sure.place, 3);
    assert_int_equal(sure.nearest_frame, 1);
    assert_int_equal(sure.moving, 0);
    assert_true(sure.confidence == 0.75 && sure.distance == 0.125);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_local_position_goes_out_in_metres_with_its_frame),
        cmocka_unit_test(gps_goes_out_in_degrees_as_it_came),
        cmocka_unit_test(a_map_frame_without_truth_gives_neither_place_nor_position),
        cmocka_unit_test(the_nearest_frame_alone_has_no_confidence),
        cmocka_unit_test(a_place_below_the_least_confidence_is_unsure),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
