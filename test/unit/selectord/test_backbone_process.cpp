// A network in a process of its own: this program is that process too, as the daemon is. The
// network is test/support/stub/unruly_backbone.c, which does what its picture says.
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <thread>

#include <cmocka.hpp>
#include <dirent.h>
#include <sys/wait.h>
#include <unistd.h>

#include "program/clock.hpp"
#include "selectord/backbone_child.hpp"
#include "selectord/backbone_process.hpp"

using namespace vdna;
using namespace vdna::selectord;

namespace
{

constexpr int64_t second_us = 1000000;
constexpr uint32_t budget_ms = 150;
constexpr int64_t slack_us = 500000; // of the machine, and to reap a killed process

Config config_with_budget(uint32_t milliseconds = budget_ms)
{
    Config config;
    config.manifest = VDNA_UNRULY_BACKBONE;
    config.budget_ms = milliseconds;
    return config;
}

vdna_image picture_of(const char *command)
{
    return {reinterpret_cast<const uint8_t *>(command),
            std::strlen(command) + 1,
            1,
            1,
            0,
            VDNA_PIXEL_GREY};
}

// The process, and the backbone that it is.
struct Network {
    Config config;
    BackboneProcess process{config};
    Backbone backbone = process.open();
    vdna_error error{};
    vdna_backbone_frame frame{};
    int64_t took_us = 0;

    explicit Network(uint32_t milliseconds = budget_ms) : config(config_with_budget(milliseconds))
    {
    }

    vdna_status run(const char *command)
    {
        const vdna_image image = picture_of(command);
        error = {};
        const int64_t begin_us = program::monotonic_us();
        const vdna_status status = vdna_backbone_run(backbone.get(), &image, &error, &frame);
        took_us = program::monotonic_us() - begin_us;
        return status;
    }

    // Run pictures until one is answered.
    void assert_comes_back()
    {
        const int64_t give_up_us = program::monotonic_us() + 20 * second_us;
        while (run("") != VDNA_OK) {
            assert_true(program::monotonic_us() < give_up_us);
            assert_true(took_us < budget_ms * 1000 + slack_us);
            usleep(2000);
        }
    }

    void assert_said(const char *words) { assert_non_null(std::strstr(error.text, words)); }
};

int open_files()
{
    DIR *const folder = opendir("/proc/self/fd");
    int count = 0;
    while (readdir(folder))
        count++;
    closedir(folder);
    return count;
}

} // namespace

static void it_gives_what_the_network_gives(void **)
{
    Network network;
    assert_string_equal(network.backbone.info().identity.taps, "mid:2:4,top:1:1");
    assert_int_equal(network.run(""), VDNA_OK);
    assert_int_equal(network.frame.tap_count, 2);
    const float mid[8] = {-1, -0.5f, 0, 0.5f, 1, 2, 3, 4};
    assert_memory_equal(network.frame.taps[0].values, mid, sizeof mid);
    assert_true(network.frame.taps[1].values[0] == 0.25f);
    assert_int_equal(network.frame.dim, 5);
    assert_true(network.frame.embedding[0] == 1);
    assert_null(network.frame.last_layer);
    assert_null(network.frame.input);
}

static void a_process_that_ends_is_named_and_started_again(void **)
{
    Network network;
    for (const auto &[command, words] : {std::pair{"crash", "after it was ended by signal 11"},
                                         {"exit", "after it ended with exit code 3"},
                                         {"mute", "after it was ended by signal 9"}}) {
        const pid_t before = network.process.pid();
        assert_int_equal(network.run(command), VDNA_ERR_RUNTIME);
        network.assert_said(words);
        assert_int_equal(network.run(""), VDNA_ERR_RUNTIME); // at once, and the same
        network.assert_said(words);
        assert_true(network.took_us < slack_us);
        network.assert_comes_back();
        assert_int_not_equal(network.process.pid(), before);
    }
}

static void a_process_that_hangs_is_ended_at_twice_its_budget(void **)
{
    Network network;
    const pid_t hanging = network.process.pid();
    const int64_t begin_us = program::monotonic_us();
    assert_int_equal(network.run("hang"), VDNA_ERR_RUNTIME);
    assert_true(network.took_us >= budget_ms * 1000 &&
                network.took_us < budget_ms * 1000 + slack_us);
    network.assert_said("takes longer than 150 ms");
    while (network.process.pid() == hanging) {
        assert_int_equal(network.run(""), VDNA_ERR_RUNTIME);
        assert_true(network.took_us < slack_us);
        usleep(1000);
    }
    const int64_t ended_us = program::monotonic_us() - begin_us;
    assert_true(ended_us >= 2 * budget_ms * 1000 && ended_us < 2 * budget_ms * 1000 + slack_us);
    network.assert_said("no answer within 300 ms");
    network.assert_comes_back();
}

static void a_stopped_process_is_a_hanging_one(void **)
{
    Network network;
    const pid_t stopped = network.process.pid();
    kill(stopped, SIGSTOP);
    assert_int_equal(network.run(""), VDNA_ERR_RUNTIME);
    network.assert_comes_back();
    assert_int_not_equal(network.process.pid(), stopped);
}

static void a_picture_that_was_given_up_is_not_answered_later(void **)
{
    setenv("VDNA_STUB_US", "225000", 1); // between once and twice the budget
    Network network;
    const pid_t slow = network.process.pid();
    assert_int_equal(network.run(""), VDNA_ERR_RUNTIME);
    usleep(100000);
    assert_int_equal(network.run("crash"), VDNA_ERR_RUNTIME); // its own answer, not the late one
    network.assert_said("signal 11");
    assert_int_not_equal(network.process.pid(), slow);
    unsetenv("VDNA_STUB_US");
}

static void wrong_answers_are_refused_and_the_process_goes_on(void **)
{
    Network network;
    const pid_t before = network.process.pid();
    assert_int_equal(network.run("nan"), VDNA_ERR_NONFINITE);
    assert_int_equal(network.run("shape"), VDNA_ERR_MISMATCH);
    network.assert_said("4 numbers");
    assert_int_equal(network.run("memory"), VDNA_ERR_RUNTIME);
    network.assert_said("memory: Cannot allocate memory");
    assert_int_equal(network.run(""), VDNA_OK);
    assert_int_equal(network.process.pid(), before);
}

static void it_can_compute_and_read_and_nothing_else(void **)
{
    Network network;
    for (const char *const deed : {"socket", "write", "create", "truncate", "unlink", "exec",
                                   "fork", "kill", "ptrace", "outlive", "io_uring"}) {
        assert_int_equal(network.run(deed), VDNA_ERR_RUNTIME);
        network.assert_said((std::string(deed) + ": Operation not permitted").c_str());
    }
    assert_int_equal(network.run("read"), VDNA_OK);
    assert_int_equal(network.run("thread"), VDNA_OK);
}

static void in_the_process_of_the_daemon_it_could_do_more(void **)
{
    const Backbone backbone(VDNA_UNRULY_BACKBONE, 1);
    for (const char *const deed : {"socket", "write", "create", "truncate", "unlink", "fork"}) {
        const vdna_image image = picture_of(deed);
        vdna_error error{};
        vdna_backbone_frame frame;
        assert_int_equal(vdna_backbone_run(backbone.get(), &image, &error, &frame), VDNA_OK);
    }
    assert_true(waitpid(-1, nullptr, 0) > 0); // the fork
}

static void two_hundred_kills_at_any_moment_leave_us_up(void **)
{
    const int files = open_files();
    {
        Network network;
        std::mt19937 random(14);
        uint64_t answered = 0;
        for (int kills = 0; kills < 200;) {
            answered += network.run("") == VDNA_OK;
            assert_true(network.took_us < budget_ms * 1000 + slack_us);
            const pid_t victim = network.process.pid();
            usleep(static_cast<useconds_t>(random() % 4000));
            if (victim > 0 && random() % 4 == 0)
                kills += kill(victim, SIGKILL) == 0;
        }
        network.assert_comes_back();
        assert_true(answered > 0);
    }
    assert_int_equal(open_files(), files);
    assert_int_equal(waitpid(-1, nullptr, WNOHANG), -1); // no process is left
    assert_int_equal(errno, ECHILD);
}

static void one_that_comes_back_as_another_network_stays_away(void **)
{
    Network network;
    setenv("VDNA_UNRULY_OPEN", "other", 1);
    network.run("crash");
    const int64_t give_up_us = program::monotonic_us() + 20 * second_us;
    do {
        assert_int_equal(network.run(""), VDNA_ERR_RUNTIME);
        usleep(2000);
    } while (!std::strstr(network.error.text, "gone for good") &&
             program::monotonic_us() < give_up_us);
    unsetenv("VDNA_UNRULY_OPEN");
    network.assert_said("another network");
    usleep(150000); // longer than the first pause
    assert_int_equal(network.run(""), VDNA_ERR_RUNTIME);
    network.assert_said("gone for good");
    assert_int_equal(network.process.pid(), 0);
}

static void a_network_that_cannot_be_opened_is_an_error(void **)
{
    Config config = config_with_budget();
    const auto refusal = [&config]() -> std::string {
        BackboneProcess process(config);
        try {
            const Backbone backbone = process.open();
        } catch (const Error &error) {
            return error.what();
        }
        return "";
    };
    setenv("VDNA_UNRULY_OPEN", "crash", 1);
    assert_non_null(std::strstr(refusal().c_str(), "signal 11"));
    setenv("VDNA_UNRULY_OPEN", "device", 1);
    assert_non_null(std::strstr(refusal().c_str(), "[backbone] process = false"));
    unsetenv("VDNA_UNRULY_OPEN");
    config.manifest = "/nowhere/mine.so";
    assert_non_null(
        std::strstr(refusal().c_str(), "/nowhere/mine.so: the plug-in cannot be loaded"));
}

static void a_picture_in_progress_can_be_cancelled(void **)
{
    Network network(10000);
    std::thread canceller([&network] {
        usleep(50000);
        vdna_backbone_cancel(network.backbone.get());
    });
    assert_int_equal(network.run("hang"), VDNA_ERR_RUNTIME);
    canceller.join();
    assert_true(network.took_us < second_us);
    network.assert_said("cancelled");
}

int main(int argc, char **argv)
{
    if (is_backbone_child(argc, argv))
        return run_backbone_child();
    signal(SIGPIPE, SIG_IGN);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_gives_what_the_network_gives),
        cmocka_unit_test(a_process_that_ends_is_named_and_started_again),
        cmocka_unit_test(a_process_that_hangs_is_ended_at_twice_its_budget),
        cmocka_unit_test(a_stopped_process_is_a_hanging_one),
        cmocka_unit_test(a_picture_that_was_given_up_is_not_answered_later),
        cmocka_unit_test(wrong_answers_are_refused_and_the_process_goes_on),
        cmocka_unit_test(it_can_compute_and_read_and_nothing_else),
        cmocka_unit_test(in_the_process_of_the_daemon_it_could_do_more),
        cmocka_unit_test(two_hundred_kills_at_any_moment_leave_us_up),
        cmocka_unit_test(one_that_comes_back_as_another_network_stays_away),
        cmocka_unit_test(a_network_that_cannot_be_opened_is_an_error),
        cmocka_unit_test(a_picture_in_progress_can_be_cancelled),
    };
    return cmocka_run_group_tests_name("backbone_process", tests, nullptr, nullptr);
}
