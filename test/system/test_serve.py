"""System test of `vdna serve`: what it hears over real LCM, and what viewers get of it.

Environment: VDNA_BIN (folder of the programs).
"""
import os
import shutil
import signal
import subprocess
import time
import unittest

import own_network
from selectord import (BIN, PATIENCE, SANITIZED, Camera, Listener, Selectord, grey_message, localisation_message,
                       memory_of, vdna)
from served import Play, Serve, Viewer, make_drives

WORK = os.path.abspath("serve")
MAP = os.path.join(WORK, "map")
LIVE = os.path.join(WORK, "live")
RESIDENT_MAX = 32 << 20  # bytes
CPU_MAX = 0.05  # of a core, with ten viewers; an idle machine needs a fifth of it


def vdna_bytes(*arguments):
    """Standard output of vdna, which is no text."""
    return subprocess.run([os.path.join(BIN, "vdna"), *map(str, arguments)], check=True, stdout=subprocess.PIPE,
                          timeout=PATIENCE).stdout


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class TheServer(unittest.TestCase):
    def test_starts_without_a_daemon_and_ends_at_once(self):
        with Serve() as serve:
            viewer = Viewer(serve)
            self.assertIn("No daemon heard", viewer.wait_for("headline")["text"])
            self.assertIsNone(viewer.wait_for("pulse")["camera_age_s"])
            self.assertEqual(viewer.wait_for("commands")[0]["name"], "reset")
            code, seconds = serve.stop()
            self.assertEqual(code, 0)
            self.assertLess(seconds, 3)

    def test_tells_late_viewers_what_it_heard(self):
        with Serve() as serve, Camera("VDNA_LOCALISATION") as daemon:
            daemon.send(localisation_message(5))
            Viewer(serve).wait_for("localisation", lambda answer: answer["utime"] == 5)
            late = Viewer(serve)
            self.assertEqual(late.wait_for("localisation")["validity"], "WARMING_UP")
            daemon.send(localisation_message(6))
            late.wait_for("localisation", lambda answer: answer["utime"] == 6)

    def test_names_messages_that_it_does_not_understand(self):
        with Serve() as serve, Camera("VDNA_STATUS") as daemon:
            daemon.send(b"no status")
            viewer = Viewer(serve)
            self.assertIn("VDNA_STATUS", viewer.wait_for("pulse", lambda pulse: pulse["left_out"])["left_out"])

    def test_shows_jpegs_as_they_came_and_says_what_it_cannot_show(self):
        with open(os.path.join(LIVE, sorted(os.listdir(LIVE))[0]), "rb") as file:
            jpeg = file.read()
        with Serve() as serve, Camera() as camera:
            viewer = Viewer(serve)
            viewer.wait_for("pulse", lambda pulse: pulse["viewers"] == 1)
            camera.send_jpeg(1, jpeg)
            self.assertIsNone(viewer.wait_for("picture", lambda picture: picture["utime"] == 1)["problem"])
            self.assertEqual(serve.request("GET", "/picture"), (200, jpeg))
            time.sleep(0.3)  # pictures are shown four times a second
            camera.send_jpeg(2, b"no JPEG")
            self.assertTrue(viewer.wait_for("picture", lambda picture: picture["utime"] == 2)["problem"])
            self.assertEqual(serve.request("GET", "/picture")[0], 404)
            time.sleep(0.3)
            camera.send(grey_message(3, bytes(100 * 100)))
            viewer.wait_for("picture", lambda picture: picture["utime"] == 3)
            self.assertEqual(serve.request("GET", "/picture")[1][:3], b"\xff\xd8\xff")

    def test_sends_a_command_that_has_the_token_only(self):
        with Serve() as serve, Listener("VDNA_COMMAND") as commands:
            self.assertEqual(serve.request("POST", "/command", "reset", {"Origin": serve.origin})[0], 403)
            self.assertEqual(serve.press("reset"), 204)
            self.assertEqual(commands.next()[16:20], b"\0\0\0\x01")
            self.assertEqual(len(serve.token), 32)
        with Serve() as other:
            self.assertNotEqual(other.token, serve.token)

    def test_shows_thumbnails_of_its_map_only_and_of_the_newest_one(self):
        path = os.path.join(WORK, "changing")
        shutil.rmtree(path, ignore_errors=True)
        os.mkdir(path)
        for name in ("winter", "summer"):
            shutil.copy(os.path.join(MAP, name + ".vdna"), path)
        winter = vdna_bytes("show", path, "winter", 7, "-o", "-")
        with Serve("--map", path) as serve:
            self.assertTrue(Viewer(serve).wait_for("map")["shown"])
            status, jpeg = serve.request("GET", "/map/winter/7.jpg")
            self.assertEqual((status, jpeg[:3]), (200, b"\xff\xd8\xff"))
            self.assertLessEqual(len(jpeg), 4096)
            self.assertNotEqual(jpeg, serve.request("GET", "/map/summer/7.jpg")[1])
            self.assertEqual(winter[:4], b"\x89PNG")
            for wrong in ("winter/40.jpg", "winter/4294967296.jpg", "winter/-1.jpg", "winter/7.png", "night/7.jpg",
                          "winter.vdna/7.jpg", "../winter/7.jpg", "%2e%2e/winter/7.jpg", "winter/7.jpg/..", ""):
                self.assertEqual(serve.request("GET", "/map/" + wrong)[0], 404, wrong)
            shutil.copy(os.path.join(MAP, "night.vdna"), os.path.join(path, ".night"))
            os.rename(os.path.join(path, ".night"), os.path.join(path, "night.vdna"))
            deadline = time.monotonic() + PATIENCE
            while serve.request("GET", "/map/night/7.jpg")[0] != 200:
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.1)
        with Serve() as serve:
            self.assertFalse(Viewer(serve).wait_for("map")["shown"])
            self.assertEqual(serve.request("GET", "/map/winter/7.jpg")[0], 404)
        self.assertEqual(vdna("serve", "--port", 0, "--map", WORK, check=False).returncode, 1)

    def test_refuses_a_port_in_use_and_a_log(self):
        with Serve() as serve:
            second = vdna("serve", "--port", serve.port, check=False)
            self.assertEqual(second.returncode, 1)
            self.assertIn("--port", second.stderr)
        self.assertEqual(vdna("serve", "-l", "file://drive.log", check=False).returncode, 2)
        self.assertIn("--address", vdna("serve", "--help").stdout)


class ADaemon(unittest.TestCase):
    def test_is_followed_through_choice_reset_death_and_return(self):
        with Serve() as serve:
            viewer = Viewer(serve)
            with Selectord("--map", MAP, "--warmup-frames", 12), Play(LIVE, 10):
                ranking = viewer.wait_for("ranking")
                self.assertEqual(ranking["ranking"][0]["experience"], "winter")
                viewer.wait_for("headline", lambda line: line["text"].startswith("Localising in winter, because"))
                point = viewer.wait_for("point", lambda point: point["experience"] == "winter")
                self.assertGreater(point["confidence"], 0)
                self.assertEqual(serve.press("reset"), 204)
                viewer.wait_for("ranking", lambda newer: newer["utime"] > ranking["utime"])
            viewer.wait_for("headline", lambda line: line["tone"] == "bad" and "No daemon heard" in line["text"])
            late = Viewer(serve)
            self.assertEqual(late.wait_for("ranking")["ranking"][0]["experience"], "winter")
            with Selectord("--map", MAP, "--warmup-frames", 12):
                viewer.wait_for("ranking", lambda ranking: ranking is None)  # its predecessor's
                viewer.wait_for("headline", lambda line: line["text"].startswith("Warming up"))

    def test_takes_commands_about_the_choice_and_tells_what_became_of_them(self):
        with Serve() as serve, Selectord("--map", MAP, "--warmup-frames", 12), Play(LIVE, 10):
            viewer = Viewer(serve)
            viewer.wait_for("ranking")
            self.assertEqual(serve.press("pin night"), 204)
            self.assertTrue(viewer.wait_for("result")["accepted"])
            viewer.wait_for("status", lambda status: status["pinned"] == "night")
            viewer.wait_for("headline", lambda line: "night" in line["text"])
            self.assertEqual(serve.press("exclude night"), 204)
            refused = viewer.wait_for("result", lambda result: not result["accepted"])
            self.assertIn("unpin it first", refused["text"])
            self.assertEqual(serve.press("pin "), 204)
            viewer.wait_for("status", lambda status: status["pinned"] == "")

    def test_shows_the_one_that_answers_of_two(self):
        with Serve() as serve, Selectord("--map", MAP) as first:
            viewer = Viewer(serve)
            instance = viewer.wait_for("status")["instance"]
            with Selectord("--map", MAP):
                for _ in range(4):  # seconds; each of the two says something in each of them
                    pulse = viewer.newest.get("pulse")
                    viewer.wait_for("pulse", lambda newer, older=pulse: newer != older)
                    self.assertEqual(viewer.newest["status"]["instance"], instance)
                first.stop(signal.SIGKILL)
                other = viewer.wait_for("status", lambda status: status["instance"] != instance)
                self.assertNotEqual(other["serving_utime"], 0)

    def test_costs_little_beside_ten_viewers(self):
        with Serve() as serve, Selectord("--map", MAP, "--warmup-frames", 12), Play(LIVE, 10):
            viewers = [Viewer(serve) for _ in range(10)]
            viewers[-1].wait_for("ranking")
            begin, used = time.monotonic(), cpu_seconds(serve.pid)
            for _ in range(8):
                shown = viewers[0].newest.get("picture")
                viewers[0].wait_for("picture", lambda picture: picture != shown)
                for _ in viewers:
                    serve.request("GET", "/picture")
            share = (cpu_seconds(serve.pid) - used) / (time.monotonic() - begin)
            resident = memory_of(serve.pid)["VmHWM"]
        print(f"ten viewers: {100 * share:.1f} % of a core, {resident / 2**20:.1f} MiB")
        self.assertLess(share, CPU_MAX)
        if not SANITIZED:  # which keeps what is freed
            self.assertLess(resident, RESIDENT_MAX)


if __name__ == "__main__":
    own_network.run_tests_apart(lambda: make_drives(WORK))
