// Model files: refusals, and that only the hashed bytes are loaded.
#include <algorithm>
#include <cstdint>

#include <cmocka.hpp>
#include <folder.hpp>
#include <sched.h>
#include <sha2.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include "failure.hpp"
#include "model.hpp"
#include "sha256.h"

using namespace vdna::backbone;

static std::string sha256_of(const std::string &bytes)
{
    char text[SHA256_DIGEST_STRING_LENGTH];
    return SHA256Data(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size(), text);
}

// `body` throws a vdna::fail::Failure with `status`, and its sentence holds `words`.
template <class Body>
static void assert_refused(vdna_status status, const std::string &words, Body body)
{
    try {
        body();
    } catch (const vdna::fail::Failure &failure) {
        if (std::string(failure.what()).find(words) == std::string::npos)
            fail_msg("expected: %s; found: %s", words.c_str(), failure.what());
        assert_int_equal(failure.status(), status);
        return;
    }
    fail_msg("expected: %s; found nothing to refuse", words.c_str());
}

static void the_pinned_bytes_are_what_is_loaded(void **)
{
    const Folder folder;
    const std::string bytes(3000000, 'w'); // not a multiple of any likely block size
    const Model model(folder.write("a.onnx", bytes), sha256_of(bytes));
    assert_true(file_bytes(model.path()) == bytes);
    model.require_unchanged();
}

static void an_empty_file_has_a_hash_as_well(void **)
{
    const Folder folder;
    const Model model(folder.write("a.onnx", ""), sha256_of(""));
    assert_true(file_bytes(model.path()).empty());
}

static std::string noise(size_t count)
{
    std::string bytes;
    uint32_t state = 1;
    for (size_t i = 0; i < count; i++) {
        state = state * 1664525u + 1013904223u;
        bytes += static_cast<char>(state >> 24);
    }
    return bytes;
}

static void a_file_of_any_length_has_its_hash(void **)
{
    const Folder folder;
    const std::string all = noise((size_t{1} << 19) + 100);
    for (const size_t piece : {size_t{64}, size_t{1} << 18, size_t{1} << 19})
        for (const int more : {-64, -9, -8, -1, 0, 1, 55, 56, 63, 64, 65}) {
            const std::string bytes = all.substr(0, piece + static_cast<size_t>(more));
            const Model model(folder.write("a.onnx", bytes), sha256_of(bytes));
        }
}

static void instructions_give_the_hash_of_libmd(void **)
{
    const std::string bytes = noise(100 * VDNA_SHA256_BLOCK);
    const auto *const blocks = reinterpret_cast<const uint8_t *>(bytes.data());
    SHA2_CTX expected;
    SHA256Init(&expected);
    uint32_t *const state = expected.state.st32;
    uint32_t found[8];
    std::copy(state, state + 8, found);
    if (!vdna_sha256_by_instruction(found, blocks, 100))
        _skip(__FILE__, __LINE__); // the macro is undone by cmocka.hpp
    for (size_t i = 0; i < 100; i++)
        SHA256Transform(state, blocks + i * VDNA_SHA256_BLOCK);
    assert_memory_equal(found, state, sizeof found);
}

static void other_bytes_are_refused(void **)
{
    const Folder folder;
    const std::string bytes(3000000, 'w');
    for (const size_t place : {size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
        std::string other = bytes;
        other[place] ^= 1;
        const auto file = folder.write("a.onnx", other);
        assert_refused(VDNA_ERR_CHECKSUM, sha256_of(other), [&] { Model(file, sha256_of(bytes)); });
    }
}

static void files_that_cannot_be_models_are_refused(void **)
{
    const Folder folder;
    assert_refused(VDNA_ERR_IO, "No such file", [&] { Model(folder.path() / "absent", ""); });
    assert_refused(VDNA_ERR_IO, "not a regular file", [&] { Model(folder.path(), ""); });
    const auto huge = folder.write("huge.onnx", "");
    std::filesystem::resize_file(huge, (uintmax_t{1} << 31) + 1); // takes no room on the disk
    assert_refused(VDNA_ERR_FORMAT, "2147483649 bytes", [&] { Model(huge, ""); });
}

// The file is read in pieces; the entry is found anywhere, also across their borders.
static void weights_in_another_file_are_refused(void **)
{
    const Folder folder;
    const std::string entry = "\x0a\x08location";
    for (size_t border = 1 << 15; border <= 1 << 20; border *= 2)
        for (size_t before = 0; before <= entry.size(); before++) {
            std::string bytes(border + entry.size(), 'w');
            bytes.replace(border - before, entry.size(), entry);
            const auto file = folder.write("a.onnx", bytes);
            assert_refused(VDNA_ERR_UNSUPPORTED, "weights in another file",
                           [&] { Model(file, sha256_of(bytes)); });
        }
}

static void another_file_of_that_name_is_not_loaded(void **)
{
    const Folder folder;
    const auto file = folder.write("a.onnx", "hashed");
    const Model model(file, sha256_of("hashed"));
    std::filesystem::rename(folder.write("b.onnx", "other"), file);
    assert_true(file_bytes(file) == "other");
    assert_true(file_bytes(model.path()) == "hashed");
}

static void a_file_that_was_written_to_is_noticed(void **)
{
    const Folder folder;
    const auto file = folder.write("a.onnx", "hashed");
    const Model model(file, sha256_of("hashed"));
    const auto time = std::filesystem::last_write_time(file);
    usleep(50000); // the clock of the file system ticks slowly
    folder.write("a.onnx", "HASHED");
    std::filesystem::last_write_time(file, time); // like tools that copy times
    assert_refused(VDNA_ERR_IO, "changed while it was read", [&] { model.require_unchanged(); });
}

// 0 = refused as it should be, 1 = not refused, 2 = this machine does not let us hide /proc.
static int load_without_proc(const std::filesystem::path &file)
{
    const Model model(file, sha256_of("hashed"));
    if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0 || mount("none", "/proc", "tmpfs", 0, "") != 0)
        return 2;
    try {
        model.path();
    } catch (const vdna::fail::Failure &failure) {
        return std::string(failure.what()).find("mount /proc") == std::string::npos;
    }
    return 1;
}

static void without_proc_the_error_says_so(void **)
{
    const Folder folder;
    const auto file = folder.write("a.onnx", "hashed");
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(load_without_proc(file));
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == 2)
        _skip(__FILE__, __LINE__);
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pinned_bytes_are_what_is_loaded),
        cmocka_unit_test(an_empty_file_has_a_hash_as_well),
        cmocka_unit_test(a_file_of_any_length_has_its_hash),
        cmocka_unit_test(instructions_give_the_hash_of_libmd),
        cmocka_unit_test(other_bytes_are_refused),
        cmocka_unit_test(files_that_cannot_be_models_are_refused),
        cmocka_unit_test(weights_in_another_file_are_refused),
        cmocka_unit_test(another_file_of_that_name_is_not_loaded),
        cmocka_unit_test(a_file_that_was_written_to_is_noticed),
        cmocka_unit_test(without_proc_the_error_says_so),
    };
    return cmocka_run_group_tests_name("model", tests, nullptr, nullptr);
}
