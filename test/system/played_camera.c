/* Loaded before libc (LD_PRELOAD): makes /dev/video9 a camera that plays the JPEG files of
 * $VDNA_PLAYED_FOLDER, 0.jpg, 1.jpg, ... in turn, 50 a second. Every fifth frame is lost. After
 * $VDNA_PLAYED_FRAMES frames it is unplugged, and can be opened again. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define BUFFERS 4
#define BUFFER_SIZE (1 << 18)

static int camera = -1;
static unsigned queued[BUFFERS], first, waiting;
static unsigned played, pictures;

static int open_camera(void)
{
    camera = memfd_create("camera", 0);
    if (camera < 0 || ftruncate(camera, BUFFERS * BUFFER_SIZE) != 0)
        abort();
    first = waiting = played = 0;
    return camera;
}

static int open_any(const char *name, const char *path, int flags, mode_t mode)
{
    if (strcmp(path, "/dev/video9") == 0)
        return open_camera();
    int (*next)(const char *, int, ...);
    *(void **)&next = dlsym(RTLD_NEXT, name);
    return next(path, flags, mode);
}

int open(const char *path, int flags, ...)
{
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open_any("open", path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open_any("open64", path, flags, mode);
}

/* The bytes of the next picture, in a buffer. */
static unsigned play_into(unsigned buffer)
{
    static unsigned char bytes[BUFFER_SIZE];
    char path[4096];
    snprintf(path, sizeof path, "%s/%u.jpg", getenv("VDNA_PLAYED_FOLDER"), pictures);
    FILE *file = fopen(path, "rb");
    if (!file) {
        if (pictures == 0)
            abort();
        pictures = 0;
        return play_into(buffer);
    }
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    if (pwrite(camera, bytes, size, (off_t)buffer * BUFFER_SIZE) != (ssize_t)size)
        abort();
    pictures++;
    return (unsigned)size;
}

static int give_frame(struct v4l2_buffer *out)
{
    const char *most = getenv("VDNA_PLAYED_FRAMES");
    if (most && played >= (unsigned)atoi(most))
        return ENODEV;
    const struct timespec period = {0, 20000000};
    nanosleep(&period, NULL);
    if (waiting == 0)
        return EAGAIN;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    out->index = queued[first];
    first = (first + 1) % BUFFERS;
    waiting--;
    out->bytesused = play_into(out->index);
    out->sequence = played + played / 4;
    out->flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    out->timestamp.tv_sec = now.tv_sec;
    out->timestamp.tv_usec = now.tv_nsec / 1000;
    played++;
    return 0;
}

static int queue(const struct v4l2_buffer *buffer)
{
    queued[(first + waiting++) % BUFFERS] = buffer->index;
    return 0;
}

/* Returns 0 or errno. */
static int answer(unsigned long request, void *argument)
{
    struct v4l2_capability *capability = argument;
    struct v4l2_fmtdesc *format = argument;
    struct v4l2_buffer *buffer = argument;
    switch (request) {
    case VIDIOC_QUERYCAP:
        strcpy((char *)capability->card, "Played Camera");
        capability->capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        return 0;
    case VIDIOC_ENUM_FMT:
        format->pixelformat = V4L2_PIX_FMT_MJPEG;
        return format->index == 0 ? 0 : EINVAL;
    case VIDIOC_REQBUFS:
        ((struct v4l2_requestbuffers *)argument)->count = BUFFERS;
        return 0;
    case VIDIOC_QUERYBUF:
        buffer->length = BUFFER_SIZE;
        buffer->m.offset = buffer->index * BUFFER_SIZE;
        return 0;
    case VIDIOC_QBUF:
        return queue(buffer);
    case VIDIOC_DQBUF:
        return give_frame(buffer);
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
    case VIDIOC_STREAMON:
        return 0;
    }
    return ENOTTY;
}

int ioctl(int fd, unsigned long request, ...)
{
    va_list rest;
    va_start(rest, request);
    void *argument = va_arg(rest, void *);
    va_end(rest);
    if (fd == camera && _IOC_TYPE(request) == 'V') {
        errno = answer(request, argument);
        return errno == 0 ? 0 : -1;
    }
    int (*next)(int, unsigned long, ...);
    *(void **)&next = dlsym(RTLD_NEXT, "ioctl");
    return next(fd, request, argument);
}
