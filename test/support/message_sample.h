// A message of any type, made from its table, so that a new type is tested without a line here.
#ifndef MESSAGE_SAMPLE_H
#define MESSAGE_SAMPLE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/message.h>

// Elements of an array that a count has, and the text that a string has.
#define SAMPLE_COUNT 3
#define SAMPLE_TEXT "text"

static inline void *sample_memory(size_t size)
{
    void *memory = calloc(1, size);
    if (!memory)
        abort();
    return memory;
}

// Bytes of an element in the C struct.
static inline size_t sample_element_size(const vdna_message_member *member)
{
    switch (member->kind) {
    case VDNA_MESSAGE_BOOLEAN:
    case VDNA_MESSAGE_BYTE:
        return 1;
    case VDNA_MESSAGE_INT32:
    case VDNA_MESSAGE_COUNT:
        return 4;
    case VDNA_MESSAGE_INT64:
    case VDNA_MESSAGE_DOUBLE:
        return 8;
    case VDNA_MESSAGE_STRING:
        return sizeof(char *);
    default:
        return member->type->struct_size;
    }
}

static inline void sample_fill(const vdna_message_type *type, char *message);

static inline void sample_fill_element(const vdna_message_member *member, char *element)
{
    const int32_t count = SAMPLE_COUNT;
    char *text;
    switch (member->kind) {
    case VDNA_MESSAGE_COUNT:
        memcpy(element, &count, sizeof count);
        break;
    case VDNA_MESSAGE_STRING:
        text = (char *)sample_memory(sizeof SAMPLE_TEXT);
        memcpy(text, SAMPLE_TEXT, sizeof SAMPLE_TEXT);
        memcpy(element, &text, sizeof text);
        break;
    case VDNA_MESSAGE_STRUCT:
        sample_fill(member->type, element);
        break;
    default:
        memset(element, 0x31, sample_element_size(member));
    }
}

// Write a message into a struct; vdna_message_type.cleanup() frees what it points to.
static inline void sample_fill(const vdna_message_type *type, char *message)
{
    for (uint32_t i = 0; i < type->member_count; i++) {
        const vdna_message_member *member = &type->members[i];
        const size_t size = sample_element_size(member);
        char *elements = message + member->offset;
        uint32_t length = member->length;
        if (length == 0) {
            length = SAMPLE_COUNT;
            char *const block = (char *)sample_memory(length * size);
            memcpy(elements, &block, sizeof block);
            elements = block;
        }
        for (uint32_t element = 0; element < length; element++)
            sample_fill_element(member, elements + element * size);
    }
}

// A message with all that belongs to it.
static inline void *sample_new(const vdna_message_type *type)
{
    void *message = sample_memory(type->struct_size);
    sample_fill(type, (char *)message);
    return message;
}

static inline void sample_free(const vdna_message_type *type, void *message)
{
    type->cleanup(message);
    free(message);
}

#endif
