#include <errno.h>
#include <fail.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "map_trust_file.h"
#include "open.h"

/* ---- Opening ---- */

static vdna_status useless(const char *directory, vdna_status status, const vdna_error *reason,
                           vdna_error *error)
{
    return vdna_fail(error, status,
                     "%s/" VDNA_MAP_TRUST_FILE ": %s; make it again with `vdna calibrate --trust "
                     "%s`",
                     directory, reason->text, directory);
}

static vdna_status find_member(const vdna_map_trust_file *file, const vdna_experience *experience,
                               vdna_error *reason, uint32_t *out_member)
{
    if (strcmp(file->comparable, experience->comparable) != 0)
        return vdna_fail(reason, VDNA_ERR_MISMATCH,
                         "is of another map: what it knows does not compare with experience %s",
                         experience->name);
    uint32_t m = 0;
    while (m < file->members && strcmp(vdna_map_trust_name(file, m), experience->name) != 0)
        m++;
    if (m == file->members)
        return vdna_fail(reason, VDNA_ERR_MISMATCH, "does not know experience %s",
                         experience->name);
    if (file->checksums[m] != experience->checksum)
        return vdna_fail(reason, VDNA_ERR_MISMATCH,
                         "knows experience %s with CRC-32C %08" PRIx32 ", now it has %08" PRIx32,
                         experience->name, file->checksums[m], experience->checksum);
    *out_member = m;
    return VDNA_OK;
}

/* Tables to be filled. */
typedef struct run_tables {
    vdna_trust_cell *cells; /* [runs][runs], the beginning of the block */
    double *own_scale, *correlation;
    uint32_t *frames;
} run_tables;

/* @return 0 if there is no memory left */
static int allocate_tables(uint32_t runs, run_tables *out)
{
    const size_t row = runs * sizeof *out->cells + 2 * sizeof(double) + sizeof(uint64_t);
    out->cells = calloc(runs, row);
    if (!out->cells)
        return 0;
    out->own_scale = (double *)(out->cells + (size_t)runs * runs);
    out->correlation = out->own_scale + runs;
    out->frames = (uint32_t *)(void *)(out->correlation + runs);
    return 1;
}

/* Copy the rows and columns of members.
 * @param to  its `frames` are the members, and become their frames */
static void copy_tables(const vdna_map_trust_file *file, uint32_t runs, const run_tables *to)
{
    const vdna_trust_tables *const from = &file->tables;
    for (size_t a = 0; a < runs; a++) {
        const size_t member = to->frames[a];
        to->own_scale[a] = from->own_scale[member];
        to->correlation[a] = from->correlation[member];
        for (size_t b = 0; b < runs; b++)
            to->cells[a * runs + b] = from->cells[member * file->members + to->frames[b]];
    }
    for (size_t a = 0; a < runs; a++)
        to->frames[a] = from->frames[to->frames[a]];
}

/* Find the members that experiences are.
 * @param out_members  [count], of which *out_found are filled
 * @param out_known  [count], whether each is a member; NULL = each has to be one */
static vdna_status find_members(const vdna_map_trust_file *file, const vdna_experience *experiences,
                                uint32_t count, vdna_error *reason, uint32_t *out_members,
                                uint8_t *out_known, uint32_t *out_found)
{
    vdna_status status = VDNA_OK;
    *out_found = 0;
    for (uint32_t i = 0; i < count; i++) {
        status = find_member(file, &experiences[i], reason, &out_members[*out_found]);
        const int is_known = status == VDNA_OK;
        if (out_known)
            out_known[i] = (uint8_t)is_known;
        else if (!is_known)
            return status;
        *out_found += (uint32_t)is_known;
    }
    return *out_found > 0 ? VDNA_OK : status;
}

static vdna_status take_tables(const vdna_map_trust_file *file, const vdna_experience *experiences,
                               uint32_t count, vdna_error *reason, uint8_t *out_known,
                               vdna_map_trust *out)
{
    run_tables to;
    if (!allocate_tables(count, &to))
        return vdna_fail(reason, VDNA_ERR_NOMEM,
                         "no memory left for the tables of %" PRIu32 " experiences", count);
    uint32_t found = 0;
    const vdna_status status =
        find_members(file, experiences, count, reason, to.frames, out_known, &found);
    if (status != VDNA_OK) {
        free(to.cells);
        return status;
    }
    copy_tables(file, found, &to);
    out->tables = (vdna_trust_tables){to.frames, to.own_scale, to.correlation, to.cells};
    out->tolerance = *file->tolerance;
    out->runs = found;
    out->localiser = file->localiser;
    out->memory = to.cells;
    return VDNA_OK;
}

static vdna_status open_bytes_of(const char *directory, vdna_error *error,
                                 vdna_file_bytes *out_file)
{
    char path[VDNA_REPLACE_PATH_SIZE];
    const vdna_status status = vdna_map_trust_path(directory, error, path);
    if (status != VDNA_OK)
        return status;
    const int descriptor = open(path, VDNA_OPEN_FLAGS);
    if (descriptor < 0 && errno == ENOENT)
        return vdna_fail(error, VDNA_ERR_EMPTY,
                         "%s: there is no such file, so the map knows nothing about itself; make "
                         "it with `vdna calibrate --trust %s`",
                         path, directory);
    return vdna_open_bytes(descriptor, VDNA_OPEN_COPIED, path, error, out_file);
}

/* @param out_known  as for find_members() */
static vdna_status open_trust(const char *directory, const vdna_experience *experiences,
                              uint32_t count, vdna_error *error, uint8_t *out_known,
                              vdna_map_trust *out_trust)
{
    if (!directory || !experiences || count == 0 || count > VDNA_TRUST_RUNS_MAX || !out_trust)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "what a map knows about itself: expected a directory, 1 to %u experiences"
                         " and a place for it",
                         VDNA_TRUST_RUNS_MAX);
    vdna_file_bytes bytes = {NULL, 0};
    vdna_status status = open_bytes_of(directory, error, &bytes);
    if (status != VDNA_OK)
        return status;
    vdna_error reason;
    vdna_map_trust_file file;
    status = vdna_map_trust_read(bytes.bytes, bytes.size, &reason, &file);
    if (status == VDNA_OK)
        status = take_tables(&file, experiences, count, &reason, out_known, out_trust);
    vdna_close_bytes(&bytes);
    return status == VDNA_OK ? status : useless(directory, status, &reason, error);
}

/* see vdna/map_trust.h */
vdna_status vdna_map_trust_open(const char *directory, const vdna_experience *experiences,
                                uint32_t count, vdna_error *error, vdna_map_trust *out_trust)
{
    return open_trust(directory, experiences, count, error, NULL, out_trust);
}

/* see vdna/map_trust.h */
vdna_status vdna_map_trust_open_known(const char *directory, const vdna_experience *experiences,
                                      uint32_t count, vdna_error *error, uint8_t *out_known,
                                      vdna_map_trust *out_trust)
{
    if (!out_known)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "what a map knows about itself: no place for which experiences it knows");
    return open_trust(directory, experiences, count, error, out_known, out_trust);
}

/* see vdna/map_trust.h */
void vdna_map_trust_close(vdna_map_trust *trust)
{
    if (!trust)
        return;
    free(trust->memory);
    memset(trust, 0, sizeof *trust);
}

/* ---- Writing ---- */

/* Names and checksums of the members, as the file has them. */
typedef struct member_list {
    char *names;         /* [runs][VDNA_NAME_SIZE], allocated */
    uint32_t *checksums; /* [runs], allocated */
} member_list;

static vdna_status list_members(const vdna_experience *experiences, const vdna_map_trust *trust,
                                vdna_error *reason, const member_list *list)
{
    for (uint32_t i = 0; i < trust->runs; i++) {
        const vdna_experience *const e = &experiences[i];
        if (!e->file_bytes)
            return vdna_fail(reason, VDNA_ERR_ARG, "experience %.63s is not from a file", e->name);
        if (strcmp(e->comparable, experiences[0].comparable) != 0)
            return vdna_fail(reason, VDNA_ERR_MISMATCH, "experiences %s and %s do not compare",
                             experiences[0].name, e->name);
        if (e->frames != trust->tables.frames[i])
            return vdna_fail(reason, VDNA_ERR_MISMATCH,
                             "experience %s has %" PRIu32 " frames, its tables are of %" PRIu32,
                             e->name, e->frames, trust->tables.frames[i]);
        memcpy(list->names + (size_t)i * VDNA_NAME_SIZE, e->name, strlen(e->name));
        list->checksums[i] = e->checksum;
    }
    return VDNA_OK;
}

static vdna_status write_file(const char *directory, const vdna_map_trust_file *file,
                              vdna_error *error)
{
    char path[VDNA_REPLACE_PATH_SIZE], version[] = "0";
    vdna_replace replace;
    vdna_status status = vdna_map_trust_path(directory, error, path);
    if (status == VDNA_OK)
        status = vdna_replace_begin(path, error, &replace);
    if (status != VDNA_OK)
        return status;
    version[0] = (char)('0' + vdna_map_trust_format.version);
    const vdna_text texts[] = {
        {"format", vdna_map_trust_format.name},
        {"comparable", file->comparable},
        {"localiser", vdna_map_trust_localisers[file->localiser]},
        {"format_version", version},
    };
    vdna_field fields[VDNA_TRUST_FIELD_COUNT];
    vdna_map_trust_layout_of(file, fields);
    status = vdna_tensors_write(&replace, texts, sizeof texts / sizeof *texts, fields,
                                VDNA_TRUST_FIELD_COUNT, error);
    return status == VDNA_OK ? vdna_replace_commit(&replace, VDNA_REPLACE_DURABLE, error) : status;
}

static vdna_status check_and_write(const char *directory, const vdna_experience *experiences,
                                   const vdna_map_trust *trust, const member_list *list,
                                   vdna_error *error)
{
    vdna_error reason;
    vdna_map_trust_file file = {
        .localiser = trust->localiser,
        .members = trust->runs,
        .tolerance = &trust->tolerance,
        .names = list->names,
        .checksums = list->checksums,
        .tables = trust->tables,
    };
    vdna_status status = list_members(experiences, trust, &reason, list);
    if (status == VDNA_OK) {
        memcpy(file.comparable, experiences[0].comparable, sizeof file.comparable);
        status = vdna_map_trust_check(&file, &reason);
    }
    if (status != VDNA_OK)
        return vdna_fail(error, status, "%s/" VDNA_MAP_TRUST_FILE ": not written: %s", directory,
                         reason.text);
    return write_file(directory, &file, error);
}

/* see vdna/map_trust.h */
vdna_status vdna_map_trust_write(const char *directory, const vdna_experience *experiences,
                                 const vdna_map_trust *trust, vdna_error *error)
{
    if (!directory || !experiences || !trust || trust->runs == 0 ||
        trust->runs > VDNA_TRUST_RUNS_MAX || trust->localiser > VDNA_TRUST_EUCLIDEAN ||
        !trust->tables.frames)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "what a map knows about itself: expected a directory, 1 to %u experiences"
                         " with their tables, and a localiser",
                         VDNA_TRUST_RUNS_MAX);
    if (!vdna_tensors_fit_host())
        return vdna_fail(error, VDNA_ERR_UNSUPPORTED,
                         "%s: files of a map are written from memory as it is, which needs a"
                         " little-endian machine",
                         directory);
    const member_list list = {calloc(trust->runs, VDNA_NAME_SIZE),
                              calloc(trust->runs, sizeof *list.checksums)};
    const vdna_status status =
        list.names && list.checksums
            ? check_and_write(directory, experiences, trust, &list, error)
            : vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", directory);
    free(list.names);
    free(list.checksums);
    return status;
}
