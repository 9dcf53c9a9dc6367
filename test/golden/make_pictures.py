#!/usr/bin/env python3
"""Draw the pictures of the golden test: python3 make_pictures.py  (writes picture0..3.png here)

Our own drawings, so that they can be published. They need numpy and nothing else, use integers
only, and come out the same everywhere. Red, green and blue differ on purpose. Three of the four are
resized to the networks' 224x224; their sides are primes, so that no mean of pixels lies exactly
between two levels, which implementations may round either way.
"""
import pathlib
import struct
import zlib

import numpy as np

HERE = pathlib.Path(__file__).parent


def mix(low, high, part, whole):
    """The colours from `low` to `high` at part/whole of the way."""
    part = np.asarray(part)[..., None]
    return (np.array(low) * (whole - part) + np.array(high) * part) // whole


def landscape(width, height, sky, ground, trees, sun):
    """A horizon, a road, trees and a sun, in the given colours."""
    y, x = np.mgrid[0:height, 0:width]
    horizon = height * 2 // 5
    picture = mix(sky[0], sky[1], np.minimum(y, horizon), horizon)
    below = y >= horizon
    picture[below] = mix(ground[0], ground[1], y - horizon, height - horizon)[below]

    road = below & (np.abs(x - width * 9 // 20) * 2 < (y - horizon) + width // 40)
    picture[road] = mix((92, 90, 88), (120, 116, 110), y - horizon, height - horizon)[road]
    dash = road & (np.abs(x - width * 9 // 20) * 24 < (y - horizon)) & (y // (height // 24) % 2 == 0)
    picture[dash] = (235, 225, 190)

    for i in range(7):
        foot, size = width * (2 * i + 1) // 14, height // 5 + height // 9 * (i * 5 % 3)
        base = horizon + height // 12 * (i * 3 % 4 + 1)
        trunk = (np.abs(x - foot) < size // 14 + 1) & (y < base) & (y > base - size)
        picture[trunk] = (70, 48, 30)
        crown = (x - foot) ** 2 * 2 + (y - base + size) ** 2 < (size // 2) ** 2
        picture[crown] = trees[i % len(trees)]

    disc = (x - width * 4 // 5) ** 2 + (y - height // 7) ** 2 < (height // 12) ** 2
    picture[disc] = sun
    return picture.astype(np.uint8)


def street(width, height):
    """Night: dark house fronts, lit windows, a wet street with their reflections."""
    y, x = np.mgrid[0:height, 0:width]
    picture = mix((6, 8, 22), (24, 22, 44), y, height)
    column = x * 6 // width
    top = np.array([3, 1, 4, 2, 5, 2])[column] * height // 14
    kerb = height * 2 // 3
    picture[(y >= top) & (y < kerb)] = (34, 30, 36)
    inside = (x * 30 // width % 5 > 0) & (y * 26 // height % 3 > 0) & (y > top + 6) & (y < kerb - 8)
    lit = inside & ((x * 30 // width * 7 + y * 26 // height * 3) % 5 < 2)
    picture[inside] = (18, 20, 30)
    picture[lit] = (240, 190, 90)
    mirror = np.clip(2 * kerb - y, 0, height - 1)
    wet = y >= kerb
    picture[wet] = (picture[mirror, x] // 3 + np.array((10, 14, 20)))[wet]
    return picture.astype(np.uint8)


def png(picture):
    """A PNG file: 8-bit RGB, every row as differences to the row above."""
    height, width, _ = picture.shape
    above = np.vstack([np.zeros_like(picture[:1]), picture[:-1]])
    rows = (picture - above).reshape(height, width * 3)
    filtered = np.hstack([np.full((height, 1), 2, np.uint8), rows]).tobytes()

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(filtered, 9)) + chunk(b"IEND", b""))


def pictures():
    summer = landscape(224, 224, ((60, 120, 220), (190, 215, 240)), ((90, 150, 60), (60, 110, 40)),
                       ((30, 95, 35), (45, 120, 40)), (255, 240, 170))
    autumn = landscape(317, 239, ((120, 140, 170), (225, 205, 190)), ((150, 120, 60), (110, 80, 40)),
                       ((190, 90, 20), (215, 140, 30), (150, 50, 25)), (250, 215, 160))
    winter = landscape(503, 379, ((150, 165, 185), (210, 215, 225)), ((240, 243, 250), (205, 212, 228)),
                       ((120, 118, 122), (222, 228, 236)), (235, 235, 230))
    return [summer, autumn, winter, street(641, 479)]


if __name__ == "__main__":
    for number, drawn in enumerate(pictures()):
        (HERE / f"picture{number}.png").write_bytes(png(drawn))
