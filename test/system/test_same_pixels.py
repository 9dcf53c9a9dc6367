"""One drive as a folder of pictures, as a log of camera messages and live over LCM gives the same
Visual DNA, bit for bit, for every kind of picture file.

The network is that of test/support, whose activations are the pixels themselves: its neurons are
the left and the right half of a picture, so a rotated picture would give other activations.
"""
import contextlib
import hashlib
import os
import shutil
import signal
import struct
import subprocess
import time
import zlib

import own_network
from selectord import (PATIENCE, Selectord, Watch, WithConfiguration, vdna, vdna_json)

WORK = os.path.abspath("same_pixels")
MAP = os.path.join(WORK, "map")
NETWORK = os.path.join(WORK, "tiny.toml")
CONDITIONS = ["summer", "winter", "night"]
KINDS = ["jpg", "png", "tiff", "webp"]
FRAMES = 12
SIZE = "160x110"  # fits one datagram as BGR pixels
RATES = (20, 5, 2)  # Hz

MANIFEST = """name = "tiny"
model = "tiny_network.onnx"
sha256 = "{sha256}"
source = "test/support"
licence = "MIT"

[input]
name = "image"
width = 2
height = 2
colour = "RGB"
mean = [0, 0, 0]
std = [1, 1, 1]
resize = "stretch"
interpolation = "area"

[[taps]]
output = "map"
layout = "samples_neurons"

[embedding]
output = "mean"
l2_normalise = false
"""

# EXIF that says "turn by 90 degrees".
TURNED = (b"MM\0*\0\0\0\x08\0\x01" + struct.pack(">HHIHH", 0x112, 3, 1, 6, 0) + b"\0\0\0\0")


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, data):
    with open(path, "wb") as file:
        file.write(data)


def write_network():
    model = os.environ["VDNA_TINY_NETWORK"]
    shutil.copy(model, WORK)
    write(NETWORK, MANIFEST.format(sha256=hashlib.sha256(read(model)).hexdigest()).encode())


def with_exif(kind, data):
    """A picture file with an EXIF rotation, if the kind supports EXIF."""
    if kind == "jpg":
        segment = b"Exif\0\0" + TURNED
        return data[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + data[2:]
    if kind == "png":
        chunk = b"eXIf" + TURNED
        head = 33  # the signature and IHDR
        return (data[:head] + struct.pack(">I", len(TURNED)) + chunk +
                struct.pack(">I", zlib.crc32(chunk)) + data[head:])
    return data


def folder_of(kind):
    return os.path.join(WORK, kind, "live")


def convert(drive, kind):
    """Convert a drive's JPEG pictures to files of a kind. Labels give their times, so that these do
    not depend on the rate at which they are played."""
    folder = folder_of(kind)
    os.makedirs(folder)
    labels = ["file,utime"]
    for name in sorted(name for name in os.listdir(drive) if name.endswith(".jpg")):
        picture = os.path.join(folder, name.replace(".jpg", f".{kind}"))
        subprocess.run([os.environ["VDNA_TRANSCODE"], os.path.join(drive, name), picture],
                       check=True)
        write(picture, with_exif(kind, read(picture)))
        labels.append(f"{os.path.basename(picture)},{1000000 + 100000 * len(labels)}")
    write(os.path.join(folder, "labels.csv"), "\n".join(labels + [""]).encode())


def prepare():
    """Three traversals as a map, and another drive as pictures of each kind."""
    if os.path.exists(MAP):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    os.mkdir(WORK)
    write_network()
    drives = [os.path.join(WORK, condition) for condition in CONDITIONS]
    options = ("--frames", FRAMES, "--size", SIZE)
    for drive, condition in zip(drives, CONDITIONS):
        vdna("simulate", drive, "--condition", condition, *options)
    drive = os.path.join(WORK, "drive")
    vdna("simulate", drive, "--condition", "winter", "--drive", 7, "--variation", 0.5, *options)
    for kind in KINDS:
        convert(drive, kind)
    vdna("build", MAP, "--backbone", NETWORK, *drives)


def build(kind, source):
    """The bytes of the experience file built from a source."""
    folder = os.path.join(WORK, kind, "built")
    vdna("build", folder, "--backbone", NETWORK, "--name", "live", "--force", "--ranges",
         os.path.join(MAP, "summer.vdna"), source)
    return read(os.path.join(folder, "live.vdna"))


def distances(ranking):
    """Experiences and distances in bins, from a message or the result of `vdna rank`."""
    return [(entry["experience"], entry["distance_bins"]) for entry in ranking]


@contextlib.contextmanager
def logger(path):
    """lcm-logger, which records the camera's channel; it listens once this is entered."""
    with contextlib.suppress(FileNotFoundError):
        os.unlink(path)
    # By its path: the lcm-logger of `pip install lcm` is a script, which leaves its child behind.
    process = subprocess.Popen([os.environ["VDNA_LCM_LOGGER"], "--channel=CAMERA", "--force", path],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + PATIENCE
        while not joins_multicast(process.pid) and time.monotonic() < deadline:
            time.sleep(0.02)
        yield
        process.send_signal(signal.SIGINT)
        process.wait(PATIENCE)
    finally:
        process.kill()
        process.wait()


def joins_multicast(pid):
    """True if a process has a UDP socket at LCM's port."""
    with open("/proc/net/udp", encoding="ascii") as file:
        sockets = {line.split()[9] for line in file if ":1DF3 " in line}  # 7667
    try:
        files = [os.readlink(f"/proc/{pid}/fd/{name}") for name in os.listdir(f"/proc/{pid}/fd")]
    except FileNotFoundError:
        return False
    return any(f"socket:[{inode}]" in files for inode in sockets)


class SamePixels(WithConfiguration):

    work = WORK

    def play(self, kind, log):
        """The ranking of a fresh daemon for a folder that is played to it and logged."""
        for rate in RATES:
            with Watch() as watch, Selectord("--map", MAP, "--backbone", NETWORK,
                                             "--warmup-frames", FRAMES), logger(log):
                vdna("play", folder_of(kind), "--rate", rate, "--stamp", "recorded")
                status = watch.wait_for("status", lambda said: said["received"] >= FRAMES)
            if status["skipped"] == 0:
                self.assertEqual((status["refused"], status["rejected"]), (0, 0))
                return watch.of("ranking")[0]["ranking"]
        raise AssertionError(f"frames were skipped even at {RATES[-1]} Hz")

    def check(self, kind):
        folder, log = folder_of(kind), os.path.join(WORK, f"{kind}.lcm")
        live = self.play(kind, log)
        from_folder = build(kind, folder)
        self.assertEqual(build(kind, log), from_folder)
        rank = lambda source: distances(
            vdna_json("rank", source, MAP, "--warmup", FRAMES, "--backbone", NETWORK)["ranking"])
        self.assertEqual(rank(log), rank(folder))
        self.assertEqual(distances(live), rank(folder))
        self.assertEqual(live[0]["experience"], "winter")
        return from_folder

    def test_jpeg(self):
        self.check("jpg")

    def test_png(self):
        self.check("png")

    def test_tiff(self):
        self.check("tiff")

    def test_webp(self):
        self.check("webp")

    def test_files_without_loss_are_the_same_pictures(self):
        self.assertEqual(build("png", folder_of("png")), build("tiff", folder_of("tiff")))


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
