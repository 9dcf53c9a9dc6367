#include "map_trust_file.h"

#include <fail.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

const vdna_format vdna_map_trust_format = {"vdna-trust", VDNA_MAP_TRUST_FORMAT};

const char *const vdna_map_trust_localisers[2] = {
    [VDNA_TRUST_CENTRED] = "centred",
    [VDNA_TRUST_EUCLIDEAN] = "euclidean",
};

enum { CELL_NUMBERS = sizeof(vdna_trust_cell) / sizeof(double) / VDNA_TRUST_WINDOWS };

void vdna_map_trust_layout_of(const vdna_map_trust_file *file,
                              vdna_field out_fields[VDNA_TRUST_FIELD_COUNT])
{
    const uint32_t members = file->members;
    const vdna_trust_tables *const t = &file->tables;
    const vdna_field fields[VDNA_TRUST_FIELD_COUNT] = {
        {"tolerance", "F64", 8, 0, {1}, file->tolerance},
        {"own_scale", "F64", 8, 0, {members}, t->own_scale},
        {"correlation", "F64", 8, 0, {members}, t->correlation},
        {"cells", "F64", 8, 0, {members, members, CELL_NUMBERS, VDNA_TRUST_WINDOWS}, t->cells},
        {"frames", "U32", 4, 0, {members}, t->frames},
        {"member_crc32c", "U32", 4, 0, {members}, file->checksums},
        {"member_name", "U8", 1, 0, {members, VDNA_NAME_SIZE}, file->names},
    };
    memcpy(out_fields, fields, sizeof fields);
}

static int is_sha256(const char *text)
{
    return strspn(text, "0123456789abcdef") == VDNA_SHA256_SIZE - 1;
}

static int is_padded(const char name[VDNA_NAME_SIZE])
{
    for (size_t i = strlen(name); i < VDNA_NAME_SIZE; i++)
        if (name[i] != '\0')
            return 0;
    return 1;
}

static vdna_status check_members(const vdna_map_trust_file *file, vdna_error *reason)
{
    for (uint32_t i = 0; i < file->members; i++) {
        const char *const name = vdna_map_trust_name(file, i);
        vdna_error why;
        if (vdna_name_check(name, &why) != VDNA_OK)
            return vdna_fail(reason, VDNA_ERR_ARG, "member_name %" PRIu32 " %s", i, why.text);
        if (!is_padded(name))
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "member_name %" PRIu32 " goes on after its end, expected NULs", i);
        for (uint32_t j = 0; j < i; j++)
            if (strcmp(vdna_map_trust_name(file, j), name) == 0)
                return vdna_fail(reason, VDNA_ERR_MISMATCH,
                                 "two members are called %s, expected different names", name);
    }
    return VDNA_OK;
}

vdna_status vdna_map_trust_check(const vdna_map_trust_file *file, vdna_error *reason)
{
    if (!is_sha256(file->comparable))
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "comparable is no SHA-256, expected 64 lower-case hexadecimal digits");
    if (!isfinite(*file->tolerance) || *file->tolerance < 0)
        return vdna_fail(reason, VDNA_ERR_ARG, "tolerance is %g, expected a finite number from 0",
                         *file->tolerance);
    const vdna_status status = vdna_trust_tables_check(&file->tables, file->members);
    if (status != VDNA_OK)
        return vdna_fail(reason, status, "a number of the tables is beyond its range");
    return check_members(file, reason);
}

static vdna_status read_members(const vdna_header *header, vdna_error *reason,
                                vdna_map_trust_file *file)
{
    const vdna_tensor *tensor = vdna_header_tensor(header, "member_name");
    const uint64_t members = tensor ? tensor->shape[0] : 0;
    if (members == 0 || members > VDNA_TRUST_RUNS_MAX)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "tensor member_name has %" PRIu64 " rows, expected 1 to %u", members,
                         VDNA_TRUST_RUNS_MAX);
    file->members = (uint32_t)members;
    return VDNA_OK;
}

static vdna_status read_localiser(const vdna_header *header, vdna_error *reason,
                                  vdna_map_trust_file *file)
{
    const char *text = vdna_header_text(header, "localiser");
    for (uint32_t l = 0; text && l <= VDNA_TRUST_EUCLIDEAN; l++)
        if (strcmp(text, vdna_map_trust_localisers[l]) == 0) {
            file->localiser = l;
            return VDNA_OK;
        }
    return vdna_fail(reason, VDNA_ERR_FORMAT,
                     "localiser in __metadata__ is not centred and not euclidean");
}

static vdna_status find_tables(const unsigned char *bytes, const vdna_header *header,
                               vdna_error *reason, vdna_map_trust_file *file)
{
    vdna_field fields[VDNA_TRUST_FIELD_COUNT];
    vdna_map_trust_layout_of(file, fields);
    const vdna_status status =
        vdna_tensors_find(bytes, header, fields, VDNA_TRUST_FIELD_COUNT, reason);
    if (status != VDNA_OK)
        return status;
    for (size_t f = 0; f < VDNA_TRUST_FIELD_COUNT; f++)
        if (!fields[f].data)
            return vdna_fail(reason, VDNA_ERR_FORMAT, "tensor %s is missing", fields[f].name);
    file->tolerance = fields[VDNA_TRUST_FIELD_TOLERANCE].data;
    file->names = fields[VDNA_TRUST_FIELD_MEMBER_NAME].data;
    file->checksums = fields[VDNA_TRUST_FIELD_MEMBER_CRC].data;
    file->tables = (vdna_trust_tables){
        fields[VDNA_TRUST_FIELD_FRAMES].data, fields[VDNA_TRUST_FIELD_OWN_SCALE].data,
        fields[VDNA_TRUST_FIELD_CORRELATION].data, fields[VDNA_TRUST_FIELD_CELLS].data};
    return VDNA_OK;
}

vdna_status vdna_map_trust_read(const unsigned char *bytes, size_t size, vdna_error *reason,
                                vdna_map_trust_file *out_file)
{
    vdna_header header;
    uint32_t checksum; /* nobody asks for that of this file */
    vdna_map_trust_file file = {.members = 0};
    vdna_status status =
        vdna_tensors_read(bytes, size, &vdna_map_trust_format, reason, &header, &checksum);
    if (status == VDNA_OK)
        status = vdna_tensors_text(&header, "comparable", file.comparable, sizeof file.comparable,
                                   reason);
    if (status == VDNA_OK)
        status = read_localiser(&header, reason, &file);
    if (status == VDNA_OK)
        status = read_members(&header, reason, &file);
    if (status == VDNA_OK)
        status = find_tables(bytes, &header, reason, &file);
    if (status != VDNA_OK)
        return status;
    if (vdna_map_trust_check(&file, reason) != VDNA_OK)
        return VDNA_ERR_FORMAT;
    *out_file = file;
    return VDNA_OK;
}

vdna_status vdna_map_trust_path(const char *directory, vdna_error *error,
                                char out_path[VDNA_REPLACE_PATH_SIZE])
{
    const int length =
        snprintf(out_path, VDNA_REPLACE_PATH_SIZE, "%s/" VDNA_MAP_TRUST_FILE, directory);
    if ((size_t)length >= VDNA_REPLACE_PATH_SIZE)
        return vdna_fail(error, VDNA_ERR_IO, "%.100s...: the path is too long", directory);
    return VDNA_OK;
}
