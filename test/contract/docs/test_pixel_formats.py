"""The camera formats of vdna/image.h and of SPEC-lcm.md are the same, with the right numbers."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
HEADER = ROOT / "lib/include/vdna/image.h"
PAGE = ROOT / "docs/reference/SPEC-lcm.md"

DEFINITION = re.compile(r"^#define VDNA_PIXEL_(\w+) VDNA_FOURCC\('(.)', '(.)', '(.)', '(.)'\)", re.M)
TABLE = re.compile(r"^\| pixelformat \| value \|.*\n\|[-| ]+\n((?:\|.*\n)+)", re.M)


def defined():
    """{name: value}"""
    return {name: int.from_bytes("".join(letters).encode("ascii"), "little")
            for name, *letters in DEFINITION.findall(HEADER.read_text(encoding="utf-8"))}


def documented():
    """{name: value}; a row may have several, in one order."""
    [rows] = TABLE.findall(PAGE.read_text(encoding="utf-8"))
    cells = [[cell.split(", ") for cell in row.strip("| ").split(" | ")[:2]]
             for row in rows.splitlines()]
    return {name: int(value) for names, values in cells
            for name, value in zip(names, values, strict=True)}


def main():
    header, page = defined(), documented()
    for name in sorted(header.keys() | page.keys()):
        if header.get(name) != page.get(name):
            print(f"{name}: is {header.get(name)} in {HEADER.name} and {page.get(name)} in "
                  f"{PAGE.name}; expected one number in both")
    return 0 if header and header == page else 1


if __name__ == "__main__":
    sys.exit(main())
