/** @file vdna/geodesy.h
 *  @brief WGS84 latitude, longitude and height to Earth-centred, Earth-fixed metres, and back.
 *
 *  Experience files hold GPS positions in Earth-centred metres, frame VDNA_FRAME_WGS84 of
 * vdna/map.h. Heights are above the ellipsoid. Points within a few nanodegrees of a pole have any
 * longitude.
 */
#ifndef VDNA_GEODESY_H
#define VDNA_GEODESY_H

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Convert degrees and height to Earth-centred metres.
 *  @param lat_deg  -90..90, north positive
 *  @param lon_deg  any finite angle, east positive
 *  @param alt_m    finite
 *  @param out_ecef_m  [3]: x through the equator at longitude 0, y at 90 degrees east, z through
 *                     the North Pole
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_geodesy_to_ecef(double lat_deg, double lon_deg, double alt_m,
                                          double *out_ecef_m);

/** Convert Earth-centred metres to degrees, accurate to 1e-9 degrees, and height, to 1e-4 m.
 *  @param ecef_m  [3], finite, 6e6 to 1e8 m from the Earth's centre
 *  @param out_lat_deg  -90..90
 *  @param out_lon_deg  -180..180
 *  @param out_alt_m    above the ellipsoid
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_geodesy_from_ecef(const double *ecef_m, double *out_lat_deg,
                                            double *out_lon_deg, double *out_alt_m);

/** Move a point along its vertical to the ellipsoid, height 0. The straight line between two such
 *  points is their horizontal distance: over 10 km it is shorter than the arc by less than 2 mm.
 *  @param ecef_m  as for vdna_geodesy_from_ecef()
 *  @param out_ecef_m  [3]; may be `ecef_m`
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_geodesy_to_ground(const double *ecef_m, double *out_ecef_m);

#ifdef __cplusplus
}
#endif

#endif
