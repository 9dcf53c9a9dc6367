#!/usr/bin/env python3
"""Write pillow_golden.h: noise resized by Pillow with BICUBIC.

    python3 -m venv venv; venv/bin/pip install pillow==12.0.0; venv/bin/python make_pillow.py

Up to Pillow 12 columns are first, as in ours; from 13 on rows are, if that is less work. Only a
hash of each result is kept: ours must be equal to the last bit.
"""
import pathlib

import PIL
from PIL import Image

# from and to, as width and height; channels
CASES = [
    (640, 480, 224, 224, 3), (480, 640, 224, 224, 1), (1280, 720, 224, 224, 3),
    (512, 192, 224, 224, 3), (320, 240, 256, 320, 3), (100, 75, 224, 224, 3),
    (224, 300, 224, 224, 3), (300, 224, 224, 224, 1), (224, 224, 224, 224, 3),
    (33, 57, 8, 9, 3), (8, 9, 33, 57, 3), (7, 5, 1, 1, 3), (1, 1, 5, 7, 3), (2, 640, 3, 480, 1),
]


def noise(count):
    """Bytes of a linear congruential generator, in which black and white are as common as grey."""
    state, values = 1, bytearray()
    for _ in range(count):
        state = (state * 1664525 + 1013904223) % 2**32
        values.append((0, 255, state >> 16 & 255, state >> 8 & 255)[state >> 30])
    return bytes(values)


def fnv1a(data):
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return value


rows = []
for width, height, to_width, to_height, channels in CASES:
    picture = Image.frombytes("RGB" if channels == 3 else "L", (width, height),
                              noise(width * height * channels))
    resized = picture.resize((to_width, to_height), Image.Resampling.BICUBIC)
    rows.append(f"    {{{width}, {height}, {to_width}, {to_height}, {channels}, "
                f"0x{fnv1a(resized.tobytes()):016x}}},\n")
(pathlib.Path(__file__).parent / "pillow_golden.h").write_text(
    f"/* By make_pillow.py with Pillow {PIL.__version__}: hashes of resized noise. */\n"
    "static const struct {\n    int width, height, to_width, to_height, channels;\n"
    "    uint64_t fnv1a;\n} pillow_golden[] = {\n" + "".join(rows) + "};\n")
