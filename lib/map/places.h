/* Numbers for the places of a route; vdna/experience_localise.h defines them. Private to lib/map.
 */
#ifndef VDNA_MAP_PLACES_H
#define VDNA_MAP_PLACES_H

#include <vdna/status.h>

/* A horizontal position, metres; not finite = not known. */
typedef struct vdna_route_position {
    double at[3];
} vdna_route_position;

double vdna_route_apart(const vdna_route_position *a, const vdna_route_position *b);

/* Number the frames of a route.
 * @param positions  [frames]
 * @param tolerance  metres, above 0
 * @param out        [frames], the index of the frame that passed first, or VDNA_PLACE_NONE
 * @return VDNA_OK; VDNA_ERR_NOMEM */
vdna_status vdna_route_numbers(const vdna_route_position *positions, uint32_t frames,
                               double tolerance, int64_t *out);

#endif
