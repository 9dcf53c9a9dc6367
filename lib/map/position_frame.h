/* Private to lib/map: the Cartesian frame that the positions of an experience are in. */
#ifndef VDNA_POSITION_FRAME_H
#define VDNA_POSITION_FRAME_H

#include <vdna/map.h>

/* Whether a position lies where GPS can put one: near the surface of the Earth, seen from its
 * centre. */
int vdna_position_is_on_globe(const double position[3]);

/* The frame of the positions: as given, or by their size where nothing is said. "" without
 * positions. */
const char *vdna_position_frame_of(const vdna_experience *experience);

#endif
