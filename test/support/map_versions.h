/* A map of three experiences that are always updated together, and say by which update. */
#ifndef MAP_VERSIONS_H
#define MAP_VERSIONS_H

#include <sys/wait.h>

#include "cmocka_all.h"
#include "map_files.h"

static const char *const names[] = {"night", "summer", "winter"};
enum { NAMES = 3 };

/* One of the three, whose first embedding tells which update wrote it. Those of different updates
 * do not compare. */
static inline vdna_experience experience_of(const char *name, float version, float *embeddings)
{
    vdna_experience e = sample_experience();
    memcpy(embeddings, e.embeddings, sizeof(float) * e.frames * e.identity.dim);
    embeddings[0] = version;
    e.embeddings = embeddings;
    strcpy(e.name, name);
    snprintf(e.identity.preprocessing, sizeof e.identity.preprocessing, "update %.0f",
             (double)version);
    return e;
}

/* Write the first `count` of the three in one update. */
static inline vdna_status update_some(const char *path, float version, int count, vdna_error *error)
{
    vdna_map_update *update;
    vdna_status status = vdna_map_update_open(path, error, &update);
    if (status != VDNA_OK)
        return status;
    for (int i = 0; i < count && status == VDNA_OK; i++) {
        float embeddings[64];
        const vdna_experience e = experience_of(names[i], version, embeddings);
        status = vdna_map_update_add(update, &e, error);
    }
    if (status == VDNA_OK)
        status = vdna_map_update_commit(update, error);
    vdna_map_update_close(update);
    return status;
}

static inline vdna_status update_all(const char *path, float version, vdna_error *error)
{
    return update_some(path, version, NAMES, error);
}

/* The update that all of a map are from, which must be one and the same. */
static inline float version_of_some(const char *path, uint32_t *out_count)
{
    vdna_experience open[NAMES];
    vdna_error error = {""};
    if (vdna_map_open(path, NAMES, &error, open, out_count) != VDNA_OK)
        fail_msg("%s", error.text);
    const float version = open[0].embeddings[0];
    for (uint32_t i = 0; i < *out_count; i++) {
        assert_string_equal(open[i].name, names[i]);
        assert_true(open[i].embeddings[0] == version);
        vdna_experience_close(&open[i]);
    }
    return version;
}

static inline float version_of(const char *path)
{
    uint32_t count = 0;
    const float version = version_of_some(path, &count);
    assert_int_equal(count, NAMES);
    return version;
}

#endif
