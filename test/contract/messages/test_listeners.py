"""The listeners of SPEC-lcm, word for word, print what vdna_selectord says: the real daemon, with a
backbone that needs no network.

Environment: VDNA_BIN, VDNA_LCM_GEN, VDNA_STUB_MAP, VDNA_STUB_BACKBONE, VDNA_WORK.
"""
import os
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

import own_network
import spec_lcm
from ends_with_us import ENDS_WITH_US
from selectord import PATIENCE, Camera, Selectord, Watch
from tools import fresh, virtual_environment

WORK = Path(os.environ["VDNA_WORK"]) / "listeners"
ENVIRONMENT = WORK.parent / "environment"
MAP = WORK / "map"
LANGUAGES = ("Python", "C++", "Java")
WARMUP, FRAMES = 3, 8


def heading_of(language):
    return f"A listener in {language}"


def environment_of(language):
    """The lcm-gen that the section means is the first on the path."""
    of_debian = Path(os.environ["VDNA_LCM_GEN"]).parent
    return spec_lcm.with_path(ENVIRONMENT / "bin" if language == "Python" else of_debian)


def has_tools(language):
    return language != "Java" or (shutil.which("javac") and spec_lcm.LCM_JAR.exists())


def build(language):
    """Make the listener as the page says, up to the last command, which runs it."""
    folder = spec_lcm.in_a_checkout(fresh(WORK / language))
    name, text = spec_lcm.program(heading_of(language))
    (folder / name).write_text(text, encoding="utf-8")
    if language == "Java":
        spec_lcm.build_jar(folder, environment_of(language))
    for block in spec_lcm.commands(heading_of(language))[:-1]:
        spec_lcm.shell(block, folder, environment_of(language))


def prepare():
    fresh(WORK)
    subprocess.run([os.environ["VDNA_STUB_MAP"], MAP], check=True)
    virtual_environment(ENVIRONMENT, "lcm==1.5.3")
    for language in filter(has_tools, LANGUAGES):
        build(language)


def listening():
    """How many sockets of this namespace have the port of LCM's network."""
    lines = [line for table in ("udp", "udp6")
             for line in Path(f"/proc/net/{table}").read_text(encoding="ascii").splitlines()]
    return sum(line.split()[1].endswith(f":{Camera.ADDRESS[1]:04X}") for line in lines)


class Listening:
    """The last command of a section, at work; the constructor returns once it listens."""

    def __init__(self, language):
        before = listening()
        block = spec_lcm.commands(heading_of(language))[-1]
        # Lines must come through the pipe at once, whatever the language.
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, "stdbuf", "-oL", "sh", "-euc", block], cwd=WORK / language,
            env={**environment_of(language), "PYTHONUNBUFFERED": "1"}, stdout=subprocess.PIPE,
            text=True, start_new_session=True)
        deadline = time.monotonic() + PATIENCE
        while listening() == before and time.monotonic() < deadline:
            time.sleep(0.1)
        time.sleep(1)  # it has a socket, and subscribes next

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.stdout.close()
        self._process.wait()

    def lines(self, count):
        """Its first lines; fewer if it ends."""
        return [self._process.stdout.readline().rstrip("\n") for _ in range(count)]


def lines_of(message):
    """What a listener prints for a message, as `vdna watch` has it."""
    if message["type"] == "ranking":
        return [f"{entry['distance_bins']:8.2f} bins  {entry['experience']}"
                for entry in message["ranking"]]
    if message["type"] == "localisation" and message["validity"] == "VALID":
        return [f"{message['utime']}: {message['experience']} frame {message['frame']}"]
    return []


class Listeners(unittest.TestCase):

    def hears_the_daemon(self, language):
        if not has_tools(language):
            self.skipTest("no javac or no liblcm-java")
        sure = WORK / "sure.toml"
        sure.write_text("[localise]\nmin_confidence = 0\n", encoding="ascii")
        signal.alarm(3 * PATIENCE)  # or a listener that says too little would stop us for good
        with Listening(language) as listener, Watch() as watch, Camera() as camera, \
                Selectord("-c", sure, "--map", MAP, "--warmup-frames", WARMUP,
                          "--backbone", os.environ["VDNA_STUB_BACKBONE"]):
            for utime in range(FRAMES):
                camera.send_jpeg(utime, b"picture")
                watch.wait_for("localisation")
            expected = [line for message in watch.messages for line in lines_of(message)]
            self.assertEqual(len(expected), 2 + FRAMES - WARMUP)
            self.assertEqual(listener.lines(len(expected)), expected)

    def test_the_one_in_python_hears_what_the_daemon_says(self):
        self.hears_the_daemon("Python")

    def test_the_one_in_cpp_hears_what_the_daemon_says(self):
        self.hears_the_daemon("C++")

    def test_the_one_in_java_hears_what_the_daemon_says(self):
        self.hears_the_daemon("Java")


if __name__ == "__main__":
    if not has_tools("Java"):
        print("skipped: no javac, no liblcm-java; ./dev test --all installs them")
    own_network.run_tests_apart(prepare)
