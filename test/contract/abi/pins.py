"""The files that pin the ABI, and what they must hold.

    lib/vdna.map                  the functions that libvdna.so exports; also the linker's version
                                  script
    lib/vdna_backbone.map         the same of libvdna_backbone.so
    test/contract/abi/layout.txt  sizes, alignments and offsets of every public struct, and every
                                  enumerator
    test/contract/abi/vdna.abi    abidw's view of libvdna.so's functions and their types, on x86-64

`pins.py renew` writes them anew, as the CMake target abi_baseline does. Environment: as given by
test/contract/abi/CMakeLists.txt.
"""

import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import declarations

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
LAYOUT = HERE / "layout.txt"
BASELINE = HERE / "vdna.abi"

INCLUDE = ROOT / "lib" / "include"
LIBRARY = os.environ["VDNA_LIBRARY"]


class Library:
    """One of our shared libraries: `name`.so exports, as version `node`, what `headers` declare."""

    def __init__(self, name, node, headers, path):
        self.name, self.node, self.path = name, node, path
        self.headers = [Path(header) for header in headers.split(":")]
        self.map = ROOT / "lib" / f"{name.removeprefix('lib')}.map"

    def exports_text(self):
        names = "".join(f"    {name};\n" for name in sorted(declarations.functions(self.headers)))
        return (f"# What {self.name}.so exports: the functions that its headers mark with VDNA_API.\n"
                "# Written by the CMake target abi_baseline.\n"
                f"{self.node} {{\nglobal:\n{names}local:\n    *;\n}};\n")


LIBRARIES = [
    Library("libvdna", "VDNA_0", os.environ["VDNA_HEADERS"], LIBRARY),
    # Its path is empty where it is not built.
    Library("libvdna_backbone", "VDNA_BACKBONE_0", os.environ["VDNA_BACKBONE_HEADERS"],
            os.environ["VDNA_BACKBONE_LIBRARY"]),
]
HEADERS = [header for library in LIBRARIES for header in library.headers]

REMEDY = "if the change is meant, run: cmake --build --preset core --target abi_baseline"

NATIVE = ([os.environ["VDNA_CC"]], os.environ["VDNA_OBJCOPY"])
# clang knows the layout rules of machines whose compilers are not there.
AARCH64 = (["clang-19", "--target=aarch64-linux-gnu"], "llvm-objcopy-19")
ARMHF = (["clang-19", "--target=armv7-linux-gnueabihf"], "llvm-objcopy-19")


def _measured():
    """(name, C expressions for its numbers) of all that the layout pins."""
    for name, fields in declarations.structs(HEADERS).items():
        aligned = f"offsetof(struct {{ char c; {name} aligned; }}, aligned)"
        yield name, [aligned, f"sizeof({name})"]
        for field in fields:
            yield f"{name}.{field}", [f"offsetof({name}, {field})",
                                      f"sizeof((({name} *)0)->{field})"]
    for name in declarations.enumerators(HEADERS):
        yield name, [name]


def layout(machine):
    """{name: its numbers} as this machine's compiler lays things out."""
    compiler, objcopy = machine
    names, expressions = zip(*_measured())
    includes = "".join(f"#include <vdna/{header.name}>\n" for header in HEADERS)
    numbers = ",\n".join(text for row in expressions for text in row)
    with tempfile.TemporaryDirectory() as scratch:
        source, object_, table = (Path(scratch, "table" + end) for end in (".c", ".o", ".bin"))
        source.write_text(f"#include <stddef.h>\n{includes}"
                          f"const int32_t table[] = {{\n{numbers}\n}};\n")
        subprocess.run([*compiler, "-std=c99", "-ffreestanding", f"-I{INCLUDE}", "-c", source,
                        "-o", object_], check=True)
        subprocess.run([objcopy, "-O", "binary", "--only-section=.rodata", object_, table],
                       check=True)
        values = struct.iter_unpack("<i", table.read_bytes())
        return {name: [next(values)[0] for _ in row] for name, row in zip(names, expressions)}


def layout_text():
    lp64, ilp32 = layout(NATIVE), layout(ARMHF)
    rows = [f"{name:40} {' '.join(f'{number:5}' for number in lp64[name] + ilp32[name])}\n"
            for name in lp64]
    return ("# struct: alignment and size; field: offset and size; each with 64-bit pointers, then\n"
            "# with 32-bit ones (and int64_t aligned to 8). enumerator: its value, twice.\n"
            "# Written by the CMake target abi_baseline.\n" + "".join(rows))


def pinned_layout():
    """({name: numbers} with 64-bit pointers, the same with 32-bit ones)"""
    lp64, ilp32 = {}, {}
    for line in LAYOUT.read_text().splitlines():
        if not line.startswith("#"):
            name, *numbers = line.split()
            half = len(numbers) // 2
            lp64[name] = [int(number) for number in numbers[:half]]
            ilp32[name] = [int(number) for number in numbers[half:]]
    return lp64, ilp32


def write_baseline():
    subprocess.run(["abidw", "--out-file", BASELINE, "--exported-interfaces-only",
                    "--type-id-style", "hash", "--no-show-locs", "--no-corpus-path",
                    "--no-comp-dir-path", "--no-elf-needed", "--no-write-default-sizes", LIBRARY],
                   check=True)
    BASELINE.write_text(BASELINE.read_text().replace(f"{ROOT}/", ""))


def renew(build):
    for library in LIBRARIES:
        library.map.write_text(library.exports_text())
    LAYOUT.write_text(layout_text())
    subprocess.run(["cmake", "--build", build, "--target", "vdna_shared"], check=True)
    write_baseline()


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] != "renew":
        sys.exit("usage: pins.py renew BUILD_FOLDER")
    renew(sys.argv[2])
