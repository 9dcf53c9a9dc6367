/* The stub's network, which does what its picture says: "crash", "hang", ... Any other picture is
 * run as the stub does. $VDNA_UNRULY_OPEN says what opening does: "crash", "other" (another
 * network), "device" (no picture can be run). */
#define vdna_backbone_plugin stub_operations
#include "stub_backbone.c"
#undef vdna_backbone_plugin

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* What a process of a network may not do, and what it may: negative, with errno, if it cannot. */

static long open_a_socket(void)
{
    return socket(AF_INET, SOCK_DGRAM, 0);
}

static long open_to_write(void)
{
    return open("/dev/null", O_WRONLY);
}

static long open_a_new_file(void)
{
    return open("unruly", O_RDWR | O_CREAT, 0600);
}

static long empty_a_file(void)
{
    return open("/proc/self/comm", O_RDONLY | O_TRUNC);
}

static long remove_a_file(void)
{
    return unlink("unruly");
}

static long start_a_program(void)
{
    char *const nothing[] = {NULL};
    return execve("/bin/true", nothing, nothing);
}

static long fork_itself(void)
{
    const pid_t child = fork();
    if (child == 0)
        _exit(0);
    return child;
}

static long signal_its_parent(void)
{
    return kill(getppid(), 0); /* is it permitted? */
}

static long watch_its_parent(void)
{
    return ptrace(PTRACE_ATTACH, getppid(), NULL, NULL);
}

static long outlive_its_parent(void)
{
    return syscall(SYS_prctl, 1 /* PR_SET_PDEATHSIG */, 0, 0, 0, 0);
}

static long set_up_io_uring(void)
{
    return syscall(425, 1, NULL);
}

static long read_a_file(void)
{
    const int file = open("/proc/self/comm", O_RDONLY);
    char byte;
    const long got = file < 0 ? -1 : read(file, &byte, 1);
    close(file);
    return got;
}

static void *in_a_thread(void *given)
{
    return given;
}

static long start_a_thread(void)
{
    pthread_t thread;
    if (pthread_create(&thread, NULL, in_a_thread, NULL) != 0)
        return -1;
    return pthread_join(thread, NULL);
}

static void *count_up(void *number)
{
    ++*(int *)number;
    return NULL;
}

/* The control of the tests under ThreadSanitizer. */
static long race_a_thread(void)
{
    int number = 0;
    pthread_t thread;
    if (pthread_create(&thread, NULL, count_up, &number) != 0)
        return -1;
    count_up(&number);
    return pthread_join(thread, NULL);
}

/* More than the machine has; touched, so that overcommitment does not help. */
static long take_all_memory(void)
{
    const size_t size = (size_t)32 << 30, step = (size_t)1 << 20;
    char *block = malloc(size);
    if (!block)
        return -1;
    for (size_t at = 0; at < size; at += step)
        block[at] = 1;
    free(block);
    return 0;
}

static const struct deed {
    const char *name;
    long (*act)(void);
} deeds[] = {
    {"socket", open_a_socket},       {"write", open_to_write},      {"create", open_a_new_file},
    {"truncate", empty_a_file},      {"unlink", remove_a_file},     {"exec", start_a_program},
    {"fork", fork_itself},           {"kill", signal_its_parent},   {"ptrace", watch_its_parent},
    {"outlive", outlive_its_parent}, {"io_uring", set_up_io_uring}, {"memory", take_all_memory},
    {"read", read_a_file},           {"thread", start_a_thread},    {"race", race_a_thread},
};

/* A deed that fails is a failure that tells errno; one that succeeds is none. */
static vdna_status try_deed(const struct deed *deed, vdna_error *error)
{
    errno = 0;
    if (deed->act() >= 0)
        return VDNA_OK;
    snprintf(error->text, sizeof error->text, "%s: %s", deed->name, strerror(errno));
    return VDNA_ERR_RUNTIME;
}

static bool opening_is(const char *what)
{
    const char *const said = getenv("VDNA_UNRULY_OPEN");
    return said && strcmp(said, what) == 0;
}

static vdna_status unruly_run(void *state, const vdna_image *image, vdna_error *error,
                              vdna_backbone_frame *out_frame)
{
    char command[32] = "";
    memcpy(command, image->data, image->size < sizeof command ? image->size : sizeof command - 1);
    if (opening_is("device"))
        return VDNA_ERR_IO;
    if (strcmp(command, "crash") == 0)
        raise(SIGSEGV);
    if (strcmp(command, "exit") == 0)
        _exit(3);
    if (strcmp(command, "mute") == 0) /* ends the pipe by which it replies, and lives on */
        close(5);
    if (strcmp(command, "hang") == 0 || strcmp(command, "mute") == 0)
        for (;;)
            pause();
    for (size_t i = 0; i < sizeof deeds / sizeof *deeds; i++)
        if (strcmp(command, deeds[i].name) == 0) {
            const vdna_status status = try_deed(&deeds[i], error);
            if (status != VDNA_OK)
                return status;
        }

    stub *opened = state;
    opened->embedding[1] = strcmp(command, "nan") == 0 ? NAN : 0;
    const vdna_status status = stub_run(state, image, error, out_frame);
    if (strcmp(command, "shape") == 0)
        out_frame->dim = 4;
    return status;
}

static vdna_status unruly_open(const vdna_backbone_config *config, vdna_error *error,
                               void **out_state)
{
    if (opening_is("crash"))
        raise(SIGSEGV);
    return stub_open(config, error, out_state);
}

static void unruly_describe(const void *state, vdna_backbone_info *out_info)
{
    stub_describe(state, out_info);
    if (opening_is("other"))
        out_info->identity.model_sha256[0] ^= 1;
}

VDNA_API const vdna_backbone_operations *vdna_backbone_plugin(void);
const vdna_backbone_operations *vdna_backbone_plugin(void)
{
    static vdna_backbone_operations table;
    table = *stub_operations();
    table.open = unruly_open;
    table.describe = unruly_describe;
    table.run = unruly_run;
    return &table;
}
