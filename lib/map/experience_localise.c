#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/experience_localise.h>
#include <vdna/geodesy.h>

#include "places.h"

/* Tolerance where there are neither places nor positions to tell. */
#define USUAL_TOLERANCE 2

/* More than the default: people, lorries and glare take the place of pictures. It costs drives
 * without them nothing that can be measured (docs/concepts/localisation.md). */
#define CLUTTER 0.2

/* Constants of the confidence that do not look at distances: the defaults of the library know those
 * about a mean only. */
static const double by_any_distance[4] = {-2.5, 0.53, 1.1, 0};

/* Distances along fewer directions are smaller, so the confidence has other constants: fitted for
 * 16 to 256 directions (docs/concepts/paper.md). */
static void suit_fewer_directions(uint32_t directions, double confidence[4])
{
    confidence[0] = 1 + 0.65 * log2(directions / 64.0);
    confidence[3] = -10.4;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The horizontal positions: height 0. */
static void take_ground_positions(const vdna_experience *experience, vdna_route_position *out)
{
    const int is_global = strcmp(experience->position_frame, VDNA_FRAME_WGS84) == 0;
    for (size_t i = 0; i < experience->frames; i++) {
        const double *const p = experience->frame_position + 3 * i;
        const vdna_route_position ground = {{p[0], p[1], 0}}, unknown = {{NAN, NAN, NAN}};
        out[i] = ground;
        if (is_global && vdna_geodesy_to_ground(p, out[i].at) != VDNA_OK)
            out[i] = unknown;
    }
}

/* The median distance of frames that follow one another; 0 if no two neighbours have a position.
 * @param room  [frames] */
static double median_spacing(const vdna_route_position *positions, uint32_t frames, double *room)
{
    size_t count = 0;
    for (uint32_t i = 1; i < frames; i++) {
        const double apart = vdna_route_apart(&positions[i - 1], &positions[i]);
        if (isfinite(apart))
            room[count++] = apart;
    }
    qsort(room, count, sizeof *room, compare_doubles);
    return count > 0 ? room[count / 2] : 0;
}

static uint32_t rounded_down(double number, uint32_t most)
{
    return number < most ? (uint32_t)number : most;
}

static void number_by_index(uint32_t frames, int64_t *place)
{
    for (uint32_t i = 0; i < frames; i++)
        place[i] = i;
}

/* Places by positions.
 * @param place, out_tolerance  untouched if no two neighbours have a position
 * @param out_found             whether they have */
static vdna_status place_by_positions(const vdna_experience *experience, double tolerance,
                                      int64_t *place, uint32_t *out_tolerance, int *out_found)
{
    const uint32_t frames = experience->frames;
    vdna_route_position *const positions = calloc(frames, sizeof *positions);
    double *const room = calloc(frames, sizeof *room);
    vdna_status status = positions && room ? VDNA_OK : VDNA_ERR_NOMEM;
    if (status == VDNA_OK) {
        take_ground_positions(experience, positions);
        const double spacing = median_spacing(positions, frames, room);
        *out_found = spacing > 0;
        if (spacing > 0)
            *out_tolerance = rounded_down(tolerance / spacing, frames);
        if (spacing > 0 && tolerance > 0)
            status = vdna_route_numbers(positions, frames, tolerance, place);
    }
    free(room);
    free(positions);
    return status;
}

static int is_index(const int64_t *place, uint32_t frames)
{
    uint32_t i = 0;
    while (i < frames && place[i] == i)
        i++;
    return i == frames;
}

/* see vdna/experience_localise.h */
vdna_status vdna_experience_localise_config(const vdna_experience *experience, double tolerance,
                                            int64_t *place, vdna_localise_config *config)
{
    if (!experience || !(tolerance >= 0) || isinf(tolerance) || !place || !config ||
        experience->frames == 0)
        return VDNA_ERR_ARG;
    const uint32_t frames = experience->frames;
    uint32_t places_tolerance = USUAL_TOLERANCE;
    int found = 0;
    number_by_index(frames, place);
    if (experience->frame_position) {
        const vdna_status status =
            place_by_positions(experience, tolerance, place, &places_tolerance, &found);
        if (status != VDNA_OK)
            return status;
    }
    if (!found && experience->frame_place) {
        memcpy(place, experience->frame_place, frames * sizeof *place);
        places_tolerance = rounded_down(tolerance, UINT32_MAX);
    }
    config->tolerance = places_tolerance;
    config->clutter = CLUTTER;
    config->place = is_index(place, frames) ? NULL : place;
    if (!vdna_identity_is_centred(&experience->identity))
        memcpy(config->confidence, by_any_distance, sizeof by_any_distance);
    else if (experience->identity.projection)
        suit_fewer_directions(experience->identity.dim, config->confidence);
    return VDNA_OK;
}
