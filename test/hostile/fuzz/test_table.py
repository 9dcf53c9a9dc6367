"""Tables of labels against an oracle in plain Python: its csv module, and the rules of the manual.

    test_table.py TABLE_LABELS [SEED]

100,000 random tables, the same on every run: separators, quotes, line ends, byte order marks, other
encodings, names in many spellings, empty cells, numbers of all kinds, fixes nobody can have, jumps.
Both must accept the same tables, and read the same labels from them. A difference is printed with its
SEED, which runs that one table again.
"""

import csv
import functools
import io
import math
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import unicodedata
from pathlib import Path

CASES = 100_000
DECOMPOSED = unicodedata.normalize("NFD", "Käfer.jpg")
PICTURES = ["a.jpg", "b.jpg", "B.JPG", DECOMPOSED, "c d.jpg",
            "STRASSE.jpg"]  # b.jpg and B.JPG look alike
NAMES = ["a.jpg", "b.jpg", "c d.jpg", "./a.jpg", "pics/a.jpg", "pics/b.jpg", "x/../pics/a.jpg",
         "pics\\a.jpg", "A.JPG", "B.jpg", "Käfer.jpg", DECOMPOSED, "pics/Käfer.jpg", "KÄFER.jpg",
         "other.jpg", "q\"q.jpg", "e,e.jpg", "C D.JPG", "straße.jpg", "K\udce4fer.jpg"]
WHOLE = ["0", "5", "-7", " 12 ", "007", "1.5", "9223372036854775807", "9223372036854775808",
         "-9223372036854775808", "", "x", "+3", "1e3", "1 000"]
REAL = ["0", "0.0", "-0", "1.5", "48.1", "11.5", " 2 ", "1e2", ".5", "5.", "-3", "nan", "NaN", "inf",
        "-Infinity", "null", "N/A", "", "  ", "90", "90.01", "-180", "359.9", "361", "1,5", "2m",
        "1e400", "0x10", "+1", "1e10", "200000", "4181998.2"]
HEADERS = [["file", "place"], ["file", "x", "y"], ["file", "lat", "lon"], ["file", "utime", "x", "y"],
           ["file", "lat", "lon", "alt"], ["file", "utime", "place", "lat", "lon"], ["place"],
           ["file", "x", "y", "z", "note"], ["file", "x"], ["file", "utime"], ["frame", "place"],
           ["file", "x", "y", "lat", "lon"], ["file", "place", "place"], ["File", "place"],
           ["file", "x", "y", "position_frame"], ["file", "place", "x", "y"]]


# ---- making tables

def quoted(chance, cell):
    if any(c in cell for c in ',"\r\n') or chance.random() < 0.05:
        return '"' + cell.replace('"', '""') + '"'
    return cell


def drive(chance):
    """A table of a plausible drive with timed positions, some of them elsewhere."""
    rows, x = [["file", "utime", "x", "y"]], 0.0
    second, begin = chance.choice([(10**6, 0), (10**6, 17 * 10**14), (10**9, 17 * 10**17),
                                   (10**3, 17 * 10**11), (10**3, 0), (1, 17 * 10**8), (1, 0)])
    for i in range(chance.randrange(3, 20)):
        x += chance.uniform(0, 30)
        away = chance.choice([0, 0, 0, 0, 0, chance.uniform(-300, 300), 5000, 5010])
        rows.append([PICTURES[i] if i in (0, 4) else f"{i}.jpg",
                     str(begin + i * second * chance.choice([10, 10, 9]) // 10), f"{x:.3f}",
                     f"{away:.3f}"])
    return rows


def cell(chance, column):
    if column == "file":
        return chance.choice(NAMES)
    if column in ("utime", "place", "frame"):
        return chance.choice(WHOLE[:4] if chance.random() < 0.8 else WHOLE)
    if column == "position_frame":
        return chance.choice(["site", "site", "site", "hall-3", "my site", "wgs84", ""])
    if column == "note":
        return chance.choice(["", "two\r\nlines", "a \"b\"", "n,n", "\t"])
    return chance.choice(REAL[:8] if chance.random() < 0.75 else REAL)


def rows_of(chance):
    if chance.random() < 0.15:
        return drive(chance)
    header = list(chance.choice(HEADERS))
    if chance.random() < 0.3:
        chance.shuffle(header)
    rows = [[cell(chance, column) for column in header] for _ in range(chance.randrange(6))]
    if rows and chance.random() < 0.04:
        chance.choice(rows).append("more")
    if chance.random() < 0.1:
        header = [" " + column + "\t" for column in header]
    return [header] + rows


def table(seed):
    """The bytes of a table."""
    chance = random.Random(seed)
    separator = chance.choice([","] * 19 + [";", "\t", "|"])
    end = chance.choice(["\n"] * 8 + ["\r\n"] * 4 + ["\r"])
    lines = [separator.join(quoted(chance, c) for c in row) for row in rows_of(chance)]
    if chance.random() < 0.2:
        lines.insert(chance.randrange(len(lines) + 1), chance.choice(["", '""']))
    text = end.join(lines) + (end if chance.random() < 0.8 else "")
    encoded = text.encode("utf-8", "surrogateescape")
    kind = chance.random()
    if kind < 0.1:
        encoded = b"\xef\xbb\xbf" + encoded
    elif kind < 0.12:
        encoded = text.encode("utf-16", "replace")
    elif kind < 0.17 and encoded:  # damage
        at = chance.randrange(len(encoded))
        encoded = encoded[:at] + bytes([chance.choice(b'",;\n\r\x00a')]) + encoded[at + 1:]
    return encoded


# ---- the oracle

class Refused(Exception):
    pass


def split(data):
    """The header and the rows, as lists of bytes-like texts (latin-1)."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data:
        raise Refused
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    outside = re.sub(r'(^|(?<=[,\n]))"(?:[^"]|"")*"', "", text)  # quoted fields hold anything
    if re.search(r"\r(?!\n|\Z)", outside):
        raise Refused
    try:
        rows = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except csv.Error as error:
        raise Refused from error
    rows = [row for row in rows if row not in ([], [""])]
    if not rows or (len(rows[0]) == 1 and re.search(r"[;\t|]", rows[0][0])):
        raise Refused
    header = [name.strip(" \t") for name in rows[0]]
    if len(set(header)) < len(header) or any(len(row) != len(header) for row in rows):
        raise Refused
    return header, [dict(zip(header, row)) for row in rows[1:]]


def whole(text, least, most):
    text = text.strip(" \t")
    if not re.fullmatch(r"-?\d+", text) or (least == 0 and text.startswith("-")):
        raise Refused
    if not least <= int(text) <= most:
        raise Refused
    return int(text)


def real(text):
    text = text.strip(" \t")
    if text.lower() in ("nan", "+nan", "-nan", "inf", "+inf", "-inf", "na", "n/a", "none", "null"):
        return math.nan
    if re.fullmatch(r"-?(inf|infinity|nan)", text, re.I):
        return math.nan
    if not re.fullmatch(r"-?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", text) or math.isinf(float(text)):
        raise Refused
    return float(text)


def ecef(lat, lon, alt):
    a, f = 6378137.0, 1 / 298.257223563
    e2 = f * (2 - f)
    n = a / math.sqrt(1 - e2 * math.sin(math.radians(lat)) ** 2)
    across = (n + alt) * math.cos(math.radians(lat))
    return (across * math.cos(math.radians(lon)), across * math.sin(math.radians(lon)),
            (n * (1 - e2) + alt) * math.sin(math.radians(lat)))


FLAWS = ["with half of a position", "without a number", "at 0,0", "beyond the globe",
         "where no vehicle gets in the time"]


def flaw_of(degrees, a, b, height):
    if math.isnan(a) or math.isnan(b):
        return 1
    if degrees and a == 0 and b == 0:
        return 2
    if degrees and (abs(a) > 90 or abs(b) > 360 or not -12000 <= height <= 100000):
        return 3
    return None


def microseconds(stamps):
    """The rule of vdna/camera_time.h."""
    spacings = sorted([abs(b - a) for a, b in zip(stamps, stamps[1:]) if a != b][:8])
    spacing, first = spacings[len(spacings) // 2] if spacings else 0, stamps[0]
    if first >= 10**17:
        return [int(math.copysign(abs(stamp) // 1000, stamp)) for stamp in stamps]
    if first >= 10**14 or spacing == 0 or spacing >= 500:
        return stamps
    is_ms = 10**12 <= first < 4 * 10**12 or not 10**9 <= first < 4 * 10**9 and spacing > 2
    return [max(-2**63, min(2**63 - 1, stamp * (1000 if is_ms else 10**6))) for stamp in stamps]


def jumps(timed):
    """Indices of labels; timed: (stamp, ground, index) of one drive in order of time."""
    timed = [(us, *rest) for us, (_, *rest) in zip(microseconds([t[0] for t in timed]), timed)]

    def far(i, j):
        return (math.dist(timed[i][1], timed[j][1])
                > 25 + 100 * (timed[j][0] - timed[i][0]) / 1e6)
    found, i = [], 1
    while i < len(timed):
        back = [j for j in range(i + 1, min(i + 11, len(timed)))
                if far(j - 1, j) and not far(i - 1, j)] if far(i - 1, i) else []
        if back:
            found += [timed[k][2] for k in range(i, back[0])]
            i = back[0]
        i += 1
    return found


def labels_of(header, rows):
    """[name, utime, place, position, frame] of each row, and how many have each flaw."""
    degrees = {"lat", "lon"} <= set(header)
    metres = {"x", "y"} <= set(header)
    if not {"file", "frame"} & set(header) or (degrees and metres) or not (
            degrees or metres or {"place", "utime"} & set(header)):
        raise Refused
    first, second, third = ("lat", "lon", "alt") if degrees else ("x", "y", "z")
    labels, flaws, drives, frames, taken = [], [0] * 5, {}, set(), 0
    for row in rows:
        name = row["file"] if "file" in row else whole(row["frame"], 0, 2**64 - 1)
        utime = None
        if row.get("utime", "").strip(" \t"):
            utime = whole(row["utime"], -2**63, 2**63 - 1)
        place = (whole(row["place"], 1 - 2**63, 2**63 - 1)
                 if row.get("place", "").strip(" \t") else None)
        position = frame = None
        blank = [not row[column].strip(" \t") for column in (first, second)] if (
            degrees or metres) else [True, True]
        if blank[0] != blank[1]:
            flaws[0] += 1
        elif not blank[0]:
            a, b = real(row[first]), real(row[second])
            height = real(row[third]) if row.get(third, "").strip(" \t") else 0.0
            height = 0.0 if math.isnan(height) else height
            flaw = flaw_of(degrees, a, b, height)
            if flaw is not None:
                flaws[flaw] += 1
            else:
                if not degrees and max(abs(a), abs(b), abs(height)) > 1e9:
                    raise Refused
                taken += 1
                position = ecef(a, b, height) if degrees else (a, b, height)
                frame = "wgs84" if degrees else row.get("position_frame", "local")
                frames.add(frame)
                if not re.fullmatch(r"[A-Za-z0-9._-]{1,63}", frame) or (
                        frame == "wgs84" and not degrees):
                    raise Refused
                if utime is not None:
                    ground = ecef(a, b, 0) if degrees else (a, b, 0)
                    key = os.path.dirname(name) if isinstance(name, str) else ""
                    drives.setdefault(key, []).append((utime, ground, len(labels)))
        labels.append([name, utime, place, position, frame])
    if len(frames) > 1 or (flaws[3] > 1 and taken == 0):
        raise Refused
    for timed in drives.values():
        timed.sort(key=lambda fix: fix[0])
        for index in jumps(timed):
            labels[index][3] = labels[index][4] = None
            flaws[4] += 1
    return labels, flaws


@functools.lru_cache(maxsize=None)
def alike(name):
    text = name.replace(b"\\", b"/")
    try:
        text = unicodedata.normalize("NFC", unicodedata.normalize(
            "NFD", text.decode("utf-8")).casefold()).encode()
    except UnicodeDecodeError:
        pass
    return os.path.normpath(text) if text else text


class Oracle:
    def __init__(self, folder):
        self.folder = os.path.realpath(os.fsencode(folder))
        self.pictures = [os.path.join(self.folder, b"pics", os.fsencode(p)) for p in PICTURES]

    def endings(self, path):
        parts = path.strip(b"/").split(b"/")
        return [b"/".join(parts[i:]) for i in range(len(parts))]

    def row_of(self, names, picture):
        files = [os.path.normpath(os.path.join(self.folder, name)) for name in names]
        if picture in files:
            return files.index(picture)
        for ending in self.endings(picture):
            rows = [i for i, name in enumerate(names) if os.path.normpath(name) == ending]
            if rows and not os.path.lexists(files[rows[0]]):
                return rows[0]
        siblings = [alike(os.path.basename(p)) for p in self.pictures]
        if siblings.count(alike(os.path.basename(picture))) > 1:
            return None
        for wanted in [picture, *self.endings(picture)]:
            rows = {i for i, (file, name) in enumerate(zip(files, names))
                    if alike(wanted) in (alike(file), alike(name))}
            if len(rows) == 1 and not os.path.lexists(files[min(rows)]):
                return min(rows)
        return None

    def rows_of(self, labels):
        """The row of each picture, or None."""
        names = [label[0].encode("latin-1") for label in labels]
        files = [os.path.normpath(os.path.join(self.folder, name)) for name in names]
        if len(set(files)) < len(files):
            raise Refused
        found = [self.row_of(names, picture) for picture in self.pictures]
        if None in found:
            for name in names:
                name.decode("utf-8")
            if all(row is None for row in found):
                raise Refused
        return found

    def rows_of_frames(self, labels):
        """The same of frame 5, in whose place each picture is looked up."""
        frames = [label[0] for label in labels]
        if len(set(frames)) < len(frames):
            raise Refused
        return [frames.index(5) if 5 in frames else None] * len(self.pictures)

    def line(self, data):
        """What TABLE_LABELS prints, as (counts of flaws, labels); None if the table is refused."""
        try:
            header, rows = split(data)
            labels, flaws = labels_of(header, rows)
            found = self.rows_of(labels) if "file" in header else self.rows_of_frames(labels)
        except (Refused, UnicodeDecodeError):
            return None
        is_truth = bool({"place", "x", "lat"} & set(header)) and (
            "place" in header or {"x", "y"} <= set(header) or {"lat", "lon"} <= set(header))
        result = []
        for row in found:
            _, utime, place, position, frame = labels[row] if row is not None else [None] * 5
            lacks = is_truth and place is None and position is None
            result.append((utime, place, position, frame, lacks))
        return flaws, result


# ---- comparing

def told(line):
    """A line of TABLE_LABELS in the oracle's shape."""
    if line == "refused":
        return None
    note, *labels = line.split("\t")
    flaws = [int((re.search(r"(\d+) " + re.escape(text), note) or [0, 0])[1]) for text in FLAWS]
    result = []
    for label in labels:
        utime, place, x, y, z, frame, lacks = label.split(" ")
        result.append((None if utime == "-" else int(utime), None if place == "-" else int(place),
                       None if x == "-" else (float(x), float(y), float(z)),
                       None if frame == "-" else frame, lacks == "1"))
    return flaws, result


def same(ours, oracle):
    if ours is None or oracle is None:
        return ours is oracle
    if ours[0] != oracle[0]:
        return False
    for a, b in zip(ours[1], oracle[1]):
        if a[:2] + a[3:] != b[:2] + b[3:] or (a[2] is None) != (b[2] is None):
            return False
        if a[2] and math.dist(a[2], b[2]) > 1e-6:
            return False
    return len(ours[1]) == len(oracle[1])


def main():
    seeds = [int(sys.argv[2])] if len(sys.argv) > 2 else range(CASES)
    place = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(prefix="vdna-table-", dir=place) as name:
        folder = Path(name)
        (folder / "pics").mkdir()
        (folder / "c d.jpg").touch()  # a row of this name is about it
        for picture in PICTURES:
            (folder / "pics" / picture).touch()
        tables = [table(seed) for seed in seeds]
        done = subprocess.run(
            [sys.argv[1], folder / "t.csv", folder / "pics", *PICTURES],
            input=b"".join(struct.pack("<I", len(t)) + t for t in tables), capture_output=True,
            check=False)
        if done.returncode != 0:
            sys.exit(f"exit code {done.returncode}: {done.stderr[-2000:].decode('utf-8', 'replace')}")
        lines = done.stdout.decode("utf-8", "surrogateescape").split("\n")[:-1]
        if len(lines) != len(tables):
            sys.exit(f"{len(lines)} answers to {len(tables)} tables")
        oracle, accepted = Oracle(folder), 0
        for seed, text, line in zip(seeds, tables, lines):
            expected, found = oracle.line(text), told(line)
            accepted += expected is not None
            if not same(found, expected):
                sys.exit(f"table {seed}, again with: {' '.join(sys.argv[:2])} {seed}\n{text}\n"
                         f"found    {found}\nexpected {expected}")
        print(f"{len(tables)} tables, {accepted} accepted")
        if len(tables) == CASES and not CASES / 5 < accepted < CASES * 4 / 5:
            sys.exit("the tables are nearly all good or nearly all bad: they try too little")


if __name__ == "__main__":
    main()
