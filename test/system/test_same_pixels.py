"""One drive as a folder of pictures, as a log of camera messages and live over LCM gives the same
Visual DNA, bit for bit, for every kind of picture file: turned by EXIF, of 16 bits, transparent, with
a palette.

The network is that of test/support, whose activations are the pixels themselves: its neurons are
the left and the right half of a picture, so a rotated picture would give other activations.
"""
import functools
import json
import os
import shutil
import struct
import subprocess
import zlib

import own_network
from selectord import Selectord, Watch, WithConfiguration, logger, vdna, vdna_json
from tiny_network import write_tiny_network

WORK = os.path.abspath("same_pixels")
MAP = os.path.join(WORK, "map")
NETWORK = os.path.join(WORK, "tiny.toml")
CONDITIONS = ["summer", "winter", "night"]
KINDS = ["jpg", "png", "tiff", "webp"]
ORIENTATION = 0x112  # EXIF's tag
FRAMES = 12
SIZE = "160x110"  # fits one datagram as BGR pixels
RATES = (20, 5, 2)  # Hz


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, data):
    with open(path, "wb") as file:
        file.write(data)


def exif(orientation):
    """A block that states an orientation."""
    return (b"MM\0*\0\0\0\x08\0\x01" + struct.pack(">HHIHH", ORIENTATION, 3, 1, orientation, 0) +
            b"\0\0\0\0")


def png_chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def jpeg_saying(data, orientation):
    segment = b"Exif\0\0" + exif(orientation)
    return data[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + data[2:]


def png_saying(data, orientation):
    head = 33  # the signature and IHDR
    return data[:head] + png_chunk(b"eXIf", exif(orientation)) + data[head:]


def webp_saying(data, orientation):
    """A simple WebP file, lossless as OpenCV writes it, becomes one with room for EXIF."""
    bits, = struct.unpack("<I", data[21:25])  # width and height, each less 1
    block = exif(orientation)
    sides = struct.pack("<I", bits & 0x3fff)[:3] + struct.pack("<I", bits >> 14 & 0x3fff)[:3]
    body = (b"WEBPVP8X" + struct.pack("<II", 10, 8) + sides + data[12:] +
            b"EXIF" + struct.pack("<I", len(block)) + block)
    return b"RIFF" + struct.pack("<I", len(body)) + body


def tiff_saying(data, orientation):
    """The directory, little-endian as OpenCV writes it, moves to the end and gets one more entry."""
    old, = struct.unpack("<I", data[4:8])
    count, = struct.unpack("<H", data[old:old + 2])
    entries = [data[old + 2 + 12 * i:old + 14 + 12 * i] for i in range(count)]
    entries.append(struct.pack("<HHIHH", ORIENTATION, 3, 1, orientation, 0))
    entries.sort(key=lambda entry: struct.unpack("<H", entry[:2]))
    data += b"\0" * (len(data) % 2)
    return (data[:4] + struct.pack("<I", len(data)) + data[8:] +
            struct.pack("<H", len(entries)) + b"".join(entries) + b"\0\0\0\0")


SAYING = {"jpg": jpeg_saying, "png": png_saying, "webp": webp_saying, "tiff": tiff_saying}


def ppm_pixels(path):
    """Width, height and bytes of a binary PPM picture."""
    _, width, height, _, pixels = read(path).split(maxsplit=4)
    return int(width), int(height), pixels


def palette_png(path, width, height, indices):
    """Writes a PNG picture with a palette of 6 levels a channel."""
    levels = range(0, 256, 51)
    colours = bytes(level for r in levels for g in levels for b in levels for level in (r, g, b))
    rows = b"".join(b"\0" + indices[y * width:(y + 1) * width] for y in range(height))
    write(path, b"\x89PNG\r\n\x1a\n" +
          png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)) +
          png_chunk(b"PLTE", colours) + png_chunk(b"tRNS", bytes(range(216))) +
          png_chunk(b"IDAT", zlib.compress(rows)) + png_chunk(b"IEND", b""))


def folder_of(kind):
    return os.path.join(WORK, kind, "live")


def transcode(source, target, *change):
    subprocess.run([os.environ["VDNA_TRANSCODE"], source, target, *change], check=True)


def turned(kind, i, source, folder):
    """A picture that EXIF turns; all eight orientations occur in a drive."""
    path = os.path.join(folder, f"{i:06}.{kind}")
    orientation = i % 8 + 1
    transcode(source, path, f"stored-{orientation}")
    write(path, SAYING[kind](read(path), orientation))
    return path


def changed(endings, *change):
    """Makes pictures with a change, whose kinds alternate."""
    def make(i, source, folder):
        path = os.path.join(folder, f"{i:06}.{endings[i % len(endings)]}")
        transcode(source, path, *change)
        return path
    return make


def quantised(ending):
    """Makes pictures with few colours: PNG has them as a palette."""
    def make(i, source, folder):
        path = os.path.join(folder, f"{i:06}.{ending}")
        whole = os.path.join(WORK, "whole.ppm")
        transcode(source, whole)
        width, height, pixels = ppm_pixels(whole)
        steps = bytes((value + 25) // 51 for value in pixels)
        if ending == "ppm":
            write(path, b"P6\n%d %d\n5\n" % (width, height) + steps)
        else:
            palette_png(path, width, height,
                        bytes(36 * steps[at] + 6 * steps[at + 1] + steps[at + 2]
                              for at in range(0, len(steps), 3)))
        return path
    return make


def mixed(i, source, folder):
    makers = (changed(["png"], "grey16"), changed(["pgm"], "grey16"), changed(["tiff"], "grey16"),
              changed(["png"], "alpha"), quantised("png"))
    return makers[i % len(makers)](i, source, folder)


FOLDERS = {kind: functools.partial(turned, kind) for kind in KINDS}
FOLDERS.update({
    "plain": changed(["png"]),
    "alpha": changed(["png", "tiff"], "alpha"),
    "grey": changed(["png", "pgm", "tiff"], "grey"),
    "grey16": changed(["png", "pgm", "tiff"], "grey16"),
    "palette": quantised("png"),
    "colours": quantised("ppm"),
    "mixed": mixed,
})


def convert(sources, name):
    """Make a folder of a drive's pictures. Labels give their times, so that these do not depend on the
    rate at which they are played."""
    folder = folder_of(name)
    os.makedirs(folder)
    labels = ["file,utime"]
    for i, source in enumerate(sources):
        path = FOLDERS[name](i, source, folder)
        labels.append(f"{os.path.basename(path)},{1000000 + 100000 * len(labels)}")
    write(os.path.join(folder, "labels.csv"), "\n".join(labels + [""]).encode())


def prepare():
    """Three traversals as a map, and another drive as pictures of each kind."""
    if os.path.exists(MAP):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    os.mkdir(WORK)
    write_tiny_network(WORK, ("map", "samples_neurons"))
    drives = [os.path.join(WORK, condition) for condition in CONDITIONS]
    options = ("--frames", FRAMES, "--size", SIZE)
    for drive, condition in zip(drives, CONDITIONS):
        vdna("simulate", drive, "--condition", condition, *options)
    drive = os.path.join(WORK, "drive")
    vdna("simulate", drive, "--condition", "winter", "--drive", 7, "--variation", 0.5, *options)
    sources = [os.path.join(drive, name) for name in sorted(os.listdir(drive))
               if name.endswith(".jpg")]
    for name in FOLDERS:
        convert(sources, name)
    vdna("build", MAP, "--backbone", NETWORK, *drives)


def build(kind, source):
    """Metadata and tensors of the experience file built from a source, but for the source's name and
    what ordered the frames, which differ, and the checksum."""
    folder = os.path.join(WORK, kind, "built")
    vdna("build", folder, "--backbone", NETWORK, "--name", "live", "--force", "--ranges",
         os.path.join(MAP, "summer.vdna"), source)
    data = read(os.path.join(folder, "live.vdna"))
    begin = 8 + struct.unpack_from("<Q", data)[0]
    header = json.loads(data[8:begin])
    metadata = header.pop("__metadata__")
    for differing in ("order", "source"):
        metadata.pop(differing)
    header.pop("crc32c")
    return metadata, {name: data[begin + tensor["data_offsets"][0]:begin + tensor["data_offsets"][1]]
                      for name, tensor in header.items()}


def distances(ranking):
    """Experiences and distances in bins, from a message or the result of `vdna rank`."""
    return [(entry["experience"], entry["distance_bins"]) for entry in ranking]


def frames_in(log):
    """Events that lcm-logger wrote: it may miss some on a busy machine."""
    return read(log).count(b"\xed\xa1\xda\x01")


class SamePixels(WithConfiguration):

    work = WORK

    def play(self, kind, log):
        """The ranking of a fresh daemon for a folder that is played to it and logged."""
        for rate in RATES:
            with Watch() as watch, Selectord("--map", MAP, "--backbone", NETWORK,
                                             "--warmup-frames", FRAMES), logger(log):
                vdna("play", folder_of(kind), "--rate", rate, "--stamp", "recorded")
                status = watch.wait_for("status", lambda said: said["received"] >= FRAMES)
            if status["skipped"] == 0 and frames_in(log) == FRAMES:
                self.assertEqual((status["refused"], status["rejected"]), (0, 0))
                return watch.of("ranking")[0]["ranking"]
        raise AssertionError(f"frames were skipped or not logged even at {RATES[-1]} Hz")

    def check(self, kind):
        folder, log = folder_of(kind), os.path.join(WORK, f"{kind}.lcm")
        live = self.play(kind, log)
        from_folder = build(kind, folder)
        self.assertEqual(build(kind, log), from_folder)
        rank = lambda source: distances(
            vdna_json("rank", source, MAP, "--warmup", FRAMES, "--backbone", NETWORK)["ranking"])
        self.assertEqual(rank(log), rank(folder))
        self.assertEqual(distances(live), rank(folder))
        return from_folder

    def test_turned_jpeg(self):
        dna = self.check("jpg")
        # OpenCV turns JPEG pictures by itself.
        convert_again = os.path.join(WORK, "again", "live")
        shutil.rmtree(os.path.dirname(convert_again), ignore_errors=True)
        os.makedirs(convert_again)
        for name in os.listdir(folder_of("jpg")):
            path = os.path.join(folder_of("jpg"), name)
            if name == "labels.csv":
                write(os.path.join(convert_again, name), read(path).replace(b".jpg", b".png"))
            else:
                transcode(path, os.path.join(convert_again, name.replace(".jpg", ".png")))
        self.assertEqual(build("again", convert_again), dna)

    def test_turned_png(self):
        self.assertEqual(self.check("png"), build("plain", folder_of("plain")))

    def test_turned_tiff(self):
        self.assertEqual(self.check("tiff"), build("plain", folder_of("plain")))

    def test_turned_webp(self):
        self.assertEqual(self.check("webp"), build("plain", folder_of("plain")))

    def test_sixteen_bits_transparency_and_palettes(self):
        self.check("mixed")

    def test_sixteen_bits_are_the_same_pictures_as_eight_in_every_kind(self):
        self.assertEqual(build("grey16", folder_of("grey16")), build("grey", folder_of("grey")))

    def test_transparency_is_ignored_in_every_kind(self):
        self.assertEqual(build("alpha", folder_of("alpha")), build("plain", folder_of("plain")))

    def test_a_palette_gives_its_colours(self):
        self.assertEqual(build("palette", folder_of("palette")),
                         build("colours", folder_of("colours")))

    def test_the_nearest_experience_is_that_of_the_same_condition(self):
        for kind in KINDS:
            ranking = vdna_json("rank", folder_of(kind), MAP, "--warmup", FRAMES, "--backbone",
                                NETWORK)["ranking"]
            self.assertEqual(ranking[0]["experience"], "winter")


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
