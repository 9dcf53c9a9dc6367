#include "position_frame.h"

#include <math.h>

/* Metres from the centre of the Earth: generous, because this only tells GPS from local metres. */
#define LOWEST_M 6.3e6
#define HIGHEST_M 6.5e6

/* see position_frame.h */
int vdna_position_is_on_globe(const double position[3])
{
    const double x = position[0], y = position[1], z = position[2];
    const double square = x * x + y * y + z * z;
    return square >= LOWEST_M * LOWEST_M && square <= HIGHEST_M * HIGHEST_M;
}

/* see position_frame.h */
const char *vdna_position_frame_of(const vdna_experience *experience)
{
    const vdna_experience *e = experience;
    if (!e->frame_position)
        return "";
    if (e->position_frame[0] != '\0')
        return e->position_frame;
    for (size_t f = 0; f < e->frames; f++)
        if (!isnan(e->frame_position[3 * f]) &&
            !vdna_position_is_on_globe(e->frame_position + 3 * f))
            return VDNA_FRAME_LOCAL;
    return VDNA_FRAME_WGS84;
}
