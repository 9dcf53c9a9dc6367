#include <vdna/transport.h>

#include "cursor.h"

/* Bytes on the wire of a numeric element. */
static const size_t number_sizes[] = {
    [VDNA_MESSAGE_BOOLEAN] = sizeof(int8_t), [VDNA_MESSAGE_BYTE] = sizeof(uint8_t),
    [VDNA_MESSAGE_INT32] = sizeof(int32_t),  [VDNA_MESSAGE_INT64] = sizeof(int64_t),
    [VDNA_MESSAGE_DOUBLE] = sizeof(double),
};

static void skip_structs(cursor *c, const vdna_message_type *type, uint32_t length);

static void skip_elements(cursor *c, const vdna_message_member *member, uint32_t length)
{
    switch (member->kind) {
    case VDNA_MESSAGE_STRING:
        cursor_strings(c, length);
        break;
    case VDNA_MESSAGE_STRUCT:
        skip_structs(c, member->type, length);
        break;
    default:
        cursor_take(c, length, number_sizes[member->kind]);
    }
}

/* A struct holds earlier ones only, so the recursion ends. It has at least one byte, so a false
 * length is detected by the end of the message at the latest. */
static void skip_struct(cursor *c, const vdna_message_type *type)
{
    uint32_t counts[VDNA_MESSAGE_MEMBERS_MAX] = {0};
    for (uint32_t i = 0; i < type->member_count && !c->broken; i++) {
        const vdna_message_member *member = &type->members[i];
        if (member->kind == VDNA_MESSAGE_COUNT)
            counts[i] = cursor_count(c);
        else
            skip_elements(c, member,
                          member->length > 0 ? member->length : counts[member->count_member]);
    }
}

static void skip_structs(cursor *c, const vdna_message_type *type, uint32_t length)
{
    for (uint32_t i = 0; i < length && !c->broken; i++)
        skip_struct(c, type);
}

/* see vdna/transport.h */
vdna_status vdna_transport_check(const vdna_message_type *type, const void *data, size_t size)
{
    if (!type)
        return VDNA_ERR_ARG;
    cursor c = cursor_begin(data, size, type->fingerprint);
    skip_struct(&c, type);
    return cursor_complete(&c) ? VDNA_OK : VDNA_ERR_FORMAT;
}
