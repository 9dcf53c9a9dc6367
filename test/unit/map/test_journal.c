/* The journal of an update: its bytes, and what happens where it cannot be read or written. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <inttypes.h>
#include <sys/stat.h>

#include "cmocka_all.h"
#include "crc32c.h"
#include "journal.h"
#include "map_files.h"
#include "watched_calls.h"

static vdna_journal journal_of(const char *const *names, size_t count)
{
    vdna_journal journal = {NULL, 0};
    for (size_t i = 0; i < count; i++)
        assert_true(vdna_journal_add(&journal, names[i]));
    return journal;
}

static char text[VDNA_JOURNAL_SIZE + 64];

/* Put the right checksum behind a text. @return the bytes of both */
static size_t with_checksum(const char *lines, size_t size)
{
    memcpy(text, lines, size);
    return size +
           (size_t)snprintf(text + size, 17, "crc32c %08" PRIx32 "\n", vdna_crc32c(0, lines, size));
}

static void a_journal_has_the_bytes_of_the_specification(void **state)
{
    static const char *const names[] = {"winter", "night", "summer"};
    static const char expected[] = "vdna-commit 1\nnight\nsummer\nwinter\ncrc32c 865656cb\n";
    (void)state;
    vdna_journal journal = journal_of(names, 3), read;
    assert_null(vdna_journal_sort(&journal));
    assert_int_equal(vdna_journal_print(&journal, text), sizeof expected - 1);
    assert_memory_equal(text, expected, sizeof expected - 1);
    assert_int_equal(vdna_journal_parse(expected, sizeof expected - 1, "m", NULL, &read), VDNA_OK);
    assert_int_equal(read.count, 3);
    assert_string_equal(read.names[0], "night");
    assert_string_equal(read.names[2], "winter");
    vdna_journal_free(&read);
    assert_true(vdna_journal_add(&journal, "summer"));
    assert_string_equal(vdna_journal_sort(&journal), "summer");
    vdna_journal_free(&journal);
}

static void the_longest_journal_is_read(void **state)
{
    (void)state;
    vdna_journal journal = {NULL, 0}, read;
    for (unsigned i = 0; i < VDNA_JOURNAL_NAMES_MAX; i++) {
        char name[VDNA_NAME_SIZE];
        snprintf(name, sizeof name, "%063u", i);
        assert_true(vdna_journal_add(&journal, name));
    }
    const size_t size = vdna_journal_print(&journal, text);
    assert_int_equal(size, VDNA_JOURNAL_SIZE);
    assert_int_equal(vdna_journal_parse(text, size, "m", NULL, &read), VDNA_OK);
    assert_int_equal(read.count, VDNA_JOURNAL_NAMES_MAX);
    vdna_journal_free(&read);
    vdna_journal_free(&journal);
    memset(text, '\n', sizeof text);
    assert_int_equal(vdna_journal_parse(text, size + 1, "m", NULL, &read), VDNA_ERR_FORMAT);
}

static void assert_damaged(const char *bytes, size_t size)
{
    vdna_error error = {""};
    vdna_journal journal = {NULL, 77};
    assert_int_equal(vdna_journal_parse(bytes, size, "m", &error, &journal), VDNA_ERR_FORMAT);
    assert_non_null(strstr(error.text, "m/.commit: is damaged, expected"));
    assert_int_equal(journal.count, 77);
}

static void any_changed_or_missing_byte_is_damage(void **state)
{
    (void)state;
    const size_t size = with_checksum("vdna-commit 1\nnight\nwinter\n", 27);
    for (size_t i = 0; i < size; i++) {
        assert_damaged(text, i);
        text[i] ^= 1;
        assert_damaged(text, size);
        text[i] ^= 1;
    }
    text[size] = '\n';
    assert_damaged(text, size + 1);
}

static void lines_that_are_no_visible_names_in_order_are_damage(void **state)
{
    static const struct {
        const char *lines;
        size_t size;
    } cases[] = {
        {"vdna-commit 1\n", 14},
        {"vdna-commit 2\nwinter\n", 21},
        {"vdna-commit 1\nwinter", 20},
        {"vdna-commit 1\n\n", 15},
        {"vdna-commit 1\n.winter\n", 22},
        {"vdna-commit 1\n../winter\n", 24},
        {"vdna-commit 1\nwin ter\n", 22},
        {"vdna-commit 1\nwin\0ter\n", 22},
        {"vdna-commit 1\nwinter\nnight\n", 27},
        {"vdna-commit 1\nwinter\nwinter\n", 28},
        {"vdna-commit 1\n0123456789012345678901234567890123456789012345678901234567890123\n", 79},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_damaged(text, with_checksum(cases[i].lines, cases[i].size));
}

static int opened(const directory *made)
{
    const int place = open(made->path, O_RDONLY | O_DIRECTORY);
    assert_true(place >= 0);
    return place;
}

static vdna_status read_here(const directory *made, vdna_error *error, uint32_t *out_count)
{
    vdna_journal journal;
    const int place = opened(made);
    const vdna_status status = vdna_journal_read(place, made->path, error, &journal);
    *out_count = journal.count;
    vdna_journal_free(&journal);
    close(place);
    return status;
}

static void what_is_no_readable_file_is_an_error(void **state)
{
    const directory *made = *state;
    const char *path = path_in(made, ".commit");
    vdna_error error;
    uint32_t count;
    assert_int_equal(mkdir(path, 0700), 0);
    assert_int_equal(read_here(made, &error, &count), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "/.commit: cannot read: Is a directory"));
    assert_int_equal(rmdir(path), 0);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(read_here(made, &error, &count), VDNA_ERR_FORMAT);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(symlink("elsewhere", path), 0);
    assert_int_equal(read_here(made, &error, &count), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "/.commit: cannot open: Too many levels of symbolic links"));
    memset(text, '\n', sizeof text);
    save_file(path, text, VDNA_JOURNAL_SIZE + 50);
    assert_int_equal(read_here(made, &error, &count), VDNA_ERR_FORMAT);
}

static void a_call_that_is_refused_while_a_journal_is_read_is_named(void **state)
{
    static const refused_call cases[] = {
        {"openat", EACCES, VDNA_ERR_IO, "/.commit: cannot open: Permission denied"},
        {"malloc", ENOMEM, VDNA_ERR_NOMEM, "/.commit: no memory left"},
        {"realloc", ENOMEM, VDNA_ERR_NOMEM, "/.commit: no memory left"},
        {"read", EIO, VDNA_ERR_IO, "/.commit: cannot read: Input/output error"},
        {"read", EINTR, VDNA_OK, ""},
    };
    const directory *made = *state;
    const size_t size = with_checksum("vdna-commit 1\nnight\nwinter\n", 27);
    save_file(path_in(made, ".commit"), text, size);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_error error = {""};
        uint32_t count;
        refuse(cases[i].call, 0, cases[i].refusal);
        assert_int_equal(read_here(made, &error, &count), cases[i].expected);
        assert_true(was_refused());
        assert_non_null(strstr(error.text, cases[i].reason));
        assert_int_equal(count, cases[i].expected == VDNA_OK ? 2 : 0);
    }
}

static void a_call_that_is_refused_while_a_journal_is_written_leaves_none(void **state)
{
    static const char *const names[] = {"winter"};
    static const struct {
        const char *call;
        int refusal;
        const char *reason;
    } cases[] = {
        {"malloc", ENOMEM, "no memory left"},
        {"openat", EACCES, "cannot create a .partial file beside it: Permission denied"},
        {"write", ENOSPC, "cannot write: No space left on device"},
        {"fsync", EIO, "cannot fsync: Input/output error"},
        {"renameat", EIO, "cannot rename"},
    };
    const directory *made = *state;
    vdna_journal journal = journal_of(names, 1);
    const int place = opened(made);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_error error = {""};
        refuse(cases[i].call, 0, cases[i].refusal);
        const vdna_status status = vdna_journal_write(place, made->path, &journal, &error);
        assert_true(was_refused());
        assert_int_equal(status, i == 0 ? VDNA_ERR_NOMEM : VDNA_ERR_IO);
        assert_non_null(strstr(error.text, cases[i].reason));
        assert_non_null(strstr(error.text, made->path));
        assert_non_null(strstr(error.text, "; the map is unchanged"));
        assert_int_not_equal(access(path_in(made, ".commit"), F_OK), 0);
        assert_int_not_equal(access(path_in(made, ".commit.0.partial"), F_OK), 0);
    }
    close(place);
    vdna_journal_free(&journal);
}

static void a_journal_that_cannot_be_finished_stays_and_is_finished_later(void **state)
{
    static const char *const names[] = {"night", "winter"};
    static const struct {
        const char *call;
        int calls;
        const char *reason;
    } cases[] = {
        {"fsync", 0, ": cannot fsync this directory: Input/output error; the update is final"},
        {"renameat", 1, ": cannot rename winter.vdna.staged to winter.vdna: Input/output error;"},
        {"fsync", 1, ": cannot fsync this directory: Input/output error; the update is final"},
        {"unlinkat", 0, ": cannot remove .commit: Input/output error; the update is final"},
    };
    const directory *made = *state;
    vdna_journal journal = journal_of(names, 2);
    const int place = opened(made);
    save_file(path_in(made, "night.vdna.staged"), "new", 3);
    save_file(path_in(made, "winter.vdna.staged"), "new", 3);
    assert_int_equal(vdna_journal_write(place, made->path, &journal, NULL), VDNA_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_error error = {""};
        refuse(cases[i].call, cases[i].calls, EIO);
        assert_int_equal(vdna_journal_finish(place, made->path, &journal, &error), VDNA_ERR_IO);
        assert_true(was_refused());
        assert_non_null(strstr(error.text, made->path));
        assert_non_null(strstr(error.text, cases[i].reason));
        assert_int_equal(access(path_in(made, ".commit"), F_OK), 0);
    }
    assert_int_equal(vdna_journal_finish(place, made->path, &journal, NULL), VDNA_OK);
    assert_int_not_equal(access(path_in(made, ".commit"), F_OK), 0);
    assert_int_equal(access(path_in(made, "winter.vdna"), F_OK), 0);
    assert_int_equal(files_in(made->path), 2);
    close(place);
    vdna_journal_free(&journal);
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_journal_has_the_bytes_of_the_specification),
        cmocka_unit_test(the_longest_journal_is_read),
        cmocka_unit_test(any_changed_or_missing_byte_is_damage),
        cmocka_unit_test(lines_that_are_no_visible_names_in_order_are_damage),
        CASE(what_is_no_readable_file_is_an_error),
        CASE(a_call_that_is_refused_while_a_journal_is_read_is_named),
        CASE(a_call_that_is_refused_while_a_journal_is_written_leaves_none),
        CASE(a_journal_that_cannot_be_finished_stays_and_is_finished_later),
    };
    return cmocka_run_group_tests_name("journal", tests, NULL, NULL);
}
