#include "places.h"

#include <math.h>
#include <stdlib.h>

#include <vdna/map.h>

/* A cube of the tolerance's size. */
typedef struct place_cell {
    double at[3];
} place_cell;

/* A spot of the route. */
typedef struct place_post {
    vdna_route_position position;
    uint32_t number;
    uint32_t next; /* in its bucket, or among those not left; NO_POST = none */
} place_post;

#define NO_POST UINT32_MAX

typedef struct place_route {
    double tolerance;
    place_post *posts; /* [count], by number */
    uint32_t *buckets; /* [bucket_count] of cells, first post of each that was left */
    uint32_t count, bucket_count;
    uint32_t near; /* first post that was not left */
} place_route;

/* see places.h */
double vdna_route_apart(const vdna_route_position *a, const vdna_route_position *b)
{
    const double dx = a->at[0] - b->at[0], dy = a->at[1] - b->at[1], dz = a->at[2] - b->at[2];
    return sqrt(dx * dx + dy * dy + dz * dz);
}

static int is_known(const vdna_route_position *position)
{
    return isfinite(position->at[0] + position->at[1] + position->at[2]);
}

static place_cell cell_of(const place_route *route, const vdna_route_position *position)
{
    return (place_cell){{floor(position->at[0] / route->tolerance),
                         floor(position->at[1] / route->tolerance),
                         floor(position->at[2] / route->tolerance)}};
}

static int is_in(const place_route *route, const place_post *post, const place_cell *where)
{
    const place_cell found = cell_of(route, &post->position);
    return found.at[0] == where->at[0] && found.at[1] == where->at[1] &&
           found.at[2] == where->at[2];
}

static uint32_t *bucket_of(const place_route *route, const place_cell *where)
{
    uint64_t hash = 0;
    for (int i = 0; i < 3; i++) {
        /* Cells beyond what an integer holds share a bucket. */
        const double side = fmod(where->at[i], 4503599627370496.0);
        hash = (hash ^ (uint64_t)(int64_t)side) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return &route->buckets[hash % route->bucket_count];
}

/* Move the posts that are farther than twice the tolerance to their cells. */
static void leave_posts(place_route *route, const vdna_route_position *position)
{
    uint32_t *link = &route->near;
    while (*link != NO_POST) {
        place_post *const near = &route->posts[*link];
        if (vdna_route_apart(&near->position, position) <= 2 * route->tolerance) {
            link = &near->next;
            continue;
        }
        const place_cell where = cell_of(route, &near->position);
        uint32_t *const bucket = bucket_of(route, &where);
        const uint32_t left = *link;
        *link = near->next;
        near->next = *bucket;
        *bucket = left;
    }
}

/* The nearest post of a cell within the distance, the lowest of equals. */
static void look_into(const place_route *route, const place_cell *where,
                      const vdna_route_position *position, double *distance, uint32_t *nearest)
{
    for (uint32_t i = *bucket_of(route, where); i != NO_POST; i = route->posts[i].next) {
        if (!is_in(route, &route->posts[i], where))
            continue;
        const double apart = vdna_route_apart(&route->posts[i].position, position);
        if (apart < *distance || (apart == *distance && i < *nearest)) {
            *distance = apart;
            *nearest = i;
        }
    }
}

/* The nearest post within tolerance that was left; NO_POST = none. */
static uint32_t passed_before(const place_route *route, const vdna_route_position *position)
{
    const place_cell middle = cell_of(route, position);
    double distance = route->tolerance;
    uint32_t nearest = NO_POST;
    for (int n = 0; n < 27; n++) {
        const int dx = n % 3 - 1, dy = n / 3 % 3 - 1, dz = n / 9 - 1;
        const place_cell where = {{middle.at[0] + dx, middle.at[1] + dy, middle.at[2] + dz}};
        look_into(route, &where, position, &distance, &nearest);
    }
    return nearest;
}

static int has_post_near(const place_route *route, const vdna_route_position *position)
{
    for (uint32_t i = route->near; i != NO_POST; i = route->posts[i].next)
        if (vdna_route_apart(&route->posts[i].position, position) < route->tolerance / 4)
            return 1;
    return 0;
}

/* The number of a frame, which becomes a post if it is the first in its spot. */
static uint32_t number_of(place_route *route, const vdna_route_position *position, uint32_t index)
{
    leave_posts(route, position);
    const uint32_t earlier = passed_before(route, position);
    if (earlier != NO_POST)
        return route->posts[earlier].number;
    if (!has_post_near(route, position)) {
        const place_post new_post = {*position, index, route->near};
        route->posts[route->count] = new_post;
        route->near = route->count++;
    }
    return index;
}

/* see places.h */
vdna_status vdna_route_numbers(const vdna_route_position *positions, uint32_t frames,
                               double tolerance, int64_t *out)
{
    place_route route = {
        tolerance, calloc(frames, sizeof(place_post)), calloc(frames, sizeof(uint32_t)), 0, frames,
        NO_POST};
    const vdna_status status = route.posts && route.buckets ? VDNA_OK : VDNA_ERR_NOMEM;
    for (uint32_t i = 0; i < frames && status == VDNA_OK; i++)
        route.buckets[i] = NO_POST;
    for (uint32_t i = 0; i < frames && status == VDNA_OK; i++)
        out[i] = is_known(&positions[i]) ? (int64_t)number_of(&route, &positions[i], i)
                                         : VDNA_PLACE_NONE;
    free(route.buckets);
    free(route.posts);
    return status;
}
