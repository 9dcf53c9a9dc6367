"""vdna camera from outside: a V4L2 camera, a stream and a video, received over real LCM.

The V4L2 camera is played by played_camera.c and, where the kernel has one, by v4l2loopback.
"""
import contextlib
import fcntl
import glob
import http.server
import os
import shutil
import signal
import struct
import subprocess
import threading
import time
import unittest

import own_network
from ends_with_us import ENDS_WITH_US
from selectord import BIN, PATIENCE, Listener, vdna, vdna_json

WORK = os.path.abspath("camera")
PICTURES = os.path.join(WORK, "pictures")  # 0.jpg, 1.jpg, ...
FRAMES = 8
WIDTH, HEIGHT = 96, 64  # fits one datagram as BGR pixels
BLUE = os.path.join(WORK, "blue.jpg")
MJPG, BGR3, YUYV = (int.from_bytes(name, "little") for name in (b"MJPG", b"BGR3", b"YUYV"))


def read(path):
    with open(path, "rb") as file:
        return file.read()


def prepare():
    """Pictures of a drive under the names that the played camera expects, and one in plain blue."""
    if os.path.exists(BLUE):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    drive = os.path.join(WORK, "drive")
    vdna("simulate", drive, "--frames", FRAMES, "--size", f"{WIDTH}x{HEIGHT}")
    os.mkdir(PICTURES)
    for number, name in enumerate(sorted(n for n in os.listdir(drive) if n.endswith(".jpg"))):
        shutil.copy(os.path.join(drive, name), os.path.join(PICTURES, f"{number}.jpg"))
    pixels = os.path.join(WORK, "blue.ppm")
    with open(pixels, "wb") as file:
        file.write(b"P6 %d %d 255\n" % (WIDTH, HEIGHT) + b"\x10\x20\xf0" * (WIDTH * HEIGHT))
    subprocess.run([os.environ["VDNA_TRANSCODE"], pixels, BLUE], check=True)


def pictures():
    return [read(os.path.join(PICTURES, f"{number}.jpg")) for number in range(FRAMES)]


class Image:
    """A bot_core.image_t, from its bytes."""

    def __init__(self, message):
        (self.fingerprint, self.utime, self.width, self.height, self.row_stride, self.pixelformat,
         size) = struct.unpack_from(">QqiiiIi", message)
        self.data = message[36:36 + size]


class CameraProgram:
    """A running `vdna camera`."""

    def __init__(self, *arguments, environment=None):
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, os.path.join(BIN, "vdna"), "camera", *map(str, arguments)],
            env={**os.environ, **(environment or {})},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.communicate()

    def interrupt(self):
        self._process.send_signal(signal.SIGINT)

    def end(self):
        """Wait for its end; exit code, standard output and error."""
        output, errors = self._process.communicate(timeout=PATIENCE)
        return self._process.returncode, output, errors


def played(**variables):
    """The environment in which /dev/video9 is a camera."""
    return {"LD_PRELOAD": os.environ["VDNA_PLAYED_CAMERA"], "VDNA_PLAYED_FOLDER": PICTURES,
            "ASAN_OPTIONS": "verify_asan_link_order=0", **variables}


def without_huffman_tables(jpeg):
    """A JPEG as many cameras send it: without its Huffman tables, which are the standard ones."""
    at, kept = 2, [jpeg[:2]]
    while jpeg[at + 1] != 0xDA:
        length = 2 + int.from_bytes(jpeg[at + 2:at + 4], "big")
        if jpeg[at + 1] != 0xC4:
            kept.append(jpeg[at:at + length])
        at += length
    return b"".join(kept) + jpeg[at:]


class MjpegServer(http.server.ThreadingHTTPServer):
    """Sends pictures as a network camera does; `then` is what it does after them."""

    def __init__(self, jpegs, rate_hz, then=lambda: None):
        self.jpegs, self.rate_hz, self.then = jpegs, rate_hz, then
        self.requests = 0
        super().__init__(("127.0.0.1", 0), self.Handler)
        self.url = f"http://127.0.0.1:{self.server_address[1]}/video.mjpg"
        threading.Thread(target=self.serve_forever, daemon=True).start()

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.server.requests += 1
            self.send_response(200)
            self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=picture")
            self.end_headers()
            with contextlib.suppress(ConnectionError):
                for jpeg in self.server.jpegs:
                    self.wfile.write(b"--picture\r\nContent-Type: image/jpeg\r\n"
                                     b"Content-Length: %d\r\n\r\n" % len(jpeg) + jpeg + b"\r\n")
                    time.sleep(1 / self.server.rate_hz)
                self.server.then()

        def log_message(self, *_):
            pass


class PlayedCamera(unittest.TestCase):
    """A V4L2 camera that the test plays."""

    def test_its_pictures_arrive_untouched_and_stamped_with_the_time_of_day(self):
        begin = time.time()
        with Listener("FRONT") as subscriber, \
                CameraProgram("/dev/video9", "--channel", "FRONT", "--frames", 10,
                              environment=played()) as program:
            images = [Image(subscriber.next()) for _ in range(10)]
            code, output, errors = program.end()
        self.assertEqual([image.data for image in images], (pictures() * 2)[:10])
        self.assertEqual({image.pixelformat for image in images}, {MJPG})
        stamps = [image.utime / 1e6 for image in images]
        self.assertEqual(stamps, sorted(set(stamps)))
        self.assertTrue(begin <= stamps[0] and stamps[-1] <= time.time())
        self.assertEqual(code, 0, errors)
        self.assertEqual(output, "sent 10 frames on FRONT; 2 dropped by the driver, 0 damaged and "
                                 "left out\n")
        self.assertIn("Played Camera: ", errors)

    def test_ctrl_c_is_its_ordinary_end(self):
        with Listener("CAMERA") as subscriber, \
                CameraProgram("/dev/video9", environment=played()) as program:
            subscriber.next()
            program.interrupt()
            code, output, errors = program.end()
        self.assertEqual(code, 0, errors)
        self.assertIn("sent ", output)

    def test_an_unplugged_camera_is_an_error(self):
        with CameraProgram("/dev/video9",
                           environment=played(VDNA_PLAYED_FRAMES="5")) as program:
            code, output, errors = program.end()
        self.assertEqual(code, 1)
        self.assertIn("sent 5 frames on CAMERA; 1 dropped by the driver", output)
        self.assertIn("vdna: /dev/video9: the camera is gone; see to its plug and cable", errors)

    def test_an_unplugged_camera_can_be_waited_for(self):
        with CameraProgram("/dev/video9", "--reconnect", "--frames", 8,
                           environment=played(VDNA_PLAYED_FRAMES="5")) as program:
            code, output, errors = program.end()
        self.assertEqual(code, 0, errors)
        self.assertIn("sent 8 frames on CAMERA; 1 dropped by the driver", output)
        self.assertIn("the camera is gone; see to its plug and cable; trying again every 2 s", errors)

    def test_ctrl_c_ends_the_wait_for_a_camera(self):
        with CameraProgram("/dev/video99", "--reconnect") as program:
            time.sleep(5)  # it tries three times
            program.interrupt()
            code, output, errors = program.end()
        self.assertEqual((code, output), (0, "sent 0 frames on CAMERA; 0 dropped by the driver, 0 "
                                             "damaged and left out\n"), errors)
        self.assertEqual(errors.count("\n"), 1)
        self.assertIn("no such device", errors)

    def test_what_it_does_not_offer_is_refused(self):
        with CameraProgram("/dev/video9", "--format", "YUYV", environment=played()) as program:
            code, output, errors = program.end()
        self.assertEqual((code, output), (1, ""))
        self.assertIn("/dev/video9: offers MJPG, expected YUYV; choose another --format", errors)

    def test_pictures_without_huffman_tables_are_decoded(self):
        whole, stripped = os.path.join(WORK, "whole"), os.path.join(WORK, "stripped")
        for folder in (whole, stripped):
            shutil.rmtree(folder, ignore_errors=True)
            os.mkdir(folder)
        for number, jpeg in enumerate(pictures()):
            shorter = without_huffman_tables(jpeg)
            self.assertLess(len(shorter), len(jpeg) - 400)
            for folder, data in ((whole, jpeg), (stripped, shorter)):
                with open(os.path.join(folder, f"{number}.jpg"), "wb") as file:
                    file.write(data)
        shutil.rmtree(os.path.join(WORK, "map"), ignore_errors=True)
        vdna("build", os.path.join(WORK, "map"), whole)
        ranking = vdna_json("rank", stripped, os.path.join(WORK, "map"),
                            "--warmup", FRAMES)["ranking"]
        self.assertEqual(ranking[0]["distance_bins"], 0)


class NoCamera(unittest.TestCase):
    """Paths that are no camera."""

    def refusal(self, *arguments):
        result = vdna("camera", *arguments, check=False)
        self.assertEqual(result.stdout, "")
        return result.returncode, result.stderr

    def test_a_device_that_is_not_there_is_named(self):
        code, error = self.refusal("/dev/video99")
        self.assertEqual(code, 1)
        self.assertIn("/dev/video99: no such device", error)

    def test_another_device_is_not_taken_for_a_camera(self):
        code, error = self.refusal("/dev/null")
        self.assertEqual(code, 1)
        self.assertIn("/dev/null: not a camera, expected a V4L2 device such as /dev/video0", error)

    def test_settings_of_a_device_are_wrong_usage_elsewhere(self):
        code, error = self.refusal("http://127.0.0.1:1/", "--rate", 30)
        self.assertEqual(code, 2)
        self.assertIn("--size, --rate and --format cannot be set", error)
        for size in ("640", "640x", "640x480x2", "0x480", "99999x480", "x480", "640x-480"):
            code, error = self.refusal("/dev/video99", "--size", size)
            self.assertEqual(code, 2)
            self.assertIn("expected WIDTHxHEIGHT", error)
        for rate in ("0", "nan", "fast"):
            self.assertEqual(self.refusal("/dev/video99", "--rate", rate)[0], 2)

    def test_a_stream_that_nobody_sends_is_named_without_its_password(self):
        code, error = self.refusal("http://me:secret@127.0.0.1:1/video.mjpg")
        self.assertEqual(code, 1)
        self.assertIn("http://127.0.0.1:1/video.mjpg: no video is received", error)
        self.assertNotIn("secret", error)


class Stream(unittest.TestCase):
    """A network camera."""

    def test_its_pictures_arrive_decoded(self):
        begin = time.time()
        with MjpegServer([read(BLUE)] * 12, 20) as server, Listener("CAMERA") as subscriber, \
                CameraProgram(server.url, "--frames", 5) as program:
            images = [Image(subscriber.next()) for _ in range(5)]
            code, output, errors = program.end()
            server.shutdown()
        self.assertEqual((code, output), (0, "sent 5 frames on CAMERA\n"), errors)
        for image in images:
            self.assertEqual((image.width, image.height, image.pixelformat, len(image.data)),
                             (WIDTH, HEIGHT, BGR3, 3 * WIDTH * HEIGHT))
            self.assertTrue(begin <= image.utime / 1e6 <= time.time())
            for value, expected in zip(image.data[-3:], (0xf0, 0x20, 0x10)):
                self.assertAlmostEqual(value, expected, delta=8)

    def test_the_end_of_a_stream_is_an_error(self):
        with MjpegServer(pictures(), 20) as server, CameraProgram(server.url) as program:
            code, output, errors = program.end()
            server.shutdown()
        self.assertEqual(code, 1)
        self.assertRegex(output, r"sent \d+ frames on CAMERA\n")
        self.assertRegex(errors, r"the stream ended after \d+ frames; see to the camera, or set "
                                 "--reconnect")

    def test_a_stream_that_stalls_is_an_error(self):
        with MjpegServer(pictures(), 20, then=lambda: time.sleep(60)) as server, \
                CameraProgram(server.url) as program:
            code, _, errors = program.end()
            server.shutdown()
        self.assertEqual(code, 1)
        self.assertRegex(errors, r"no frame for 5 s after \d+ frames; see to the camera and the "
                                 "network, or set --reconnect")

    def test_a_stream_that_ended_can_be_waited_for(self):
        with MjpegServer(pictures(), 20) as server, \
                CameraProgram(server.url, "--reconnect", "--frames", FRAMES + 1) as program:
            code, output, errors = program.end()
            server.shutdown()
            self.assertGreaterEqual(server.requests, 2)
        self.assertEqual(code, 0, errors)
        self.assertEqual(output, f"sent {FRAMES + 1} frames on CAMERA\n")


class Recording(unittest.TestCase):
    """A recording in place of a camera."""

    def test_it_comes_at_its_own_pace_and_ends_well(self):
        begin = time.monotonic()
        result = vdna("camera", PICTURES)
        # Pictures without a time come ten a second.
        self.assertGreaterEqual(time.monotonic() - begin, (FRAMES - 1) / 10)
        self.assertEqual(result.stdout, f"sent {FRAMES} frames on CAMERA\n")


class Loopback(unittest.TestCase):
    """A camera of the kernel."""

    SET_FORMAT = 0xC0D05605  # VIDIOC_S_FMT, for 64-bit processors

    def test_its_pictures_arrive_raw(self):
        nodes = glob.glob("/sys/devices/virtual/video4linux/video*")
        if not nodes:
            print("skipped: no v4l2loopback; its kernel module makes a camera to try")
            self.skipTest("no v4l2loopback")
        device = "/dev/" + os.path.basename(nodes[0])
        picture = bytes(range(256)) * (2 * WIDTH * HEIGHT // 256)
        with open(device, "r+b", buffering=0) as node, Listener("CAMERA") as subscriber:
            wanted = struct.pack("I4x8I", 2, WIDTH, HEIGHT, YUYV, 1, 2 * WIDTH, len(picture), 8, 0)
            fcntl.ioctl(node, self.SET_FORMAT, bytearray(wanted.ljust(208, b"\0")))
            done = threading.Event()

            def play():
                while not done.wait(0.05):
                    node.write(picture)

            player = threading.Thread(target=play)
            player.start()
            try:
                with CameraProgram(device, "--format", "YUYV", "--frames", 3) as program:
                    image = Image(subscriber.next())
                    code, _, errors = program.end()
            finally:
                done.set()
                player.join()
        self.assertEqual(code, 0, errors)
        self.assertEqual((image.width, image.height, image.pixelformat), (WIDTH, HEIGHT, YUYV))
        self.assertEqual(image.data, picture)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
