#include "write.h"

#include <fail.h>
#include <string.h>
#include <unistd.h>

#include "journal.h"
#include "layout.h"
#include "position_frame.h"
#include "rules.h"

/* see write.h */
vdna_status vdna_write_check(const vdna_experience *experience, const char *path, vdna_error *error)
{
    if (!vdna_tensors_fit_host())
        return vdna_fail(error, VDNA_ERR_UNSUPPORTED,
                         "%s: experience files are written from memory as it is, which needs a"
                         " little-endian machine",
                         path);
    vdna_error reason;
    const vdna_status status = vdna_rules_check(experience, &reason);
    if (status != VDNA_OK)
        return vdna_fail(error, status, "%s: not written: %s", path, reason.text);
    return VDNA_OK;
}

static const char *unless_empty(const char *text)
{
    return text[0] != '\0' ? text : NULL;
}

/* see write.h */
vdna_status vdna_write_into(vdna_replace *file, const vdna_experience *experience,
                            vdna_error *error)
{
    const vdna_experience *const e = experience;
    char comparable[VDNA_SHA256_SIZE] = "", version[] = "0";
    vdna_identity_hash(&e->identity, comparable); /* cannot fail: vdna_rules_check() passed */
    version[0] = (char)('0' + vdna_layout_version(e));
    const char *const precision = vdna_identity_precision(&e->identity);
    const vdna_text texts[] = {
        {"format", VDNA_EXPERIENCE_FORMAT},
        {"name", e->name},
        {"backbone", e->identity.backbone},
        {"model_sha256", e->identity.model_sha256},
        {"preprocessing", e->identity.preprocessing},
        {"precision", strcmp(precision, VDNA_PRECISION_DEFAULT) != 0 ? precision : NULL},
        {"taps", e->identity.taps},
        {"embedding", unless_empty(e->identity.embedding)},
        {"comparable", comparable},
        {"position_frame", e->frame_position ? vdna_position_frame_of(e) : NULL},
        {"order", unless_empty(e->order)},
        {"source", unless_empty(e->source)},
        {"format_version", version},
    };
    vdna_field fields[VDNA_FIELD_COUNT];
    vdna_layout_of(e, fields);
    return vdna_tensors_write(file, texts, sizeof texts / sizeof *texts, fields, VDNA_FIELD_COUNT,
                              error);
}

/* If an update of this directory was interrupted when it was final, finish it: it is older than the
 * file that is about to be replaced, and would replace it later. */
static vdna_status finish_update(const vdna_replace *file, vdna_error *error)
{
    if (faccessat(file->directory, VDNA_JOURNAL_FILE, F_OK, 0) != 0)
        return VDNA_OK;
    char directory[VDNA_REPLACE_PATH_SIZE];
    snprintf(directory, sizeof directory, "%.*s.", (int)(file->name - file->path), file->path);
    vdna_map_update *update = NULL;
    const vdna_status status = vdna_map_update_open(directory, error, &update);
    vdna_map_update_close(update);
    return status;
}

/* see vdna/map.h */
vdna_status vdna_experience_write(const vdna_experience *experience, const char *path,
                                  vdna_error *error)
{
    if (!experience || !path)
        return vdna_fail(error, VDNA_ERR_ARG, "experience to write: it or its path is missing");
    vdna_replace file;
    vdna_status status = vdna_write_check(experience, path, error);
    if (status == VDNA_OK)
        status = vdna_replace_begin(path, error, &file);
    if (status == VDNA_OK)
        status = vdna_write_into(&file, experience, error);
    if (status != VDNA_OK)
        return status;
    status = finish_update(&file, error);
    if (status == VDNA_OK)
        return vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, error);
    vdna_replace_abandon(&file);
    return status;
}
