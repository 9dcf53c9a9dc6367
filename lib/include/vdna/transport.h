/** @file vdna/transport.h
 *  @brief LCM in and out: the newest camera frame and commands in; any message of ours out. No
 *         policy.
 *
 *  Messages, channels and units: docs/reference/SPEC-lcm.md. Inbound bytes are checked in place
 *  before they are used. From udpm:// networks a transport receives by its own means, in fixed
 * memory and only from senders that may send; LCM sends, and serves all other networks. LCM itself
 * prints its complaints to standard error; errors here say what to do about them.
 */
#ifndef VDNA_TRANSPORT_H
#define VDNA_TRANSPORT_H

#include <vdna/image.h>
#include <vdna/message.h>
#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** LCM's own default network, which does not leave this machine. */
#define VDNA_LCM_URL "udpm://239.255.76.67:7667?ttl=0"

/** What to do if LCM cannot use a udpm:// network: the clause that ends every message about it. */
#define VDNA_LCM_REMEDY \
    "if this machine has no network, it lacks a route: `ip route add 224.0.0.0/4 dev lo`"

#define VDNA_CHANNEL_CAMERA "CAMERA"        /**< default channel of bot_core.image_t */
#define VDNA_CHANNEL_COMMAND "VDNA_COMMAND" /**< of vdna_msg.command_t */
#define VDNA_CHANNEL_COMMAND_RESULT "VDNA_COMMAND_RESULT" /**< of vdna_msg.command_result_t */
#define VDNA_CHANNEL_RANKING "VDNA_RANKING"               /**< of vdna_msg.ranking_t */
#define VDNA_CHANNEL_LOCALISATION "VDNA_LOCALISATION"     /**< of vdna_msg.localisation_t */
#define VDNA_CHANNEL_STATUS "VDNA_STATUS"                 /**< of vdna_msg.status_t */

/** Most bytes of a channel name; LCM's limit. */
#define VDNA_CHANNEL_BYTES_MAX 63
/** Most bytes of a message; LCM's limit. */
#define VDNA_MESSAGE_BYTES_MAX (1u << 28)

/** Messages of a channel that LCM queues for a transport, except over udpm:// ; beyond that it
 * drops the newest. */
#define VDNA_TRANSPORT_QUEUE 30u
/** The same for a listener, by default: enough for a slow terminal to lose none. */
#define VDNA_LISTENER_QUEUE 1000u

/** Most channels that a transport remembers overhearing. */
#define VDNA_TRANSPORT_OVERHEARD_MAX 16u

/** Most machines that can be allowed to send. */
#define VDNA_TRANSPORT_SOURCES_MAX 16u

/** Most daemons on the peer channel that a transport remembers. */
#define VDNA_TRANSPORT_PEERS_MAX 8u
/** Bytes of the name of a peer's machine that are kept, with the NUL. */
#define VDNA_TRANSPORT_HOST_SIZE 64u

/** Most commands that one poll hands out. */
#define VDNA_TRANSPORT_COMMANDS_MAX 16u
/** Bytes of a command's argument that are kept, with the NUL: those of a name. */
#define VDNA_TRANSPORT_ARGUMENT_SIZE 64u

/** Longest time that a poll may wait, in milliseconds. */
#define VDNA_TIMEOUT_MS_MAX 1000

/** A connection to an LCM network. One thread at a time. */
typedef struct vdna_transport vdna_transport;

/** How to connect. Fill with vdna_transport_config_init(). A channel that is NULL is not subscribed
 *  to; another has 1..63 bytes. Strings are copied. */
typedef struct vdna_transport_config {
    uint32_t struct_size;     /**< bytes of this struct, set by vdna_transport_config_init() */
    uint32_t max_image_bytes; /**< largest camera picture kept, 1..2^28; default 8 MiB; allocated at
                                   once if there is a camera channel */
    uint32_t max_message_bytes;  /**< room for a message to publish, allocated at once, 0..2^28; a
                                      larger one makes it grow; default 0 */
    uint32_t require_protection; /**< 1 = refuse camera frames without end-to-end protection; 0 =
                                      use and count them (default) */
    const char *url; /**< LCM URL; NULL = $LCM_DEFAULT_URL, else LCM's default (default) */
    const char *camera_channel;  /**< bot_core.image_t in; default NULL */
    const char *command_channel; /**< vdna_msg.command_t in; default NULL */
    const char *const *sources;  /**< [source_count], over udpm:// : IPv4 addresses such as
                                    "10.0.0.2"  of machines that may send, besides this one */
    uint64_t source_count; /**< 0..VDNA_TRANSPORT_SOURCES_MAX; 0 = only this machine may send if the
                                URL's ttl is 0, every machine otherwise (default); 64 bits wide to
                                leave no padding */
    const char *peer_channel; /**< vdna_msg.status_t of other daemons in; default NULL */
} vdna_transport_config;

/** The newest camera frame. `image.data` is borrowed until the next vdna_transport_poll(). */
typedef struct vdna_transport_frame {
    vdna_image image;    /**< as the message describes it; not checked */
    int64_t utime;       /**< the camera's stamp in microseconds */
    int64_t received_us; /**< CLOCK_MONOTONIC when its last datagram came; for logs, when it was
                              read */
    uint64_t skipped; /**< frames that were skipped or oversized since the one handed out before */
} vdna_transport_frame;

/** Counters since the transport was opened. */
typedef struct vdna_transport_counters {
    uint64_t received;  /**< well-formed camera messages: handed out, skipped or oversized */
    uint64_t skipped;   /**< of those, replaced by a newer one before they were asked for, or
                             older than one that was lost in a full buffer */
    uint64_t oversized; /**< of those, with a picture larger than max_image_bytes, or metadata
                             of more than 4 kB beside it; of the largest ones only the
                             beginning is checked */
    uint64_t rejected;  /**< messages on our channels that break their format */
    uint64_t commands;  /**< well-formed command messages */
    uint64_t picture_bytes_max;  /**< largest picture in a well-formed camera message */
    uint32_t backlog_max;        /**< most messages found waiting by one poll */
    uint32_t reserved;           /**< 0 */
    uint64_t camera_rejected;    /**< of `rejected`, those on the camera channel */
    uint64_t camera_fingerprint; /**< of the newest of these, its first 8 bytes; 0 if it has less */
    uint64_t oversized_bytes;    /**< size of the newest oversized picture; 0 = none */
    uint64_t damaged_bytes;      /**< of a log: bytes passed over because they are no events; zeros
                                      or half an event at its end do not count */
    /* Over udpm:// only. */
    uint64_t lost; /**< messages that senders on the camera channel numbered and that never came
                        whole, as far as a later one tells; what such a sender sends on other
                        channels counts, too */
    uint64_t incomplete; /**< messages given up because some of their fragments did not come within
                            a second, or newer ones needed their place; on the camera channel,
                            `lost` has them */
    uint64_t dropped_datagrams; /**< that the system dropped: its buffer was full, or their checksum
                                     false */
    uint64_t malformed_datagrams; /**< that are not LCM's, or contradict others of their message */
    uint64_t repeated_datagrams;  /**< that bring nothing new: duplicates, and fragments of messages
                                     that  were given up, are oversized or on other channels */
    uint64_t foreign_datagrams;   /**< from machines that may not send */
    /* By the end-to-end protection of camera frames; over any network, and of logs. */
    uint64_t unprotected_frames; /**< well-formed camera messages that came whole and are without
                                      it; with require_protection they are in `rejected` */
    uint64_t corrupted_frames;   /**< of `rejected`, well-formed camera messages whose checksum is
                                      false or whose protection is not as SPEC-lcm has it */
    uint64_t repeated_frames; /**< that came before, or are 64 or more numbers older than the newest
                                   of their stream; not handed out and not in `received` */
    uint64_t reordered_frames; /**< that a newer one of their stream overtook; likewise not handed
                                    out and not in `received` */
    uint64_t lost_frames;  /**< numbers that a stream left out between those that came intact: lost,
                                corrupted, or oversized and never whole */
    uint64_t stream_count; /**< streams that began: one for each start of a sender, and again for
                                one that goes on after a RESET or is not among the last four */
    uint64_t other_sender_frames; /**< over udpm:// : well-formed camera frames of another program
                                       than the first, which was heard within a second before */
    uint64_t commands_dropped;    /**< of `commands`, not handed out: there were more than
                                       VDNA_TRANSPORT_COMMANDS_MAX in one poll */
} vdna_transport_counters;

/** A sender of protected camera frames, from one start to its end. The caller keeps it. */
typedef struct vdna_transport_stream {
    uint64_t id;       /**< drawn at random at each start */
    uint64_t sequence; /**< of the next frame; 0 at the start */
} vdna_transport_stream;

/** A command, of whatever number; not checked. */
typedef struct vdna_transport_command {
    int64_t utime;                               /**< as it says, microseconds since 1970 */
    int32_t command;                             /**< VDNA_MSG_COMMAND_T_..., or any other number */
    uint32_t argument_bytes;                     /**< as sent, without the NUL */
    char argument[VDNA_TRANSPORT_ARGUMENT_SIZE]; /**< cut if it is longer */
} vdna_transport_command;

/** A channel other than the transport's own, as it was overheard. */
typedef struct vdna_transport_overheard {
    char channel[VDNA_CHANNEL_BYTES_MAX + 1]; /**< its name: any bytes that somebody sent */
    uint64_t fingerprint; /**< first 8 bytes of its newest message; 0 if that has less */
    uint64_t messages;    /**< since overhearing began, >= 1; a full queue drops some */
    int64_t first_us;     /**< when the first of them came, as in vdna_transport_frame */
    int64_t last_us;      /**< when the newest came */
} vdna_transport_overheard;

/** A daemon, ourselves included, by its newest status on the peer channel. */
typedef struct vdna_transport_peer {
    int64_t instance;                    /**< as it drew it */
    int64_t serving_utime;               /**< microseconds since 1970; 0 = it stands by */
    int64_t received_us;                 /**< when that status came, as in vdna_transport_frame */
    char host[VDNA_TRANSPORT_HOST_SIZE]; /**< name of its machine, with '?' for control characters
                                              and cut if it is long */
} vdna_transport_peer;

/** Most memory that a transport holds, in bytes. */
typedef struct vdna_transport_memory {
    uint64_t own_bytes; /**< itself, the newest picture and the message to publish */
    uint64_t lcm_bytes; /**< over udpm:// : messages half received or waiting, and LCM's sending
                           half; whatever others send. Other networks are LCM's alone, and it takes
                           what they send */
} vdna_transport_memory;

/** Results of vdna_transport_poll(); bits. */
enum {
    VDNA_TRANSPORT_FRAME = 1,  /**< a camera frame */
    VDNA_TRANSPORT_COMMAND = 2 /**< at least one command: vdna_transport_commands() */
};

/** Write the defaults: LCM's own URL, 8 MiB, no channel.
 *
 *  In C and C++ a macro of this name calls vdna_transport_config_init_sized(). The function itself
 * is for programs and languages that know only the struct of version 0.1, which ended with
 *  `command_channel`.
 *  @param config  NULL is allowed */
VDNA_API void vdna_transport_config_init(vdna_transport_config *config);

/** Write the defaults of the fields that the caller's struct has.
 *  @param config       NULL is allowed
 *  @param struct_size  bytes of the struct that the caller was compiled with */
VDNA_API void vdna_transport_config_init_sized(vdna_transport_config *config, size_t struct_size);

/** Write the defaults of all fields that this header has.
 *  @param config  NULL is allowed */
#define vdna_transport_config_init(config) \
    vdna_transport_config_init_sized((config), sizeof(vdna_transport_config))

/** Get the most memory that a transport of this configuration holds.
 *  @param config      as for vdna_transport_open()
 *  @param out_memory  filled
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config */
VDNA_API vdna_status vdna_transport_memory_of(const vdna_transport_config *config,
                                              vdna_transport_memory *out_memory);

/** Connect and subscribe. Channel names are taken literally, not as regular expressions.
 *  @param config  copied
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_transport  the caller's, to be closed with vdna_transport_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO if the network refuses; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_transport_open(const vdna_transport_config *config, vdna_error *error,
                                         vdna_transport **out_transport);

/** Disconnect.
 *  @param transport  NULL is allowed */
VDNA_API void vdna_transport_close(vdna_transport *transport);

/** Wait for messages, then take all of them and keep the newest frame. If several senders share the
 *  camera channel, the newest frame of the first and that of the others are handed out by turns. A
 * log (file:// URL) is read message by message instead: no frame of it is skipped, and a replay
 * gives the same answers at any speed.
 *  @param transport   an open one
 *  @param timeout_ms  0 = do not wait, at most VDNA_TIMEOUT_MS_MAX
 *  @param out_events  VDNA_TRANSPORT_ bits; 0 if nothing came in time, a signal interrupted, or the
 *                     messages were malformed
 *  @param out_frame   set if the FRAME bit is
 *  @return VDNA_OK; VDNA_ERR_IO if the connection is gone (for file:// URLs: the log has ended);
 *          VDNA_ERR_FORMAT if a log has ended of which damaged parts were passed over */
VDNA_API vdna_status vdna_transport_poll(vdna_transport *transport, int32_t timeout_ms,
                                         uint32_t *out_events, vdna_transport_frame *out_frame);

/** Get the commands that the newest poll took, oldest first.
 *  @param transport  an open one, or NULL
 *  @param out_count  their number, at most VDNA_TRANSPORT_COMMANDS_MAX; untouched for NULL
 *  @return [*out_count], valid until the next poll; NULL for NULL */
VDNA_API const vdna_transport_command *vdna_transport_commands(const vdna_transport *transport,
                                                               uint32_t *out_count);

/** Begin or end overhearing: noting which other channels of the network carry messages, and of
 *  which type, in a table of fixed size. When it is full, a channel of camera pictures takes the
 *  place of another; nothing else is kept.
 *  @param transport  an open one
 *  @param on         1 = begin, with an empty table unless it has begun already; 0 = end, after
 *                    which the table stays
 *  @return VDNA_OK; VDNA_ERR_ARG, also if the transport has neither channel; VDNA_ERR_IO if the
 *          network refuses */
VDNA_API vdna_status vdna_transport_overhear(vdna_transport *transport, uint32_t on);

/** Get the channels overheard so far.
 *  @param transport  an open one, or NULL
 *  @param out_count  their number, at most VDNA_TRANSPORT_OVERHEARD_MAX; untouched for NULL
 *  @return [*out_count], valid until the next call with this transport; NULL for NULL */
VDNA_API const vdna_transport_overheard *
vdna_transport_overheard_channels(const vdna_transport *transport, uint32_t *out_count);

/** Get the daemons heard on the peer channel so far. When there is no room for another one, it
 * takes the place of the one that was silent for longest.
 *  @param transport  an open one, or NULL
 *  @param out_count  their number, at most VDNA_TRANSPORT_PEERS_MAX; untouched for NULL
 *  @return [*out_count], valid until the next call with this transport; NULL for NULL */
VDNA_API const vdna_transport_peer *vdna_transport_peers(const vdna_transport *transport,
                                                         uint32_t *out_count);

/** Say whether a URL names a log to be read: such a network has an end, and nothing can be
 *  published on it.
 *  @param url  as in vdna_transport_config
 *  @return 1 if so, else 0 */
VDNA_API int32_t vdna_transport_is_log(const char *url);

/** Get the counters so far.
 *  @param transport  an open one, or NULL
 *  @return valid as long as the transport is open; NULL for NULL */
VDNA_API const vdna_transport_counters *vdna_transport_count(const vdna_transport *transport);

/** Say whether LCM allows a channel name: 1..VDNA_CHANNEL_BYTES_MAX bytes.
 *  @param name   NULL is not allowed
 *  @param error  filled on failure; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_transport_check_channel(const char *name, vdna_error *error);

/** Publish a message. Nothing of it is kept. No string or array may be missing; "" and a count of 0
 * are allowed.
 *  @param transport  an open one
 *  @param channel    1..VDNA_CHANNEL_BYTES_MAX bytes
 *  @param type       one of <vdna_messages.h>, such as &vdna_message_ranking
 *  @param message    the struct that lcm-gen declares for it, such as a vdna_msg_ranking_t; needed
 *                    for this call only
 *  @return VDNA_OK; VDNA_ERR_ARG, also if a count is negative or a string or an array is missing;
 *          VDNA_ERR_IO, always so for a log that is being read; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_transport_publish(vdna_transport *transport, const char *channel,
                                            const vdna_message_type *type, const void *message);

/** Publish a camera frame, as a driver would.
 *  @param transport  an open one
 *  @param channel    as for vdna_transport_publish()
 *  @param utime      the camera's stamp in microseconds
 *  @param image      VDNA_PIXEL_ENCODED is not allowed: a JPEG is VDNA_PIXEL_MJPG
 *  @return as vdna_transport_publish() */
VDNA_API vdna_status vdna_transport_publish_image(vdna_transport *transport, const char *channel,
                                                  int64_t utime, const vdna_image *image);

/** Publish a camera frame with end-to-end protection: its number and a checksum, in metadata that
 *  other listeners ignore. SPEC-lcm has the bytes.
 *  @param transport  an open one
 *  @param channel    as for vdna_transport_publish()
 *  @param utime      as for vdna_transport_publish_image()
 *  @param image      as for vdna_transport_publish_image()
 *  @param stream     its sequence grows by 1, also if sending fails, but not after VDNA_ERR_ARG
 *  @return as vdna_transport_publish() */
VDNA_API vdna_status vdna_transport_publish_protected_image(vdna_transport *transport,
                                                            const char *channel, int64_t utime,
                                                            const vdna_image *image,
                                                            vdna_transport_stream *stream);

/** Check the bytes of a message before a generated decoder sees them: lengths, ends, fingerprint.
 *  lcm-gen's decoders trust every length they read; a message that passes is read to its last byte.
 *  The reader judges whether the values make sense.
 *  @param type  one of <vdna_messages.h>
 *  @param data  [size], a whole message
 *  @param size  bytes
 *  @return VDNA_OK; VDNA_ERR_FORMAT; VDNA_ERR_ARG if `type` is NULL */
VDNA_API vdna_status vdna_transport_check(const vdna_message_type *type, const void *data,
                                          size_t size);

/** Read a camera message in place. Sides must not be negative, there must be a pixel format, and a
 *  protected message must be intact; the picture's decoder checks that it has enough bytes.
 *  @param data  [size], a whole message; borrowed by `out_frame`
 *  @param size  bytes
 *  @param out_frame  image.data points into `data`; received_us and skipped are 0
 *  @return VDNA_OK; VDNA_ERR_FORMAT */
VDNA_API vdna_status vdna_transport_parse_image(const void *data, size_t size,
                                                vdna_transport_frame *out_frame);

#ifdef __cplusplus
}
#endif

#endif
