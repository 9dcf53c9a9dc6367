/** @file vdna/listener.h
 *  @brief A listener for our LCM messages: every message on the named channels, checked and
 *         decoded. For programs that show, record or judge messages.
 *
 *  vdna/transport.h is the daemon's side, which keeps only the newest camera frame. A listener
 *  skips nothing as long as its queue is long enough. From udpm:// networks it receives by our own
 *  means, as the daemon does: with a ttl of 0 from this machine only.
 */
#ifndef VDNA_LISTENER_H
#define VDNA_LISTENER_H

#include <stddef.h>
#include <stdint.h>

#include <vdna/message.h>
#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A connection to an LCM network that only listens. One thread at a time. */
typedef struct vdna_listener vdna_listener;

/** Bytes of the largest message that is kept over udpm:// ; larger ones are rejected. */
#define VDNA_LISTENER_MESSAGE_BYTES_MAX (1u << 25)

/** A channel to listen to. */
typedef struct vdna_listener_channel {
    const char *name;              /**< 1..63 bytes, taken literally */
    const vdna_message_type *type; /**< of all messages on it; others are rejected */
} vdna_listener_channel;

/** How to listen. Fill with vdna_listener_config_init(), then set the channels. */
typedef struct vdna_listener_config {
    uint32_t struct_size;  /**< bytes of this struct, set by vdna_listener_config_init() */
    uint32_t queue_length; /**< messages that wait for each channel, 1..65536; a full queue
                                drops the newest; default VDNA_LISTENER_QUEUE. Over udpm:// a
                                thread of ours keeps them, up to 64 MiB of all channels */
    const char *url; /**< LCM URL; NULL or "" = $LCM_DEFAULT_URL, else LCM's default (default) */
    const vdna_listener_channel *channels; /**< [channel_count], copied; default NULL. A name may
                                                appear with several types */
    uint32_t channel_count;                /**< 0..256; default 0 */
    uint32_t reserved;                     /**< 0 */
} vdna_listener_config;

/** One message that came. Everything is borrowed until the next vdna_listener_poll() or
 *  vdna_listener_close(). */
typedef struct vdna_listener_message {
    const vdna_message_type *type; /**< of its channel; NULL = none came */
    const char *channel;           /**< its name */
    const void *data;     /**< the struct that lcm-gen declares for `type`; NULL = rejected */
    const char *rejected; /**< why there is no data, without a trailing period; NULL if there is
                               data */
    size_t size;          /**< bytes on the wire */
    int64_t received_us;  /**< CLOCK_MONOTONIC when its last datagram came; for logs, when it
                               was read */
} vdna_listener_message;

/** Write the defaults: LCM's own URL, VDNA_LISTENER_QUEUE, no channel.
 *  @param config  NULL is allowed */
VDNA_API void vdna_listener_config_init(vdna_listener_config *config);

/** Connect and subscribe. Nothing is taken before vdna_listener_poll().
 *  @param config  copied
 *  @param error  filled on failure; NULL = not wanted
 *  @param out_listener  the caller's, to be closed with vdna_listener_close()
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO if the network refuses; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_listener_open(const vdna_listener_config *config, vdna_error *error,
                                        vdna_listener **out_listener);

/** Take the next message; wait if there is none.
 *  @param listener    an open one
 *  @param timeout_ms  0 = do not wait, at most VDNA_TIMEOUT_MS_MAX
 *  @param out_message filled; its type is NULL if nothing came in time or a signal interrupted
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_IO if the connection is gone (for file:// URLs: the log
 *          has ended); VDNA_ERR_FORMAT if a log has ended of which damaged parts were passed over
 */
VDNA_API vdna_status vdna_listener_poll(vdna_listener *listener, int32_t timeout_ms,
                                        vdna_listener_message *out_message);

/** Disconnect.
 *  @param listener  NULL is allowed */
VDNA_API void vdna_listener_close(vdna_listener *listener);

#ifdef __cplusplus
}
#endif

#endif
