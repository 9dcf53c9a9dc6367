/** @file vdna/message.h
 *  @brief The shape of our LCM messages as tables, one for each type of lcmtypes/.
 *
 *  The tables are generated at build time; <vdna_messages.h>, beside the structs that lcm-gen
 *  writes, declares them: `vdna_message_ranking` describes the struct vdna_msg_ranking_t. They are
 *  constant and live as long as the program, so pointers into them never expire.
 */
#ifndef VDNA_MESSAGE_H
#define VDNA_MESSAGE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Most members that a message has. */
#define VDNA_MESSAGE_MEMBERS_MAX 64u

/** Type of one element of a member: on the wire (big-endian, no padding), and in the C struct. */
enum {
    VDNA_MESSAGE_BOOLEAN = 0, /**< 1 byte; int8_t */
    VDNA_MESSAGE_BYTE = 1,    /**< 1 byte; uint8_t */
    VDNA_MESSAGE_INT32 = 2,   /**< 4 bytes; int32_t */
    VDNA_MESSAGE_INT64 = 3,   /**< 8 bytes; int64_t */
    VDNA_MESSAGE_DOUBLE = 4,  /**< 8 bytes; double */
    VDNA_MESSAGE_COUNT = 5,   /**< as INT32, 0 or more: how many elements later members have */
    VDNA_MESSAGE_STRING = 6,  /**< a length as COUNT that includes the one NUL, the text; char * */
    VDNA_MESSAGE_STRUCT = 7   /**< the members of another type; its struct */
};

/** One type of message. */
typedef struct vdna_message_type vdna_message_type;

/** One member of a type. */
typedef struct vdna_message_member {
    const char *name; /**< as in the .lcm file */
    uint32_t kind;    /**< VDNA_MESSAGE_... */
    uint32_t offset;  /**< bytes from the beginning of the C struct */
    uint32_t length;  /**< elements, inside the C struct itself; 1 = no array; 0 = `count_member`
                           gives the number, and the C struct has a pointer to them */
    uint32_t count_member; /**< if length is 0: index of an earlier member, a COUNT; else 0 */
    const vdna_message_type *type; /**< of a STRUCT; else NULL */
} vdna_message_member;

/** The table of one type. Its functions are lcm-gen's and trust their input: check bytes with
 *  vdna_transport_check() before decode(), and let vdna_transport_publish() call encode(). */
struct vdna_message_type {
    const char *name;      /**< package and struct: "vdna_msg.ranking_t" */
    uint64_t fingerprint;  /**< the first 8 bytes on the wire; follows from the members */
    uint32_t struct_size;  /**< bytes of the C struct */
    uint32_t member_count; /**< 1..VDNA_MESSAGE_MEMBERS_MAX */
    const vdna_message_member *members; /**< [member_count], in the order of the .lcm file */

    /** Bytes of a message on the wire, fingerprint included; every pointer in it must be valid. */
    int32_t (*encoded_size)(const void *message);
    /** Write a message. Returns its bytes; negative if they are more than `size`. */
    int32_t (*encode)(const void *message, void *out_data, int32_t size);
    /** Read a message; allocates. Returns its bytes, to be freed by cleanup(), or a negative
     *  number. */
    int32_t (*decode)(const void *data, int32_t size, void *out_message);
    /** Free what decode() allocated; the struct itself is the caller's. */
    void (*cleanup)(void *message);
};

#ifdef __cplusplus
}
#endif

#endif
