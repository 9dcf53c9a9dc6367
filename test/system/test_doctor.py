"""`vdna doctor` on a network of its own: a healthy robot, and robots with one thing broken.

Environment: VDNA_BIN (folder of the programs), PYTHONPATH with test/support.
"""
import json
import os
import shutil
import subprocess
import time

import own_network
from selectord import BIN, Camera, Selectord, Watch, WithConfiguration, grey_message, vdna
from tiny_network import write_tiny_network

WORK = os.path.abspath("doctor")
MAP, TINY = os.path.join(WORK, "map"), os.path.join(WORK, "tiny.toml")
SIDE = 96
# Root may do all; these are what it needs to read any file and to lock any amount of memory.
WITHOUT_PRIVILEGES = ["setpriv", "--bounding-set=-dac_override,-dac_read_search,-ipc_lock"]


def picture(number):
    return bytes((x + 3 * number) % 200 + y // 4 for y in range(SIDE) for x in range(SIDE))


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    write_tiny_network(WORK, ("tokens", "samples_neurons"))
    for name in ("summer", "winter"):
        vdna("simulate", os.path.join(WORK, name), "--condition", name, "--frames", 24)
    vdna("build", "--backbone", TINY, MAP, os.path.join(WORK, "summer"), os.path.join(WORK, "winter"))


class Senders:
    """Each of some functions is given its own camera again and again, until the block ends."""

    def __init__(self, *sends):
        self._sends = sends

    def __enter__(self):
        self._process = os.fork()
        if self._process == 0:
            cameras = [Camera() for _ in self._sends]
            for number in range(10 ** 6):
                for camera, send in zip(cameras, self._sends):
                    camera.send(grey_message(send(number), picture(number)))
                time.sleep(0.05)
        return self

    def __exit__(self, *_):
        os.kill(self._process, 9)
        os.waitpid(self._process, 0)


def now_us(_):
    return time.time_ns() // 1000


class Doctor(WithConfiguration):

    work = WORK

    def settings(self, more=""):
        return self.configure(f"[map]\ndirectory = '{MAP}'\n[backbone]\nmanifest = '{TINY}'\n{more}")

    def examine(self, *options, prefix=(), seconds=1, says_nothing_else=True):
        """The exit code, and the checks by their names."""
        result = subprocess.run(
            [*prefix, os.path.join(BIN, "vdna"), "doctor", "--json", "--for", str(seconds),
             *map(str, options)], capture_output=True, text=True, timeout=120)
        if says_nothing_else:
            self.assertEqual(result.stderr, "")
        checks = json.loads(result.stdout)["checks"]
        for check in checks:
            self.assertEqual(check["remedy"] is not None, check["verdict"] in ("warn", "fail"), check)
        return result.returncode, {f"{c['group']} {c['check']}": c for c in checks}

    def assert_only_fails(self, examined, *names):
        code, checks = examined
        self.assertEqual(code, 1)
        self.assertEqual({name for name, check in checks.items() if check["verdict"] == "fail"},
                         set(names), checks)

    def test_a_healthy_robot_is_one_screen_without_a_failure(self):
        file = self.settings()
        with Watch() as watch, Selectord("-c", file, "--warmup-frames", 3), Senders(now_us):
            watch.wait_for("status", lambda status: status["state"] in ("VALID", "UNSURE"))
            code, checks = self.examine("-c", file, seconds=3)
            screen = vdna("doctor", "-c", file)
        print(screen.stdout)
        self.assertEqual(code, 0, checks)
        for name in ("network route", "network channels", "network ttl", "camera frames",
                     "camera sender", "map files", "map network", "processor runtime",
                     "system settings", "system start", "system memory", "system access"):
            self.assertEqual(checks[name]["verdict"], "ok", checks[name])
        self.assertIn(checks["map daemon"]["verdict"], ("ok", "warn"), checks["map daemon"])
        self.assertIn("VDNA_STATUS vdna_msg.status_t", checks["network channels"]["found"])
        lines = screen.stdout.splitlines()
        self.assertEqual(sum(line[:4] in ("ok  ", "--  ", "warn") for line in lines), len(checks))
        self.assertLessEqual(len(checks), 22)
        for line in lines:
            self.assertTrue(len(line) <= 80 or max(map(len, line.split())) > 40, line)

    def test_without_a_daemon_and_frames_it_says_what_is_missing(self):
        examined = self.examine("-c", self.settings())
        self.assert_only_fails(examined, "camera frames")
        self.assertEqual(examined[1]["map daemon"]["verdict"], "unknown")
        self.assertEqual(examined[1]["camera stamps"]["verdict"], "unknown")

    def test_a_missing_route_is_told_with_the_command_that_adds_it(self):
        subprocess.run(["ip", "route", "del", "224.0.0.0/4"], check=True)
        examined = self.examine("-c", self.settings(), says_nothing_else=False)  # LCM complains, too
        self.assert_only_fails(examined, "network route", "network channels")
        command = examined[1]["network route"]["remedy"].replace("sudo ", "")
        subprocess.run(command, shell=True, check=True)
        self.assertEqual(self.examine("-c", self.settings())[1]["network route"]["verdict"], "ok")

    def test_pictures_on_another_channel_are_found(self):
        file = self.settings("[lcm]\ncamera = 'CAMERA_FRONT'\n")
        with Senders(now_us):
            code, checks = self.examine("-c", file)
        self.assertEqual(code, 1)
        self.assertIn('set camera = "CAMERA"', checks["camera frames"]["remedy"])

    def test_stamps_that_do_not_move_fail(self):
        with Senders(lambda _: 7):
            self.assert_only_fails(self.examine("-c", self.settings()), "camera stamps")

    def test_stamps_in_milliseconds_are_a_warning(self):
        with Senders(lambda number: now_us(number) // 1000):
            code, checks = self.examine("-c", self.settings(), seconds=2)
        self.assertEqual((code, checks["camera stamps"]["verdict"]), (0, "warn"), checks)
        self.assertIn("milliseconds", checks["camera stamps"]["found"])

    def test_two_senders_fail(self):
        with Senders(now_us, now_us):
            _, checks = self.examine("-c", self.settings())
        self.assertEqual(checks["camera sender"]["verdict"], "fail", checks)

    def test_a_map_that_cannot_be_read_fails(self):
        secret = os.path.join(WORK, "secret")
        shutil.copytree(MAP, secret)
        os.chmod(secret, 0)
        try:
            _, checks = self.examine("-c", self.settings(), "--map", secret, prefix=WITHOUT_PRIVILEGES)
        finally:
            os.chmod(secret, 0o700)
        for name in ("map files", "system access", "system start"):
            self.assertEqual(checks[name]["verdict"], "fail", checks[name])
        self.assertIn("chmod", checks["system access"]["remedy"])

    def test_a_damaged_experience_is_named(self):
        damaged = os.path.join(WORK, "damaged")
        shutil.copytree(MAP, damaged)
        with open(os.path.join(damaged, "winter.vdna"), "r+b") as file:
            file.truncate(1000)
        _, checks = self.examine("-c", self.settings(), "--map", damaged)
        self.assertEqual(checks["map files"]["verdict"], "warn", checks["map files"])
        self.assertIn("winter.vdna", checks["map files"]["found"])

    def test_a_network_that_did_not_make_the_map_fails(self):
        file = self.configure(f"[map]\ndirectory = '{MAP}'\n")  # the default network
        _, checks = self.examine("-c", file)
        self.assertEqual(checks["map network"]["verdict"], "fail", checks["map network"])
        self.assertIn("does not compare", checks["map network"]["found"])
        self.assertEqual(checks["system start"]["verdict"], "fail")

    def test_a_daemon_with_another_map_fails(self):
        changed = os.path.join(WORK, "changed")
        shutil.copytree(MAP, changed)
        with Watch() as watch, Selectord("-c", self.settings(), "--map", changed):
            watch.wait_for("status")
            os.unlink(os.path.join(changed, "winter.vdna"))
            _, checks = self.examine("-c", self.settings(), "--map", changed, seconds=3)
        self.assertEqual(checks["map daemon"]["verdict"], "fail", checks["map daemon"])
        self.assertIn("another map", checks["map daemon"]["found"])

    def test_a_limit_of_locked_memory_fails(self):
        file = self.settings("[memory]\nlock = true\n")
        prefix = ["prlimit", "--memlock=65536:65536", *WITHOUT_PRIVILEGES]
        with Senders(now_us):
            self.assert_only_fails(self.examine("-c", file, prefix=prefix), "system lock")

    def test_settings_that_the_daemon_refuses_fail(self):
        file = self.settings("[select]\ntops = 3\n")
        _, checks = self.examine("-c", file)
        self.assertEqual(checks["system settings"]["verdict"], "fail")
        self.assertIn("tops", checks["system settings"]["found"])
        self.assertEqual(checks["system start"]["verdict"], "unknown")

    def test_wrong_usage_is_exit_code_2(self):
        self.assertEqual(vdna("doctor", "--for", "x", check=False).returncode, 2)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
