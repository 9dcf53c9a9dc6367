"""lib/core, lib/health, lib/localise, lib/trust and lib/select compiled for one machine without a C library, and measured.

They see the compiler's own headers and those in lib/cmake/freestanding, nothing else, so that any further
#include is an error. Stack comes from the frames and calls that GCC reports
(-fcallgraph-info=su), and within libgcc, which does arithmetic that the processor lacks, from its
instructions.
"""

import re
import subprocess
from functools import lru_cache
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
ROOMS = ["core", "health", "localise", "trust", "select"]
SOURCES = sorted(path for room in ROOMS for path in ROOT.glob(f"lib/{room}/*.c"))

CORTEX_M4 = ["-mcpu=cortex-m4", "-mthumb"]
MACHINES = {  # name: (prefix of its tools, options)
    "cortex-m4": ("arm-none-eabi-", [*CORTEX_M4, "-mfloat-abi=soft"]),
    "cortex-m4f": ("arm-none-eabi-", [*CORTEX_M4, "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]),
    "armhf": ("arm-linux-gnueabihf-", []),
    "aarch64": ("aarch64-linux-gnu-", []),
    "x86-64": ("x86_64-linux-gnu-", []),
}


class Machine:
    """One of MACHINES; raises FileNotFoundError if its compiler is not installed."""

    def __init__(self, name):
        self.name = name
        self.prefix, self.options = MACHINES[name]
        self.version = self.run("gcc", "-dumpfullversion").strip()

    def run(self, tool, *arguments):
        """Run one of the machine's tools and return its output."""
        done = subprocess.run(
            [self.prefix + tool, *map(str, arguments)], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            raise RuntimeError(f"{self.name}: {' '.join(map(str, done.args))}:\n{done.stderr}")
        return done.stdout

    def compile(self, folder, *options):
        """Compile the library and start.c into `folder`; return the library's objects."""
        headers = self.run("gcc", "-print-file-name=include").strip()
        for source in [*SOURCES, HERE / "start.c"]:
            self.run(
                "gcc", *self.options, "-std=c99", "-ffreestanding", "-ffp-contract=off", *options,
                "-Wall", "-Wextra", "-Wpedantic", "-Wvla", "-Werror", "-fcallgraph-info=su",
                # C throws no exceptions, so no unwind tables.
                "-fno-asynchronous-unwind-tables",
                "-nostdinc", "-isystem", headers, "-I", ROOT / "lib" / "cmake" / "freestanding",
                "-I", ROOT / "lib" / "include", "-I", ROOT / "lib" / "core",
                "-c", source, "-o", Path(folder, source.stem + ".o"),
            )  # fmt: skip
        return [Path(folder, source.stem + ".o") for source in SOURCES]

    def link(self, output, *inputs):
        """Link the given files and nothing else."""
        self.run("gcc", *self.options, "-nostdlib", *inputs, "-o", output)

    def sizes(self, *files):
        """Bytes of text (with constants), data and bss in all files together."""
        rows = [line.split()[:3] for line in self.run("size", *files).splitlines()[1:]]
        return tuple(sum(int(number) for number in column) for column in zip(*rows))

    def symbols(self, file, kind):
        """Names of the symbols of a file: kind "U" for undefined, "T" for global functions."""
        lines = [line.split() for line in self.run("nm", "--portability", file).splitlines()]
        return {line[0] for line in lines if line[1] == kind}


class Recursion(Exception):
    """A function that calls itself, directly or not."""


class CallGraph:
    """The call graph of an ARM image, and the stack of each function."""

    def __init__(self, machine, folder, image):
        self.frames = {}  # function: bytes of its own frame
        self.kinds = {}  # function: GCC's basis for that: "static", or "dynamic" for VLA and alloca
        self.calls = {}  # function: those it calls
        self.addresses = {}  # symbol: its address
        self.routines = {}  # address: name of a function that GCC did not report
        for path in sorted(Path(folder).glob("*.ci")):
            self._read_report(path.read_text(encoding="utf-8"))
        for line in machine.run("nm", "--portability", image).splitlines():
            name, _, address = line.split()[:3]
            self.addresses[name] = int(address, 16)
        self._read_routines(machine.run("objdump", "-d", "--no-show-raw-insn", image))

    def _read_report(self, text):
        node = r'node: \{ title: "([^"]+)" label: "[^"]*\\n(\d+) bytes \(([a-z,]+)\)'
        edge = r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"'
        for name, frame, kind in re.findall(node, text):
            self.frames[name], self.kinds[name] = int(frame), kind
        for caller, callee in re.findall(edge, text):
            self.calls.setdefault(caller, set()).add(callee)

    def _read_routines(self, disassembly):
        reported = {self.addresses.get(name.rpartition(":")[2]) for name in self.frames}
        for block in re.split(r"\n\n(?=[0-9a-f]+ <)", disassembly):
            header = re.match(r"([0-9a-f]+) <([^>]+)>:\n", block)
            if not header or int(header[1], 16) in reported:
                continue
            name = self.routines[int(header[1], 16)] = header[2]
            self.frames[name] = sum(map(lowering, block.splitlines()[1:]))
            # A jump into another routine may end there, so it counts as a call.
            targets = re.findall(r"\tb[a-z.]*\t[0-9a-f]+ <([^>+]+)", block)
            self.calls[name] = set(targets) - {name}

    @lru_cache(maxsize=None)
    def worst(self, function, callers=()):
        """Most bytes of stack below the call of a function, and the path that takes them."""
        if function not in self.frames:  # another name of a routine
            function = self.routines[self.addresses[function]]
        if function in callers:
            raise Recursion(" > ".join((*callers, function)))
        below = [self.worst(c, (*callers, function)) for c in self.calls.get(function, ())]
        deepest, path = max(below, default=(0, ()))
        return self.frames[function] + deepest, (function.rpartition(":")[2], *path)


def lowering(line):
    """Bytes by which one ARM instruction lowers the stack pointer, as objdump prints it."""
    code = re.split("[;@]", line.partition("\t")[2])[0].strip()
    registers = re.match(r"(?:push|stmdb)[a-z.]*\s+(?:sp!,\s*)?\{([^}-]+)\}$", code)
    if registers:
        return 4 * len(registers[1].split(","))
    store = re.match(r"strd?[a-z.]*\s.*\[sp, #-(\d+)\]!$", code)
    if store:
        return int(store[1])
    subtraction = re.match(r"sub[a-z.]*\s+sp, (?:sp, )?#(\d+)$", code)
    if subtraction:
        return int(subtraction[1])
    if re.match(r"v?push|(?:mov|sub|stm|vstm)[a-z.0-9]*\s+sp\b|st.*\[sp, #-", code):
        raise RuntimeError(f"this test does not know how far the stack grows by: {line}")
    return 0
