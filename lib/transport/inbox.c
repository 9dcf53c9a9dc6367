#include "inbox.h"

#include <errno.h>
#include <fail.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "multicast.h"

/* How long closing may wait for the thread. */
#define LOOK_MS 50

struct vdna_inbox {
    vdna_multicast *receiver; /* the thread's */
    uint32_t queue_length;
    int waiting; /* eventfd: counts the messages that wait, and the end */
    pthread_t thread;
    bool has_thread;

    pthread_mutex_t lock; /* of all that follows */
    bool stop, is_gone;
    vdna_inbox_message *first, **end;
    size_t bytes;
    uint32_t lengths[VDNA_REASSEMBLY_CHANNELS];
};

static void announce(const vdna_inbox *inbox)
{
    const uint64_t one = 1;
    const ssize_t written = write(inbox->waiting, &one, sizeof one);
    (void)written; /* it counts to 2^64 */
}

/* Copy a message to the end of the queue, if there is room. */
static void append(vdna_inbox *inbox, const vdna_arrival *arrival, int64_t received_us)
{
    const size_t size = arrival->kind == VDNA_ARRIVAL_MESSAGE ? arrival->size : 0;
    if (inbox->lengths[arrival->wanted] >= inbox->queue_length ||
        inbox->bytes + size > VDNA_INBOX_BYTES_MAX)
        return;
    vdna_inbox_message *message = malloc(sizeof *message + size);
    if (!message)
        return;
    *message = (vdna_inbox_message){
        .wanted = arrival->wanted,
        .received_us = received_us,
        .total_size = arrival->total_size,
        .size = size,
    };
    if (size > 0)
        memcpy(message->data, arrival->data, size);
    *inbox->end = message;
    inbox->end = &message->next;
    inbox->bytes += size;
    inbox->lengths[arrival->wanted]++;
    announce(inbox);
}

static bool is_stopped(vdna_inbox *inbox)
{
    pthread_mutex_lock(&inbox->lock);
    const bool stopped = inbox->stop || inbox->is_gone;
    pthread_mutex_unlock(&inbox->lock);
    return stopped;
}

static void end_network(vdna_inbox *inbox)
{
    pthread_mutex_lock(&inbox->lock);
    inbox->is_gone = true;
    announce(inbox);
    pthread_mutex_unlock(&inbox->lock);
}

static void *receive(void *context)
{
    vdna_inbox *inbox = context;
    while (!is_stopped(inbox)) {
        vdna_arrival arrival;
        int64_t received_us;
        int got = vdna_multicast_wait(inbox->receiver, LOOK_MS);
        if (got == 1)
            got = vdna_multicast_take(inbox->receiver, &arrival, &received_us);
        if (got < 0)
            end_network(inbox);
        if (got != 1 ||
            (arrival.kind != VDNA_ARRIVAL_MESSAGE && arrival.kind != VDNA_ARRIVAL_TOO_LARGE))
            continue;
        pthread_mutex_lock(&inbox->lock);
        append(inbox, &arrival, received_us);
        pthread_mutex_unlock(&inbox->lock);
    }
    return NULL;
}

/* Signals are for the caller's threads. */
static bool begin_thread(vdna_inbox *inbox)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    inbox->has_thread = pthread_create(&inbox->thread, NULL, receive, inbox) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return inbox->has_thread;
}

/* see inbox.h */
vdna_status vdna_inbox_open(const char *url, const vdna_wanted_channel *channels, uint32_t count,
                            uint32_t queue_length, vdna_error *error, vdna_inbox **out_inbox)
{
    vdna_inbox *inbox = calloc(1, sizeof *inbox);
    if (!inbox)
        return vdna_fail(error, VDNA_ERR_NOMEM, "listener: no memory left");
    inbox->queue_length = queue_length;
    inbox->end = &inbox->first;
    pthread_mutex_init(&inbox->lock, NULL);
    inbox->waiting = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK | EFD_SEMAPHORE);
    vdna_status status =
        vdna_multicast_open(url, NULL, 0, channels, count, error, &inbox->receiver);
    if (status == VDNA_OK && (inbox->waiting < 0 || !begin_thread(inbox)))
        status = vdna_fail(error, VDNA_ERR_NOMEM,
                           "listener: no thread or descriptor left; raise `ulimit -u` or -n");
    if (status != VDNA_OK) {
        vdna_inbox_close(inbox);
        return status;
    }
    *out_inbox = inbox;
    return VDNA_OK;
}

static vdna_inbox_message *remove_first(vdna_inbox *inbox)
{
    vdna_inbox_message *message = inbox->first;
    if (!message)
        return NULL;
    inbox->first = message->next;
    if (!inbox->first)
        inbox->end = &inbox->first;
    inbox->bytes -= message->size;
    inbox->lengths[message->wanted]--;
    return message;
}

/* see inbox.h */
int vdna_inbox_take(vdna_inbox *inbox, int32_t timeout_ms, vdna_inbox_message **out_message)
{
    struct pollfd messages = {.fd = inbox->waiting, .events = POLLIN};
    const int ready = poll(&messages, 1, timeout_ms);
    if (ready < 0)
        return errno == EINTR ? 0 : -1;
    if (ready == 0)
        return 0;
    uint64_t one;
    if (read(inbox->waiting, &one, sizeof one) != sizeof one)
        return 0;
    pthread_mutex_lock(&inbox->lock);
    *out_message = remove_first(inbox);
    if (!*out_message)
        announce(inbox); /* the end, which stays */
    pthread_mutex_unlock(&inbox->lock);
    return *out_message ? 1 : -1;
}

/* see inbox.h */
void vdna_inbox_close(vdna_inbox *inbox)
{
    if (!inbox)
        return;
    pthread_mutex_lock(&inbox->lock);
    inbox->stop = true;
    pthread_mutex_unlock(&inbox->lock);
    if (inbox->has_thread)
        pthread_join(inbox->thread, NULL);
    for (vdna_inbox_message *message; (message = remove_first(inbox));)
        free(message);
    vdna_multicast_close(inbox->receiver);
    if (inbox->waiting >= 0)
        close(inbox->waiting);
    pthread_mutex_destroy(&inbox->lock);
    free(inbox);
}
