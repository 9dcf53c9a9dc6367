#include <math.h>

#include <vdna/geodesy.h>

/* WGS84: semi-axes in metres, first eccentricity squared, second eccentricity squared. */
#define A 6378137.0
#define F (1 / 298.257223563)
#define B (A * (1 - F))
#define E2 (F * (2 - F))
#define E2_PRIME (E2 / (1 - E2))

#define DEGREE (3.14159265358979323846 / 180)

/* Where the iteration below is accurate; see vdna_geodesy_from_ecef(). */
#define NEAREST_M 6e6
#define FARTHEST_M 1e8

/* see vdna/geodesy.h */
vdna_status vdna_geodesy_to_ecef(double lat_deg, double lon_deg, double alt_m, double *out_ecef_m)
{
    if (!out_ecef_m || !(fabs(lat_deg) <= 90) || !isfinite(lon_deg) || !isfinite(alt_m))
        return VDNA_ERR_ARG;
    const double lat = lat_deg * DEGREE, lon = lon_deg * DEGREE;
    const double n = A / sqrt(1 - E2 * sin(lat) * sin(lat));
    out_ecef_m[0] = (n + alt_m) * cos(lat) * cos(lon);
    out_ecef_m[1] = (n + alt_m) * cos(lat) * sin(lon);
    out_ecef_m[2] = (n * (1 - E2) + alt_m) * sin(lat);
    return VDNA_OK;
}

/* Latitude in radians of a point `axis` metres from the Earth's axis and `z` metres north of the
 * equator: Bowring's iteration of the reduced latitude. Its error shrinks at least a hundredfold a
 * step, and begins below 1e-3. */
static double latitude_of(double axis, double z)
{
    double reduced = atan2(z, axis * (1 - F));
    double lat = reduced;
    for (int step = 0; step < 6; step++) {
        const double s = sin(reduced), c = cos(reduced);
        lat = atan2(z + E2_PRIME * B * s * s * s, axis - E2 * A * c * c * c);
        reduced = atan2((1 - F) * sin(lat), cos(lat));
    }
    return lat;
}

/* see vdna/geodesy.h */
vdna_status vdna_geodesy_from_ecef(const double *ecef_m, double *out_lat_deg, double *out_lon_deg,
                                   double *out_alt_m)
{
    if (!ecef_m || !out_lat_deg || !out_lon_deg || !out_alt_m)
        return VDNA_ERR_ARG;
    const double x = ecef_m[0], y = ecef_m[1], z = ecef_m[2];
    const double axis = hypot(x, y), centre = hypot(axis, z);
    if (!(centre >= NEAREST_M && centre <= FARTHEST_M))
        return VDNA_ERR_ARG;
    const double lat = latitude_of(axis, z), s = sin(lat);
    *out_lat_deg = lat / DEGREE;
    *out_lon_deg = atan2(y, x) / DEGREE;
    /* Unlike axis / cos(lat) - n, this is accurate at the poles, too. */
    *out_alt_m = axis * cos(lat) + z * s - A * sqrt(1 - E2 * s * s);
    return VDNA_OK;
}

/* see vdna/geodesy.h */
vdna_status vdna_geodesy_to_ground(const double *ecef_m, double *out_ecef_m)
{
    double lat = 0, lon = 0, alt = 0;
    if (!out_ecef_m || vdna_geodesy_from_ecef(ecef_m, &lat, &lon, &alt) != VDNA_OK)
        return VDNA_ERR_ARG;
    return vdna_geodesy_to_ecef(lat, lon, 0, out_ecef_m);
}
