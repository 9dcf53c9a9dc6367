#include <string.h>

#include <vdna/health.h>

#include "growth.h"

#define OLDEST_HEALTH_CONFIG sizeof(vdna_health_config) /* in version 0.1 */

static const vdna_health_config health_defaults = {
    sizeof(vdna_health_config), 32, 16, 25, 900, 150, 5, VDNA_HEALTH_REMEMBERED_MAX, 32};

/* see vdna/health.h */
void vdna_health_config_init(vdna_health_config *config)
{
    vdna_config_write(config, OLDEST_HEALTH_CONFIG, &health_defaults, sizeof health_defaults);
}

/* see vdna/health.h */
vdna_status vdna_health_init(vdna_health *health, const vdna_health_config *config)
{
    vdna_health_config known = health_defaults;
    if (!health ||
        (config && !vdna_config_read(config, OLDEST_HEALTH_CONFIG, &known, sizeof known)))
        return VDNA_ERR_ARG;
    if (known.max_resize < 100 || known.remembered > VDNA_HEALTH_REMEMBERED_MAX ||
        known.window < 1 || known.window > VDNA_HEALTH_WINDOW_MAX)
        return VDNA_ERR_ARG;
    memset(health, 0, sizeof *health);
    health->config = known;
    return VDNA_OK;
}

/* see vdna/health.h */
uint32_t vdna_health_judge(const vdna_health *health, const vdna_health_picture *picture)
{
    const vdna_health_config *limits = &health->config;
    if (picture->width < limits->min_side || picture->height < limits->min_side)
        return VDNA_HEALTH_TOO_SMALL;
    if (picture->bright > limits->max_bright)
        return VDNA_HEALTH_SATURATED;
    if (picture->contrast < limits->min_contrast)
        return VDNA_HEALTH_UNIFORM;
    if (100 * (uint64_t)picture->structure < (uint64_t)limits->min_structure * picture->grain)
        return VDNA_HEALTH_NOISE;
    return VDNA_HEALTH_OK;
}

static int is_resized(uint32_t before, uint32_t now, uint32_t percent)
{
    const uint64_t shorter = before < now ? before : now, longer = before < now ? now : before;
    return 100 * longer > percent * shorter;
}

/* The first frame's size has settled already. */
static int size_changes(vdna_health *health, const vdna_health_picture *picture)
{
    const vdna_health_config *config = &health->config;
    if (health->frames == 0)
        health->settled = config->settle;
    else if (is_resized(health->width, picture->width, config->max_resize) ||
             is_resized(health->height, picture->height, config->max_resize))
        health->settled = 0;
    health->width = picture->width;
    health->height = picture->height;
    if (health->settled == config->settle)
        return 0;
    health->settled++;
    return 1;
}

static int is_remembered(const vdna_health *health, uint64_t hash)
{
    const uint32_t room = health->config.remembered;
    for (uint32_t i = 0; i < room && i < health->counts[VDNA_HEALTH_OK]; i++)
        if (health->hashes[i] == hash)
            return 1;
    return 0;
}

static uint32_t verdict_of(vdna_health *health, const vdna_health_picture *picture)
{
    const int is_changed = size_changes(health, picture);
    const uint32_t own = vdna_health_judge(health, picture);
    if (own != VDNA_HEALTH_OK)
        return own;
    if (is_changed)
        return VDNA_HEALTH_SIZE_CHANGED;
    if (!is_remembered(health, picture->hash))
        return VDNA_HEALTH_OK;
    return picture->hash == health->newest ? VDNA_HEALTH_FROZEN : VDNA_HEALTH_REPEATED;
}

/* see vdna/health.h */
uint32_t vdna_health_take(vdna_health *health, const vdna_health_picture *picture)
{
    const uint32_t verdict = verdict_of(health, picture);
    if (verdict == VDNA_HEALTH_OK && health->config.remembered > 0)
        health->hashes[health->counts[VDNA_HEALTH_OK] % health->config.remembered] = picture->hash;
    health->verdicts[health->frames % health->config.window] = (uint8_t)verdict;
    health->newest = picture->hash;
    health->counts[verdict]++;
    health->frames++;
    return verdict;
}

/* see vdna/health.h */
uint32_t vdna_health_degraded(const vdna_health *health)
{
    uint32_t counts[VDNA_HEALTH_COUNT] = {0}, frames = 0;
    for (; frames < health->config.window && frames < health->frames; frames++)
        counts[health->verdicts[frames]]++;
    if (2 * counts[VDNA_HEALTH_OK] >= frames)
        return VDNA_HEALTH_OK;
    uint32_t most = VDNA_HEALTH_OK + 1;
    for (uint32_t verdict = most + 1; verdict < VDNA_HEALTH_COUNT; verdict++)
        if (counts[verdict] > counts[most])
            most = verdict;
    return most;
}

/* see vdna/health.h */
const char *vdna_health_text(uint32_t verdict)
{
    static const char *const texts[VDNA_HEALTH_COUNT] = {
        "ok", "too small", "saturated", "uniform", "noise", "size changed", "frozen", "repeated"};
    return verdict < VDNA_HEALTH_COUNT ? texts[verdict] : "unknown verdict";
}
