// The settings: paths of a file, and comments of --print-config.
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>

#include <unistd.h>

#include "cmocka.hpp"
#include "folder.hpp"
#include "program/exit_code.hpp"
#include "selectord/config.hpp"

namespace
{

using namespace vdna;
using namespace vdna::selectord;

Config with_map(const Folder &folder, const std::string &map)
{
    return read_config(folder.write("robot.toml", "[map]\ndirectory = '" + map + "'\n"));
}

void a_relative_path_begins_in_the_folder_of_the_file(void **)
{
    const Folder folder;
    const std::string here = folder.path();
    assert_string_equal(with_map(folder, "park").map_directory.c_str(), (here + "/park").c_str());
    assert_string_equal(with_map(folder, "./a/../park").map_directory.c_str(),
                        (here + "/park").c_str());
    assert_string_equal(with_map(folder, "~me/park").map_directory.c_str(),
                        (here + "/~me/park").c_str());
    assert_string_equal(with_map(folder, "/srv/park").map_directory.c_str(), "/srv/park");

    assert_int_equal(chdir(folder.path().c_str()), 0);
    assert_string_equal(read_config("robot.toml").map_directory.c_str(), "/srv/park");
    folder.write("robot.toml", "[map]\ndirectory = 'park'\n");
    assert_string_equal(read_config("robot.toml").map_directory.c_str(), (here + "/park").c_str());
}

void a_tilde_is_the_home_directory(void **)
{
    const Folder folder;
    setenv("HOME", "/home/me", 1);
    assert_string_equal(with_map(folder, "~/maps/park").map_directory.c_str(),
                        "/home/me/maps/park");
    assert_string_equal(with_map(folder, "~").map_directory.c_str(), "/home/me/");
    for (const char *none : {"", "me"}) {
        setenv("HOME", none, 1);
        try {
            with_map(folder, "~/park");
            fail_msg("expected a refusal with HOME='%s'", none);
        } catch (const program::UsageError &error) {
            assert_non_null(std::strstr(error.what(), "[map] directory is \"~/park\", but HOME"));
        }
    }
}

void a_network_is_a_path_only_if_it_is_written_as_one(void **)
{
    const Folder folder;
    const auto manifest = [&](const std::string &text) {
        return read_config(folder.write("robot.toml", "[backbone]\nmanifest = '" + text +
                                                          "'\nruntime = 'libonnxruntime.so.1'\n"))
            .manifest;
    };
    const std::string here = folder.path();
    assert_string_equal(manifest("mobilenet_v2").c_str(), "mobilenet_v2");
    assert_string_equal(manifest("mine.toml").c_str(), (here + "/mine.toml").c_str());
    assert_string_equal(manifest("./libmine.so").c_str(), (here + "/libmine.so").c_str());
    assert_string_equal(read_config(here + "/robot.toml").runtime.c_str(), "libonnxruntime.so.1");
    assert_string_equal(
        read_config(folder.write("empty.toml", "[backbone]\nruntime = ''\n")).runtime.c_str(), "");
}

void a_path_that_gets_too_long_is_refused(void **)
{
    const Folder folder;
    try {
        with_map(folder, std::string(4095, 'a'));
        fail_msg("expected a refusal");
    } catch (const program::UsageError &error) {
        assert_non_null(std::strstr(error.what(), "robot.toml:2:13: [map] directory has 4"));
    }
}

void each_key_has_a_comment_with_limits_and_default(void **)
{
    std::ostringstream out;
    print_config({}, out);
    std::istringstream text(out.str());
    std::string before;
    size_t keys = 0;
    for (std::string line; std::getline(text, line); before = line) {
        if (line.find(" = ") == std::string::npos || line[0] == '#')
            continue;
        keys++;
        if (before.rfind("# ", 0) != 0 || before.find("default ") == std::string::npos)
            fail_msg("%s: expected a comment before it, found: %s", line.c_str(), before.c_str());
    }
    assert_true(keys > 35);
    for (const char *line :
         {"# compute threads of the network (1 to 256, default 2)\nthreads = 2\n",
          "# seconds, in place of frames: choose after this much camera time, seconds (0.001 to "
          "1000000.0)\n",
          "(default true)\ncopy = true\n", "(default \"/var/lib/vdna/map\")\ndirectory = "})
        if (out.str().find(line) == std::string::npos)
            fail_msg("expected '%s' in:\n%s", line, out.str().c_str());
}

void every_text_is_read_as_it_was_printed(void **)
{
    const Folder folder;
    for (const char *text :
         {"", "it's", "  \'\'\'a\\\n[b", "\"\"\"\n\'\'\'", "\t\n", "\xEF\xBB\xBF\'\n"}) {
        Config config;
        config.url = text;
        std::ostringstream out;
        print_config(config, out);
        const Config again = read_config(folder.write("printed.toml", out.str()).string());
        assert_string_equal(again.url.c_str(), text);
    }
}

void settings_are_printed_for_a_file_in_any_folder(void **)
{
    const Folder folder;
    assert_int_equal(chdir(folder.path().c_str()), 0);
    Config config;
    config.map_directory = "park";
    make_paths_absolute(config);
    assert_string_equal(config.map_directory.c_str(), (folder.path() / "park").c_str());
    assert_string_equal(config.manifest.c_str(), VDNA_BACKBONE_DEFAULT);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_relative_path_begins_in_the_folder_of_the_file),
        cmocka_unit_test(a_tilde_is_the_home_directory),
        cmocka_unit_test(a_network_is_a_path_only_if_it_is_written_as_one),
        cmocka_unit_test(a_path_that_gets_too_long_is_refused),
        cmocka_unit_test(each_key_has_a_comment_with_limits_and_default),
        cmocka_unit_test(every_text_is_read_as_it_was_printed),
        cmocka_unit_test(settings_are_printed_for_a_file_in_any_folder),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
