// The doctor's checks of what the system grants, each broken on purpose, and the screen.
#include <sstream>

#include "doctor/doctor.hpp"
#include "doctor/machine.hpp"
#include "system_root.hpp"
#include "verdicts.hpp"

using namespace vdna::doctor;

namespace
{

constexpr uint64_t mib = 1 << 20;
constexpr const char *unit_path = "lib/systemd/system/vdna_selectord.service";
constexpr const char *unit_text = "[Service]\nDynamicUser=yes\nProtectHome=yes\nPrivateTmp=yes\n";

Trial installed()
{
    Trial trial;
    trial.program = "/usr/sbin/vdna_selectord";
    trial.version = "1.0";
    trial.held_bytes = 180 * mib;
    return trial;
}

MachineFacts with_limits(const std::string &limit, const std::string &capabilities)
{
    SystemRoot root;
    root.write("proc/self/limits",
               "Limit  Soft Limit  Hard Limit  Units\nMax locked memory         " + limit +
                   "             8388608              bytes\n");
    root.write("proc/self/status", "CapEff:\t" + capabilities + "\n");
    root.write("proc/meminfo", "MemTotal:  8000000 kB\nMemAvailable:    204800 kB\n");
    return read_machine(root.path(), {});
}

void settings_that_the_daemon_refuses_fail(void **)
{
    Settings settings;
    Trial trial = installed();
    expect_ok(check_settings(settings, trial), "the defaults");
    settings.file = "/etc/vdna/vdna.toml";
    expect_ok(check_settings(settings, trial), "/etc/vdna/vdna.toml is valid");
    trial.refusal = "/etc/vdna/vdna.toml:3:1: unknown key 'top'; correct or remove it";
    expect_failure(check_settings(settings, trial), "unknown key", "correct or remove it");
    expect_unknown(check_start(trial, "", "1.0"), "see settings");
    expect_warning(check_settings(settings, {}), "is not read", "install");
}

void a_daemon_that_would_not_start_fails(void **)
{
    Trial trial = installed();
    expect_ok(check_start(trial, "", "1.0"), "vdna_selectord 1.0 would start");
    expect_warning(check_start(trial, "", "1.1"), "vdna_selectord is 1.0, vdna is 1.1",
                   "one release");
    trial.failure = "[cpu] nice is -5, which the system refuses; set Nice=";
    expect_failure(check_start(trial, "", "1.0"), "nice is -5", "set Nice=");
    expect_failure(check_start(trial, trial.failure, "1.0"), "see map", "mend that first");
    expect_unknown(check_start({}, "", "1.0"), "not installed");
}

void too_little_memory_fails(void **)
{
    const MachineFacts machine = with_limits("65536", "0"); // 200 MiB are available
    Trial trial = installed();
    expect_ok(check_memory(machine, trial, {}), "at most 180 MiB, 200 MiB are available");
    trial.held_bytes = 300 * mib;
    expect_failure(check_memory(machine, trial, {}), "at most 300 MiB", "map.copy = false");
    // A daemon that runs has its memory already.
    expect_ok(check_memory(machine, trial, {{"resident_bytes", 250 * mib}}), "300 MiB");
    expect_unknown(check_memory(machine, {}, {}), "see start");
}

void a_limit_of_locked_memory_fails_where_it_is_to_be_locked(void **)
{
    Settings settings;
    const Trial trial = installed();
    expect_ok(check_lock(with_limits("65536", "0"), settings, trial), "not wanted");
    settings.lock_memory = true;
    expect_failure(check_lock(with_limits("65536", "0"), settings, trial),
                   "at most 64 KiB of 180 MiB", "LimitMEMLOCK=infinity");
    expect_ok(check_lock(with_limits("unlimited", "0"), settings, trial), "without a limit");
    expect_ok(check_lock(with_limits("268435456", "0"), settings, trial), "up to 256 MiB");
    expect_ok(check_lock(with_limits("65536", "0000000000004000"), settings, trial),
              "CAP_IPC_LOCK");
    expect_unknown(check_lock(with_limits("65536", "0"), settings, {}), "see start");
}

void a_full_disk_is_a_warning(void **)
{
    MachineFacts machine;
    expect_unknown(check_disk(machine, 0), "how much is free");
    machine.disks = {{"the map", "/map", 500 * mib}, {"temporary files", "/tmp", 200 * mib}};
    expect_ok(check_disk(machine, 0), "500 MiB free for the map, 200 MiB for temporary files");
    expect_warning(check_disk(machine, 150 * mib), "200 MiB free for /tmp: too little",
                   "du -xh /tmp");
    machine.disks[0].free_bytes = 50 * mib;
    expect_warning(check_disk(machine, 0), "50 MiB free for /map", "du -xh /map");
}

void files_that_cannot_be_read_fail(void **)
{
    MachineFacts machine;
    machine.files = {{"/nowhere/map", false, "/nowhere"}};
    expect_failure(check_access(machine), "/nowhere/map cannot be read",
                   "make it, or name another");
    machine.files = {{"/var/map", true, "/var/map"}};
    expect_ok(check_access(machine), "by this user");

    SystemRoot root;
    root.write(unit_path, unit_text);
    machine.unit = read_machine(root.path(), {}).unit;
    expect_failure(check_access(machine), "/var/map cannot be read by the service's user",
                   "chmod o+rX /var/map");
    machine.files = {{"/var/lib/vdna/map", true, "/var/lib/vdna"}};
    expect_failure(check_access(machine), "cannot be read by the service's user", "chmod");
    root.write(unit_path, unit_text + std::string("StateDirectory=vdna\n"));
    machine.unit = read_machine(root.path(), {}).unit;
    expect_ok(check_access(machine), "by the service too");
    machine.files = {{"/var/lib/vdna/map", false, "/var/lib/vdna"}};
    expect_unknown(check_access(machine), "the service's own");
    machine.files = {{"/home/me/map", true, ""}};
    expect_failure(check_access(machine), "hidden from the service by ProtectHome",
                   "/var/lib/vdna");
    machine.files = {{"/tmp/map", true, ""}};
    expect_failure(check_access(machine), "hidden from the service by PrivateTmp", "/var/lib/vdna");
    machine.files = {{"/var/map", true, ""}};
    expect_ok(check_access(machine), "by the service too");
}

void a_path_that_others_cannot_read_is_found(void **)
{
    SystemRoot root;
    root.write("map/winter.vdna", "x");
    namespace fs = std::filesystem;
    fs::permissions(root.path(), fs::perms(0755));
    fs::permissions(root.path() / "map/winter.vdna", fs::perms(0640));
    Settings settings;
    settings.map = root.path() / "map";
    const MachineFacts machine = read_machine(root.path(), settings);
    assert_int_equal(machine.files.size(), 2);
    assert_string_equal(machine.files[0].barrier.c_str(), "");
    assert_string_equal(machine.files[1].barrier.c_str(), machine.files[1].path.c_str());
    fs::permissions(root.path() / "map", fs::perms(0750));
    assert_string_equal(read_machine(root.path(), settings).files[1].barrier.c_str(),
                        settings.map.c_str());
}

void a_service_that_does_not_run_fails(void **)
{
    const SystemRoot root;
    const auto unit = [&] { return read_machine(root.path(), {}).unit; };
    expect_unknown(check_unit(unit()), "systemd does not run");
    root.write("run/systemd/system/x", "");
    expect_warning(check_unit(unit()), "not installed", "vdna-selectord");
    root.write(unit_path, unit_text);
    expect_failure(check_unit(unit()), "no /etc/vdna/vdna.toml", "--print-config");
    root.write("etc/vdna/vdna.toml", "");
    expect_failure(check_unit(unit()), "does not run", "systemctl enable --now");
    root.write("sys/fs/cgroup/system.slice/vdna_selectord.service/x", "");
    expect_warning(check_unit(unit()), "will not start with the machine", "systemctl enable");
    root.write("etc/systemd/system/multi-user.target.wants/vdna_selectord.service", "");
    expect_ok(check_unit(unit()), "enabled and running");
    root.write("etc/vdna.toml", "");
    expect_warning(check_unit(unit()), "no longer read", "mv /etc/vdna.toml /etc/vdna/vdna.toml");
}

void the_screen_has_80_columns(void **)
{
    const Diagnosis diagnosis{
        {},
        {{"network", "route", ok("239.255.76.67 goes by lo")},
         {"network", "channels",
          ok("CAMERA 15 Hz, POSE bot_core.pose_t 100 Hz, IMU bot_core.imu_t")},
         {"map", "files",
          broken("/map: cannot be read", "sudo chmod a+rX /map and something more "
                                         "that is longer than one line is")},
         {"map", "daemon", unknown("none heard")},
         {"system", "unit", warn("it is so", "do this")}}};
    const std::string expected =
        "ok   network   route    239.255.76.67 goes by lo\n"
        "ok             channels CAMERA 15 Hz, POSE bot_core.pose_t 100 Hz, IMU\n"
        "                        bot_core.imu_t\n"
        "FAIL map       files    /map: cannot be read\n"
        "  -> sudo chmod a+rX /map and something more that is longer than one line is\n"
        "--             daemon   none heard\n"
        "warn system    unit     it is so\n"
        "  -> do this\n"
        "1 failure, 1 warning\n";
    assert_string_equal(screen_of(diagnosis).c_str(), expected.c_str());
    std::istringstream lines(expected);
    for (std::string line; std::getline(lines, line);)
        assert_true(line.size() <= 80);
    assert_true(has_failed(diagnosis));
    assert_false(has_failed({{}, {{"system", "unit", warn("it is so", "do this")}}}));
    assert_int_equal(json_of(diagnosis)["failures"].get<int>(), 1);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(settings_that_the_daemon_refuses_fail),
        cmocka_unit_test(a_daemon_that_would_not_start_fails),
        cmocka_unit_test(too_little_memory_fails),
        cmocka_unit_test(a_limit_of_locked_memory_fails_where_it_is_to_be_locked),
        cmocka_unit_test(a_full_disk_is_a_warning),
        cmocka_unit_test(files_that_cannot_be_read_fail),
        cmocka_unit_test(a_path_that_others_cannot_read_is_found),
        cmocka_unit_test(a_service_that_does_not_run_fails),
        cmocka_unit_test(the_screen_has_80_columns),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
