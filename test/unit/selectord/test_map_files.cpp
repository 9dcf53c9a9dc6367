// Whether the files of a map are still what they were, and what a lost page of one does.
#include <cstring>
#include <string>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "folder.hpp"
#include "selectord/lost_pages.hpp"
#include "selectord/map_files.hpp"

using namespace vdna::selectord;

namespace
{

const size_t page = static_cast<size_t>(sysconf(_SC_PAGESIZE));

// A map of two files, which are held open. The system's time stamps may be as coarse as its tick.
struct Watched {
    Watched() { usleep(20000); }

    Folder folder;
    std::filesystem::path winter = folder.write("winter.vdna", "winter");
    std::filesystem::path summer = folder.write("summer.vdna", "summer");
    MapFiles files{folder.path(), true};
};

void change_byte(const std::filesystem::path &path)
{
    const int file = open(path.c_str(), O_WRONLY);
    assert_int_equal(pwrite(file, "W", 1, 0), 1);
    close(file);
}

void a_map_that_nobody_touches_is_unchanged(void **)
{
    Watched map;
    assert_string_equal(map.files.changed_in_place().c_str(), "");
    assert_false(map.files.is_directory_changed());
    map.folder.write("note.txt", "no experience");
    assert_false(map.files.is_directory_changed());
}

void a_file_written_or_cut_short_in_place_is_named(void **)
{
    Watched written, cut;
    change_byte(written.winter);
    assert_string_equal(written.files.changed_in_place().c_str(), written.winter.c_str());
    assert_true(written.files.is_directory_changed());
    assert_int_equal(truncate(cut.summer.c_str(), 3), 0);
    assert_string_equal(cut.files.changed_in_place().c_str(), cut.summer.c_str());
}

void a_changed_file_whose_time_was_set_back_is_named_too(void **)
{
    Watched map;
    struct stat before;
    assert_int_equal(stat(map.winter.c_str(), &before), 0);
    change_byte(map.winter);
    const timespec times[] = {before.st_atim, before.st_mtim};
    assert_int_equal(utimensat(AT_FDCWD, map.winter.c_str(), times, 0), 0);
    assert_string_equal(map.files.changed_in_place().c_str(), map.winter.c_str());
}

void a_file_that_is_replaced_or_deleted_keeps_its_bytes(void **)
{
    Watched map;
    std::filesystem::rename(map.folder.write("new", "another winter"), map.winter);
    std::filesystem::remove(map.summer);
    assert_string_equal(map.files.changed_in_place().c_str(), "");
    assert_true(map.files.is_directory_changed());
}

void a_deleted_file_is_watched_on(void **)
{
    Watched map;
    std::filesystem::create_hard_link(map.winter, map.folder.path() / "kept");
    std::filesystem::remove(map.winter);
    assert_string_equal(map.files.changed_in_place().c_str(), "");
    change_byte(map.folder.path() / "kept");
    assert_string_equal(map.files.changed_in_place().c_str(), map.winter.c_str());
}

void a_file_that_comes_or_goes_changes_the_directory_until_it_is_as_it_was(void **)
{
    Watched map;
    const std::filesystem::path added = map.folder.write("autumn.vdna", "autumn");
    assert_true(map.files.is_directory_changed());
    std::filesystem::remove(added);
    assert_false(map.files.is_directory_changed());
    std::filesystem::rename(map.winter, map.folder.path() / "moved");
    assert_true(map.files.is_directory_changed());
}

void a_directory_that_is_gone_is_changed(void **)
{
    Watched map;
    std::filesystem::remove_all(map.folder.path());
    assert_true(map.files.is_directory_changed());
    assert_string_equal(map.files.changed_in_place().c_str(), "");
}

void copies_and_forgotten_files_are_not_watched(void **)
{
    Watched map;
    MapFiles copied(map.folder.path(), false);
    map.files.forget(map.winter);
    change_byte(map.winter);
    assert_string_equal(copied.changed_in_place().c_str(), "");
    assert_true(copied.is_directory_changed());
    assert_string_equal(map.files.changed_in_place().c_str(), "");
}

void a_directory_that_cannot_be_read_is_refused(void **)
{
    try {
        MapFiles files("/nowhere", true);
    } catch (const vdna::Error &error) {
        assert_non_null(std::strstr(error.what(), "/nowhere"));
        return;
    }
    fail_msg("it was accepted");
}

// A mapped file of two pages whose second one is gone.
const volatile char *map_half_lost(const Folder &folder)
{
    const std::string path = folder.write("lost", std::string(2 * page, 'x'));
    const int file = open(path.c_str(), O_RDWR);
    const void *bytes = mmap(nullptr, 2 * page, PROT_READ, MAP_PRIVATE, file, 0);
    assert_int_equal(ftruncate(file, page), 0);
    close(file);
    assert_true(bytes != MAP_FAILED);
    return static_cast<const volatile char *>(bytes);
}

void a_file_cut_short_raises_sigbus_without_it(void **)
{
    const Folder folder;
    const volatile char *const bytes = map_half_lost(folder);
    const pid_t child = fork();
    if (child == 0) {
        signal(SIGBUS, SIG_DFL);
        _exit(bytes[page]);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    assert_int_equal(WTERMSIG(status), SIGBUS);
}

void a_lost_page_reads_as_zeros_and_counts_as_a_change(void **)
{
    survive_lost_pages();
    Watched map;
    const volatile char *const bytes = map_half_lost(map.folder);
    const uint32_t before = lost_pages();
    assert_int_equal(bytes[page - 1], 'x');
    assert_int_equal(bytes[2 * page - 1], 0);
    assert_int_equal(bytes[page], 0);
    assert_int_equal(lost_pages(), before + 1);
    assert_string_equal(map.files.changed_in_place().c_str(), map.folder.path().c_str());
    assert_string_equal(MapFiles(map.folder.path(), true).changed_in_place().c_str(), "");
    signal(SIGBUS, SIG_DFL);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_map_that_nobody_touches_is_unchanged),
        cmocka_unit_test(a_file_written_or_cut_short_in_place_is_named),
        cmocka_unit_test(a_changed_file_whose_time_was_set_back_is_named_too),
        cmocka_unit_test(a_file_that_is_replaced_or_deleted_keeps_its_bytes),
        cmocka_unit_test(a_deleted_file_is_watched_on),
        cmocka_unit_test(a_file_that_comes_or_goes_changes_the_directory_until_it_is_as_it_was),
        cmocka_unit_test(a_directory_that_is_gone_is_changed),
        cmocka_unit_test(copies_and_forgotten_files_are_not_watched),
        cmocka_unit_test(a_directory_that_cannot_be_read_is_refused),
        cmocka_unit_test(a_file_cut_short_raises_sigbus_without_it),
        cmocka_unit_test(a_lost_page_reads_as_zeros_and_counts_as_a_change),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
