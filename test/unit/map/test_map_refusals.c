/* Experience files when the operating system refuses: stand-ins for its calls give the errors that
 * no real file system gives on demand (see CMakeLists.txt). */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "cmocka_all.h"
#include "map_files.h"

/* Results of the next calls of one function: an errno each; 0 = the real call. */
static struct {
    const char *function;
    int errnos[3];
    size_t calls;
} script;

static void let(const char *function, int first, int second, int third)
{
    script.function = function;
    script.errnos[0] = first;
    script.errnos[1] = second;
    script.errnos[2] = third;
    script.calls = 0;
}

/* @return whether this call of a function is to fail; errno is then set */
static int fails(const char *function)
{
    if (!script.function || strcmp(script.function, function) != 0 || script.calls == 3)
        return 0;
    errno = script.errnos[script.calls++];
    return errno != 0;
}

int __real_fstat(int descriptor, struct stat *out);
int __wrap_fstat(int descriptor, struct stat *out);
int __wrap_fstat(int descriptor, struct stat *out)
{
    return fails("fstat") ? -1 : __real_fstat(descriptor, out);
}

void *__real_mmap(void *at, size_t size, int rights, int flags, int descriptor, off_t offset);
void *__wrap_mmap(void *at, size_t size, int rights, int flags, int descriptor, off_t offset);
void *__wrap_mmap(void *at, size_t size, int rights, int flags, int descriptor, off_t offset)
{
    return fails("mmap") ? MAP_FAILED : __real_mmap(at, size, rights, flags, descriptor, offset);
}

static size_t write_at_most; /* bytes in one call; 0 = any number */

ssize_t __real_write(int descriptor, const void *bytes, size_t size);
ssize_t __wrap_write(int descriptor, const void *bytes, size_t size);
ssize_t __wrap_write(int descriptor, const void *bytes, size_t size)
{
    const size_t most = write_at_most > 0 && size > write_at_most ? write_at_most : size;
    return fails("write") ? -1 : __real_write(descriptor, bytes, most);
}

int __real_fsync(int descriptor);
int __wrap_fsync(int descriptor);
int __wrap_fsync(int descriptor)
{
    return fails("fsync") ? -1 : __real_fsync(descriptor);
}

static void assert_name(const char *path, const char *name)
{
    vdna_experience e;
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_string_equal(e.name, name);
    vdna_experience_close(&e);
}

static vdna_status write_named(const char *path, const char *name, vdna_error *error)
{
    vdna_experience e = sample_experience();
    strcpy(e.name, name);
    return vdna_experience_write(&e, path, error);
}

static void a_file_that_cannot_be_examined_or_mapped_is_named(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    vdna_experience e;
    vdna_error error;
    assert_int_equal(write_named(path, "winter", NULL), VDNA_OK);
    let("fstat", EIO, 0, 0);
    assert_int_equal(vdna_experience_open(path, &error, &e), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "a.vdna: cannot examine: Input/output error"));
    let("mmap", ENOMEM, 0, 0);
    assert_int_equal(vdna_experience_open(path, &error, &e), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "a.vdna: cannot map into memory: Cannot allocate memory"));
    assert_name(path, "winter");
}

static void a_copy_for_which_there_is_no_memory_is_named(void **state)
{
    const directory *made = *state;
    vdna_experience e;
    vdna_error error;
    uint32_t count = 77;
    vdna_map_config config;
    vdna_map_config_init(&config);
    config.copy = 1;
    assert_int_equal(write_named(path_in(made, "a.vdna"), "winter", NULL), VDNA_OK);
    let("mmap", ENOMEM, 0, 0);
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, &e, &count), VDNA_ERR_NOMEM);
    assert_non_null(strstr(error.text, "a.vdna: no memory for a copy of its "));
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, &e, &count), VDNA_OK);
    vdna_experience_close(&e);
}

static void a_signal_during_a_write_does_no_harm(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    let("write", EINTR, 0, EINTR);
    assert_int_equal(write_named(path, "winter", NULL), VDNA_OK);
    assert_name(path, "winter");
    let("fsync", EINTR, EINTR, 0);
    assert_int_equal(write_named(path, "summer", NULL), VDNA_OK);
    assert_name(path, "summer");
    let("fsync", 0, EINTR, 0);
    assert_int_equal(write_named(path, "spring", NULL), VDNA_OK);
    assert_name(path, "spring");
    assert_int_equal(script.calls, 3);
}

static void a_disk_that_takes_few_bytes_at_a_time_gets_them_all(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    for (write_at_most = 1; write_at_most < 20; write_at_most += 6) {
        assert_int_equal(write_named(path, "winter", NULL), VDNA_OK);
        assert_name(path, "winter");
        /* A disk that is then full. */
        let("write", 0, 0, ENOSPC);
        assert_int_equal(write_named(path, "summer", NULL), VDNA_ERR_IO);
        assert_name(path, "winter");
    }
    write_at_most = 0;
}

static void a_file_that_does_not_reach_the_disk_leaves_the_old_one(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    vdna_error error;
    assert_int_equal(write_named(path, "winter", NULL), VDNA_OK);
    let("fsync", EIO, 0, 0);
    assert_int_equal(write_named(path, "summer", &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "a.vdna: cannot fsync: Input/output error; the file was"));
    assert_name(path, "winter");
    assert_int_not_equal(access(path_in(*state, "a.vdna.0.partial"), F_OK), 0);
}

static void a_directory_that_does_not_reach_the_disk_is_named(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    vdna_error error;
    let("fsync", 0, EIO, 0);
    assert_int_equal(write_named(path, "winter", &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "a.vdna: written, but cannot fsync its directory"));
    assert_name(path, "winter");
}

static void a_directory_that_does_not_support_sync_is_accepted(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    let("fsync", 0, EINVAL, 0);
    assert_int_equal(write_named(path, "winter", NULL), VDNA_OK);
    assert_int_equal(script.calls, 2);
    assert_name(path, "winter");
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(a_file_that_cannot_be_examined_or_mapped_is_named),
        CASE(a_copy_for_which_there_is_no_memory_is_named),
        CASE(a_signal_during_a_write_does_no_harm),
        CASE(a_disk_that_takes_few_bytes_at_a_time_gets_them_all),
        CASE(a_file_that_does_not_reach_the_disk_leaves_the_old_one),
        CASE(a_directory_that_does_not_reach_the_disk_is_named),
        CASE(a_directory_that_does_not_support_sync_is_accepted),
    };
    return cmocka_run_group_tests_name("map_refusals", tests, NULL, NULL);
}
