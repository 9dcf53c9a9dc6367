/* Degrees and Earth-centred metres: points of PROJ 9.5.1 (pyproj 3.7.2, EPSG:4979 to EPSG:4978),
 * and round trips. */
#include <math.h>

#include <vdna/geodesy.h>

#include "cmocka_all.h"

static const struct {
    double lat_deg, lon_deg, alt_m, ecef_m[3];
} points[] = {
    {0.0, 0.0, 0.0, {6378137.000000000, 0.000000000, 0.000000000}},
    {48.1, 11.5, 531.8, {4182125.932242883, 850863.137394297, 4724705.090134514}},
    {-33.856784, 151.215297, 40.0, {-4646998.483061377, 2553093.634374776, -3533287.938463604}},
    {90.0, 0.0, 0.0, {0.000000000, 0.000000000, 6356752.314245179}},
    {-90.0, 0.0, -20.0, {0.000000000, 0.000000000, -6356732.314245179}},
    {89.9999999, -120.0, 3000.0, {-0.005587317, -0.009677517, 6359752.314245179}},
    {51.7606, -1.2597, 65.25, {3955000.585971749, -86968.310541971, 4986411.502996957}},
    {-1e-07, 179.9999999, 8848.86, {-6386985.860000000, 0.011147394, -0.011072872}},
    {0.5, -179.5, -430.5, {-6377222.447846875, -55653.177174619, 55282.693506214}},
    {45.0, -90.0, 100000.0, {0.000000000, -4588301.556967586, 4558059.086984574}},
};

static void degrees_become_the_metres_of_proj(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        double ecef[3];
        assert_int_equal(
            vdna_geodesy_to_ecef(points[i].lat_deg, points[i].lon_deg, points[i].alt_m, ecef),
            VDNA_OK);
        for (size_t axis = 0; axis < 3; axis++)
            assert_true(fabs(ecef[axis] - points[i].ecef_m[axis]) < 1e-7);
    }
}

static void metres_of_proj_become_degrees(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        double lat, lon, alt;
        assert_int_equal(vdna_geodesy_from_ecef(points[i].ecef_m, &lat, &lon, &alt), VDNA_OK);
        assert_true(fabs(lat - points[i].lat_deg) < 1e-9);
        assert_true(fabs(alt - points[i].alt_m) < 1e-4);
        /* Millimetres from the axis, nanometres of PROJ's digits are many nanodegrees. */
        if (fabs(lat) < 89)
            assert_true(fabs(lon - points[i].lon_deg) < 1e-9);
    }
}

static void there_and_back_is_the_same_point_at_every_height(void **state)
{
    (void)state;
    const double heights[] = {-12000, 0, 9000, 120000, 2e7};
    for (double lat = -90; lat <= 90; lat += 0.37)
        for (size_t h = 0; h < sizeof heights / sizeof *heights; h++) {
            const double lon = remainder(lat * 7, 360);
            double ecef[3], lat_back, lon_back, alt_back;
            assert_int_equal(vdna_geodesy_to_ecef(lat, lon, heights[h], ecef), VDNA_OK);
            assert_int_equal(vdna_geodesy_from_ecef(ecef, &lat_back, &lon_back, &alt_back),
                             VDNA_OK);
            assert_true(fabs(lat_back - lat) < 1e-9);
            assert_true(fabs(alt_back - heights[h]) < 1e-4);
            assert_true(fabs(lon_back - lon) < 1e-9 || lat == -90);
        }
}

/* Metres between two points on the ground. */
static double ground_distance(const double a[3], const double b[3])
{
    double on_a[3], on_b[3];
    assert_int_equal(vdna_geodesy_to_ground(a, on_a), VDNA_OK);
    assert_int_equal(vdna_geodesy_to_ground(b, on_b), VDNA_OK);
    return hypot(hypot(on_a[0] - on_b[0], on_a[1] - on_b[1]), on_a[2] - on_b[2]);
}

static void height_does_not_count_on_the_ground(void **state)
{
    (void)state;
    double low[3], high[3], elsewhere[3];
    vdna_geodesy_to_ecef(48.1, 11.5, 519.3, low);
    vdna_geodesy_to_ecef(48.1, 11.5, 1519.3, high);
    vdna_geodesy_to_ecef(48.15, 11.6, 0, elsewhere);
    assert_true(ground_distance(low, high) < 1e-6);
    /* PROJ's geodesic between the same points is 9291.393 m long. */
    assert_true(fabs(ground_distance(high, elsewhere) - 9291.392913) < 2e-3);
}

static void what_is_no_point_near_the_earth_is_refused(void **state)
{
    (void)state;
    const double good[3] = {6.4e6, 0, 0}, inside[3] = {1, 2, 3}, nowhere[3] = {NAN, NAN, NAN},
                 far[3] = {0, 2e8, 0};
    double lat = 7, lon = 7, alt = 7, ecef[3] = {7, 7, 7};
    assert_int_equal(vdna_geodesy_from_ecef(inside, &lat, &lon, &alt), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_from_ecef(nowhere, &lat, &lon, &alt), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_from_ecef(far, &lat, &lon, &alt), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_from_ecef(NULL, &lat, &lon, &alt), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_from_ecef(good, NULL, &lon, &alt), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_from_ecef(good, &lat, NULL, &alt), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_from_ecef(good, &lat, &lon, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ground(inside, ecef), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ground(good, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ecef(90.1, 0, 0, ecef), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ecef(NAN, 0, 0, ecef), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ecef(0, INFINITY, 0, ecef), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ecef(0, 0, NAN, ecef), VDNA_ERR_ARG);
    assert_int_equal(vdna_geodesy_to_ecef(0, 0, 0, NULL), VDNA_ERR_ARG);
    assert_true(lat == 7 && lon == 7 && alt == 7 && ecef[0] == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(degrees_become_the_metres_of_proj),
        cmocka_unit_test(metres_of_proj_become_degrees),
        cmocka_unit_test(there_and_back_is_the_same_point_at_every_height),
        cmocka_unit_test(height_does_not_count_on_the_ground),
        cmocka_unit_test(what_is_no_point_near_the_earth_is_refused),
    };
    return cmocka_run_group_tests_name("geodesy", tests, NULL, NULL);
}
