/* The places of a route, seen through the C ABI. test_experience_localiser.cpp has more of them, by
 * the C++ class. */
#include <math.h>
#include <string.h>

#include <vdna/experience_localise.h>
#include <vdna/geodesy.h>

#include "cmocka_all.h"
#include "watched_calls.h"

enum { MOST = 400 };

/* A route in metres, and what is found of it. */
static double position[MOST][3];
static int64_t place[MOST], given_place[MOST];
static uint32_t frames;
static vdna_experience experience;
static vdna_localise_config config;

static int begin(void **state)
{
    (void)state;
    frames = 0;
    memset(&experience, 0, sizeof experience);
    vdna_localise_config_init(&config);
    experience.frame_position = position[0];
    strcpy(experience.position_frame, VDNA_FRAME_LOCAL);
    strcpy(experience.identity.embedding, "grid 3x3 centred");
    return 0;
}

static void add(double x, double y)
{
    position[frames][0] = x;
    position[frames][1] = y;
    position[frames++][2] = 0;
}

static void drive(double dx, double dy, int count)
{
    for (int i = 0; i < count; i++)
        add(position[frames - 1][0] + dx, position[frames - 1][1] + dy);
}

static vdna_status choose(double tolerance)
{
    experience.frames = frames;
    return vdna_experience_localise_config(&experience, tolerance, place, &config);
}

static void a_plain_route_has_the_index_for_its_number(void **state)
{
    (void)state;
    add(0, 0);
    drive(1, 0, 49);
    assert_int_equal(choose(5), VDNA_OK);
    assert_int_equal(config.tolerance, 5);
    assert_null(config.place);
    assert_int_equal(choose(1000), VDNA_OK);
    assert_int_equal(config.tolerance, 50);
    assert_int_equal(choose(0), VDNA_OK);
    assert_int_equal(config.tolerance, 0);
    assert_null(config.place);
}

static void a_figure_of_eight_has_one_number_for_its_crossing(void **state)
{
    (void)state;
    add(-20, 0); /* two squares that touch in the origin, which frames 20, 100 and 180 pass */
    drive(1, 0, 40);
    drive(0, 1, 20);
    drive(-1, 0, 20);
    drive(0, -1, 40);
    drive(-1, 0, 20);
    drive(0, 1, 20);
    drive(1, 0, 40);
    assert_int_equal(choose(3), VDNA_OK);
    assert_ptr_equal(config.place, place);
    const uint32_t passing[] = {20, 97, 100, 103, 180}, first[] = {0, 19, 23, 50, 96, 104, 150};
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(place[passing[i]], 20);
    for (size_t i = 0; i < 7; i++)
        assert_int_equal(place[first[i]], first[i]);
    assert_int_equal(place[170], 10);
}

static void of_posts_that_are_equally_near_the_first_counts(void **state)
{
    (void)state;
    add(0, 0); /* a post at 0, another at 4, and on the way back a frame between them */
    add(4, 0);
    drive(10, 0, 3);
    add(100, 100);
    add(2, 0);
    assert_int_equal(choose(3), VDNA_OK);
    assert_int_equal(place[6], 0);
}

static void a_robot_that_stands_passes_nothing_again(void **state)
{
    (void)state;
    add(0, 0);
    drive(1, 0, 20);
    for (int i = 0; i < 100; i++)
        add(20 + 0.9 * sin(i), 0.9 * cos(3 * i));
    drive(1, 0, 100);
    assert_int_equal(choose(5), VDNA_OK);
    assert_null(config.place);
}

static void frames_without_a_position_are_places_of_their_own(void **state)
{
    (void)state;
    add(0, 0);
    drive(1, 0, 9);
    position[4][0] = position[4][1] = position[4][2] = NAN;
    assert_int_equal(choose(2), VDNA_OK);
    for (uint32_t i = 0; i < 10; i++)
        assert_int_equal(place[i], i == 4 ? VDNA_PLACE_NONE : (int64_t)i);
    for (uint32_t i = 0; i < 10; i++)
        position[i][0] = NAN;
    assert_int_equal(choose(2), VDNA_OK);
    assert_null(config.place);
    assert_int_equal(config.tolerance, 2);
}

static void positions_on_the_globe_count_on_the_ground(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 20; i++, frames++) /* up a tower, and along the equator */
        assert_int_equal(vdna_geodesy_to_ecef(0, 1e-5 * (i % 10), i < 10 ? 0 : 40, position[i]),
                         VDNA_OK);
    strcpy(experience.position_frame, VDNA_FRAME_WGS84);
    assert_int_equal(choose(2), VDNA_OK);
    assert_int_equal(place[10], 0);
    position[0][0] = 5; /* within the Earth: not known */
    position[0][1] = position[0][2] = 0;
    assert_int_equal(choose(2), VDNA_OK);
    assert_int_equal(place[0], VDNA_PLACE_NONE);
}

static void place_numbers_are_taken_as_they_are(void **state)
{
    (void)state;
    frames = 4;
    const int64_t numbers[] = {7, 8, VDNA_PLACE_NONE, 7};
    memcpy(given_place, numbers, sizeof numbers);
    experience.frame_position = NULL;
    experience.frame_place = given_place;
    assert_int_equal(choose(3.9), VDNA_OK);
    assert_int_equal(config.tolerance, 3);
    assert_memory_equal(place, numbers, sizeof numbers);
    assert_int_equal(choose(1e300), VDNA_OK);
    assert_int_equal(config.tolerance, UINT32_MAX);

    experience.frame_position = position[0]; /* which tell more */
    frames = 0;
    add(0, 0);
    drive(1, 0, 3);
    assert_int_equal(choose(3), VDNA_OK);
    assert_null(config.place);
}

static void the_confidence_suits_the_embedding(void **state)
{
    (void)state;
    vdna_localise_config usual;
    vdna_localise_config_init(&usual);
    add(0, 0);
    assert_int_equal(choose(1), VDNA_OK);
    assert_memory_equal(config.confidence, usual.confidence, sizeof usual.confidence);
    assert_true(config.clutter > usual.clutter);
    const float projection = 1;
    experience.identity.projection = &projection;
    experience.identity.dim = 64;
    assert_int_equal(choose(1), VDNA_OK);
    assert_true(config.confidence[0] == 1 && config.confidence[3] < 0);
    strcpy(experience.identity.embedding, "grid 3x3");
    assert_int_equal(choose(1), VDNA_OK);
    assert_true(config.confidence[3] == 0);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    add(0, 0);
    assert_int_equal(choose(-1), VDNA_ERR_ARG);
    assert_int_equal(choose(NAN), VDNA_ERR_ARG);
    assert_int_equal(choose(INFINITY), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_localise_config(NULL, 1, place, &config), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_localise_config(&experience, 1, NULL, &config), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_localise_config(&experience, 1, place, NULL), VDNA_ERR_ARG);
    frames = 0;
    assert_int_equal(choose(1), VDNA_ERR_ARG);
}

static void too_little_memory_is_an_error(void **state)
{
    (void)state;
    add(0, 0);
    drive(1, 0, 9);
    for (int call = 0; call < 4; call++) {
        refuse("calloc", call, ENOMEM);
        assert_int_equal(choose(2), VDNA_ERR_NOMEM);
        assert_true(was_refused());
    }
}

#define CASE(name) cmocka_unit_test_setup(name, begin)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(a_plain_route_has_the_index_for_its_number),
        CASE(a_figure_of_eight_has_one_number_for_its_crossing),
        CASE(of_posts_that_are_equally_near_the_first_counts),
        CASE(a_robot_that_stands_passes_nothing_again),
        CASE(frames_without_a_position_are_places_of_their_own),
        CASE(positions_on_the_globe_count_on_the_ground),
        CASE(place_numbers_are_taken_as_they_are),
        CASE(the_confidence_suits_the_embedding),
        CASE(what_makes_no_sense_is_refused),
        CASE(too_little_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
