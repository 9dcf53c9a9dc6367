// The places of an experience, and the localiser that is set up by them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

#include <vdna/cpp/experience_localiser.hpp>
#include <vdna/geodesy.h>

#include "cmocka.hpp"

namespace
{

using vdna::Places, vdna::places_of;

constexpr double pi = 3.14159265358979323846, nan_m = std::numeric_limits<double>::quiet_NaN();

// A route in metres, of which places are wanted.
struct Route {
    std::vector<double> position; // [frames][3]
    std::vector<int64_t> place;   // [frames], empty = none

    void add(double x, double y, double z = 0) { position.insert(position.end(), {x, y, z}); }

    // From the last position straight on, in steps of 1 m.
    void drive(double dx, double dy, int frames)
    {
        for (int i = 0; i < frames; i++)
            add(*(position.end() - 3) + dx, *(position.end() - 2) + dy);
    }

    Places places(double tolerance, const char *frame = VDNA_FRAME_LOCAL) const
    {
        vdna_experience experience{};
        experience.frames =
            static_cast<uint32_t>(position.empty() ? place.size() : position.size() / 3);
        experience.frame_position = position.empty() ? nullptr : position.data();
        experience.frame_place = place.empty() ? nullptr : place.data();
        std::string(frame).copy(experience.position_frame, VDNA_NAME_SIZE - 1);
        return places_of(experience, tolerance);
    }
};

Route straight(int frames)
{
    Route route;
    route.add(0, 0);
    route.drive(1, 0, frames - 1);
    return route;
}

// A circle of 100 frames, 1 m apart, several times; each lap a bit to the outside.
Route circle(int frames, double outwards_m = 0)
{
    Route route;
    for (int i = 0; i < frames; i++) {
        const double radius = 100 / (2 * pi) + outwards_m * (i / 100), turn = 2 * pi * i / 100;
        route.add(radius * std::cos(turn), radius * std::sin(turn));
    }
    return route;
}

void a_plain_route_has_the_index_for_its_number(void **)
{
    const Places places = straight(50).places(5);
    assert_true(places.number.empty());
    assert_int_equal(places.tolerance, 5);
    assert_int_equal(straight(50).places(1000).tolerance, 50);
    assert_int_equal(straight(50).places(0).tolerance, 0);
    assert_true(straight(50).places(0).number.empty());
}

void a_second_and_a_third_lap_have_the_numbers_of_the_first(void **)
{
    const Places places = circle(300).places(2);
    assert_int_equal(places.tolerance, 2);
    assert_int_equal(places.number.size(), 300);
    for (size_t i = 0; i < 98; i++)
        for (const size_t lap : {0u, 1u, 2u})
            assert_int_equal(places.number[100 * lap + i], i);
    // At the end of a lap there are no posts: the first lap has arrived where it began.
    for (const size_t i : {98u, 99u, 199u, 299u})
        assert_int_equal(places.number[i], 0);
    for (const size_t i : {198u, 298u})
        assert_int_equal(places.number[i], 97);
}

void a_lap_beside_the_first_is_another_place_beyond_the_tolerance(void **)
{
    const auto number = [](double outwards_m) {
        return circle(200, outwards_m).places(2).number[150];
    };
    assert_int_equal(number(1.9), 50);
    assert_int_equal(number(2.1), 150);
}

void numbers_are_those_of_posts_where_frames_are_dense(void **)
{
    const Places places = circle(200).places(11.9); // posts are 3 m apart
    for (size_t i = 100; i < 170; i++) {
        assert_int_equal(places.number[i] % 3, 0);
        assert_in_range(places.number[i] + 1, i - 100, i - 98);
    }
}

void a_figure_of_eight_has_one_number_for_its_crossing(void **)
{
    // Two squares that touch in the origin, which is passed by frames 20, 100 and 180.
    Route route;
    route.add(-20, 0);
    route.drive(1, 0, 40);
    route.drive(0, 1, 20);
    route.drive(-1, 0, 20);
    route.drive(0, -1, 40);
    route.drive(-1, 0, 20);
    route.drive(0, 1, 20);
    route.drive(1, 0, 40);
    const Places places = route.places(3);
    for (const size_t passing : {20u, 97u, 100u, 103u, 180u})
        assert_int_equal(places.number[passing], 20);
    for (const size_t first : {0u, 19u, 23u, 50u, 96u, 104u, 150u})
        assert_int_equal(places.number[first], first);
    assert_int_equal(places.number[170], 10);
}

void a_robot_that_stands_or_creeps_passes_nothing_again(void **)
{
    Route route = straight(20);
    for (int i = 0; i < 200; i++) // it stands, and its fixes move by less than a metre
        route.add(19 + 0.9 * std::sin(i), 0.9 * std::cos(3 * i));
    route.drive(0.02, 0, 200);
    route.drive(-1, 0, 5); // goes back a little
    route.drive(1, 0, 500);
    assert_true(route.places(5).number.empty());
    assert_int_equal(route.places(5).tolerance, 5);
}

void the_way_back_has_the_numbers_of_the_way_out(void **)
{
    Route route = straight(50);
    route.drive(-1, 0, 49);
    const Places places = route.places(4);
    for (size_t i = 0; i < 50; i++) // the last spots of the way out are not left before the turn
        assert_int_equal(places.number[98 - i], i <= 40 ? i : i <= 44 ? 40 : 98 - i);
}

void frames_without_a_position_are_places_of_their_own(void **)
{
    Route route = straight(10);
    for (const size_t i : {12u, 13u, 14u})
        route.position[i] = nan_m;
    Places places = route.places(2);
    assert_int_equal(places.tolerance, 2);
    for (size_t i = 0; i < 10; i++)
        assert_int_equal(places.number[i], i == 4 ? VDNA_PLACE_NONE : static_cast<int64_t>(i));

    for (double &number : route.position)
        number = nan_m;
    places = route.places(2);
    assert_true(places.number.empty());
    assert_int_equal(places.tolerance, 2);
}

void positions_count_horizontally(void **)
{
    Route route = circle(200);
    for (size_t i = 0; i < 200; i++)
        route.position[3 * i + 2] = i < 100 ? 0 : 40;
    assert_int_equal(route.places(2).number[150], 50);

    for (size_t i = 0; i < 200; i++) // on the equator, about the zero meridian
        assert_int_equal(vdna_geodesy_to_ecef(route.position[3 * i] / 110574,
                                              route.position[3 * i + 1] / 111320, i < 100 ? 0 : 40,
                                              &route.position[3 * i]),
                         VDNA_OK);
    assert_int_equal(route.places(2, VDNA_FRAME_WGS84).number[150], 50);
    route.position[0] = 5; // within the Earth: not known
    assert_true(route.places(2, VDNA_FRAME_WGS84).number[0] == VDNA_PLACE_NONE);
}

void place_numbers_are_taken_as_they_are(void **)
{
    Route route;
    route.place = {7, 8, VDNA_PLACE_NONE, 7};
    const Places places = route.places(3.9);
    assert_int_equal(places.tolerance, 3);
    assert_true(places.number == route.place);
    assert_int_equal(route.places(1e300).tolerance, UINT32_MAX);
    route.place = {0, 1, 2};
    assert_true(route.places(3).number.empty());

    route.position = {0, 0, 0, 1, 0, 0, 2, 0, 0}; // which are preferred
    route.place = {7, 8, 9};
    assert_true(route.places(3).number.empty());
}

void one_frame_or_no_label_leaves_two_frames_of_tolerance(void **)
{
    assert_int_equal(straight(1).places(5).tolerance, 2);
    assert_true(straight(1).places(5).number.empty());
    vdna_experience unlabelled{};
    unlabelled.frames = 9;
    assert_int_equal(places_of(unlabelled, 5).tolerance, 2);
    assert_true(places_of(unlabelled, 5).number.empty());
}

void what_makes_no_sense_is_refused_and_changes_nothing(void **)
{
    vdna_experience experience{};
    experience.frames = 3;
    int64_t place[3];
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.tolerance = 77;
    for (const double tolerance : {-1.0, nan_m, HUGE_VAL})
        assert_int_equal(vdna_experience_localise_config(&experience, tolerance, place, &config),
                         VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_localise_config(nullptr, 1, place, &config), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_localise_config(&experience, 1, nullptr, &config),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_localise_config(&experience, 1, place, nullptr), VDNA_ERR_ARG);
    experience.frames = 0;
    assert_int_equal(vdna_experience_localise_config(&experience, 1, place, &config), VDNA_ERR_ARG);
    assert_int_equal(config.tolerance, 77);
}

void spots_beyond_what_an_integer_counts_are_places_too(void **)
{
    Route route;
    for (int lap = 0; lap < 2; lap++)
        for (int i = 0; i < 20; i++)
            route.add(1e150 * (i % 2 ? 1 : -1), 1e17 * i);
    const Places places = route.places(1);
    for (size_t i = 0; i < 20; i++)
        assert_int_equal(places.number[20 + i], i);
}

// Processor time to number the frames of a robot that drives through `spots` of 1 m and stands in
// each, the least of three.
double time_for(int frames, int spots)
{
    Route route;
    for (int i = 0; i < frames; i++)
        route.add(i / (frames / spots) % (spots / 2), 0.001 * (i % 10));
    double least = HUGE_VAL;
    for (int run = 0; run < 3; run++) {
        const std::clock_t begin = std::clock();
        assert_int_equal(route.places(3).number[static_cast<size_t>(frames) / 2], 0);
        least = std::min(least, static_cast<double>(std::clock() - begin));
    }
    return least;
}

void the_time_is_linear_in_the_frames(void **)
{
    const double few = time_for(20000, 100), many = time_for(200000, 100);
    print_message("200000 frames take %.1f times the time of 20000\n", many / few);
    assert_true(many < 50 * few); // 100 if it were quadratic
}

// A map that looks alike in both laps.
struct Looks {
    std::vector<float> embeddings;
    Route route = circle(200);
    vdna_experience map{};

    Looks()
    {
        for (int i = 0; i < 200; i++)
            for (int k = 1; k <= 4; k++)
                for (const double quarter : {0.0, pi / 2})
                    embeddings.push_back(
                        static_cast<float>(std::sin(2 * pi * i * k / 100 + quarter)));
        map.frames = 200;
        map.identity.dim = 8;
        map.embeddings = embeddings.data();
        map.frame_position = route.position.data();
        std::string("yard").copy(map.name, VDNA_NAME_SIZE - 1);
        std::string("grid 3x3 centred").copy(map.identity.embedding, VDNA_IDENTITY_TEXT_SIZE - 1);
    }

    // The answer at frame 60 of another lap.
    vdna_localise_answer last_answer() const
    {
        vdna::ExperienceLocaliser localiser(map, 2);
        vdna_localise_answer answer{};
        for (size_t i = 0; i < 20; i++)
            assert_int_equal(vdna_localise_warm_up(localiser.get(), &embeddings[8 * i]), VDNA_OK);
        for (size_t i = 20; i <= 60; i++)
            assert_int_equal(vdna_localise_feed(localiser.get(), &embeddings[8 * i], &answer),
                             VDNA_OK);
        return answer;
    }
};

void places_and_not_frames_have_the_mass(void **)
{
    Looks looks;
    const vdna_localise_answer by_place = looks.last_answer();
    looks.map.frame_position = nullptr;
    const vdna_localise_answer by_frame = looks.last_answer();
    assert_in_range(by_place.frame % 100, 58, 62);
    assert_true(by_frame.mass < 0.5 && by_place.mass > 1.9 * by_frame.mass);
    assert_true(by_place.confidence > by_frame.confidence);
}

void distances_are_about_the_means_if_the_embeddings_are_made_for_that(void **)
{
    Looks looks;
    const auto mean_of = [&] {
        vdna::ExperienceLocaliser localiser(looks.map, 2);
        const float bright[8] = {9, 9, 9, 9, 9, 9, 9, 9};
        assert_int_equal(vdna_localise_warm_up(localiser.get(), bright), VDNA_OK);
        const vdna::ExperienceLocaliser &same = localiser;
        return vdna_localise_mean(same.get())[0];
    };
    assert_true(mean_of() > 1);
    const double confidence = looks.last_answer().confidence;
    looks.map.identity.embedding[0] = '\0';
    assert_true(mean_of() == 0);
    assert_true(std::abs(looks.last_answer().confidence - confidence) > 1e-3);
    vdna::ExperienceLocaliser chosen(looks.map, 2);
    assert_true(chosen.memory_size() > size_t{200} * 8 * 2);
}

void the_confidence_is_that_of_fewer_directions_if_embeddings_are_projected(void **)
{
    const auto confidence_of = [](uint32_t dim, bool is_centred) {
        const std::vector<float> directions(size_t{dim} * dim);
        vdna_experience experience{};
        experience.frames = 1;
        experience.identity.dim = experience.identity.raw_dim = dim;
        experience.identity.projection = directions.data();
        std::strcpy(experience.identity.embedding, is_centred ? "map centred" : "map");
        int64_t place = 0;
        vdna_localise_config config;
        vdna_localise_config_init(&config);
        assert_int_equal(vdna_experience_localise_config(&experience, 1, &place, &config), VDNA_OK);
        return std::vector<double>(config.confidence, config.confidence + 4);
    };
    assert_true((confidence_of(64, true) == std::vector<double>{1, 0.53, 1.1, -10.4}));
    assert_float_equal(confidence_of(256, true)[0], 2.3, 1e-12);
    assert_float_equal(confidence_of(16, true)[0], -0.3, 1e-12);
    assert_true((confidence_of(64, false) == std::vector<double>{-2.5, 0.53, 1.1, 0}));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_plain_route_has_the_index_for_its_number),
        cmocka_unit_test(the_confidence_is_that_of_fewer_directions_if_embeddings_are_projected),
        cmocka_unit_test(a_second_and_a_third_lap_have_the_numbers_of_the_first),
        cmocka_unit_test(a_lap_beside_the_first_is_another_place_beyond_the_tolerance),
        cmocka_unit_test(numbers_are_those_of_posts_where_frames_are_dense),
        cmocka_unit_test(a_figure_of_eight_has_one_number_for_its_crossing),
        cmocka_unit_test(a_robot_that_stands_or_creeps_passes_nothing_again),
        cmocka_unit_test(the_way_back_has_the_numbers_of_the_way_out),
        cmocka_unit_test(frames_without_a_position_are_places_of_their_own),
        cmocka_unit_test(positions_count_horizontally),
        cmocka_unit_test(place_numbers_are_taken_as_they_are),
        cmocka_unit_test(one_frame_or_no_label_leaves_two_frames_of_tolerance),
        cmocka_unit_test(what_makes_no_sense_is_refused_and_changes_nothing),
        cmocka_unit_test(spots_beyond_what_an_integer_counts_are_places_too),
        cmocka_unit_test(the_time_is_linear_in_the_frames),
        cmocka_unit_test(places_and_not_frames_have_the_mass),
        cmocka_unit_test(distances_are_about_the_means_if_the_embeddings_are_made_for_that),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
