"""docs/internals/memory-core.md from measurements: written, or compared with the committed page.

    memory_core.py RAM_PROGRAM [--write]

Exit code 77 = the RAM is as committed, and the rest cannot be compared: no such compilers here.
"""

import difflib
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from machine import MACHINES, ROOT, CallGraph, Machine

PAGE = ROOT / "docs" / "internals" / "memory-core.md"
EMBEDDED = ["cortex-m4", "cortex-m4f"]

INTRODUCTION = """\
# Memory of the C99 core

Written by `cmake --build build --target memory_core` from measurements; the test
`small.memory_core` fails when it is out of date. All figures are bytes. What the daemon takes is in
[memory.md](memory.md).

"""

RAM = """\
## RAM

`lib/core`, `lib/health`, `lib/localise` and `lib/select` have no variables and allocate nothing. These are the
blocks that the caller provides, as the `vdna_..._size()` functions give them on a 64-bit machine. A
selector holds the live histogram and the working memory of the distance; it is for four experiences here,
and each further one takes {further}, with trust {trusting}. The experiences themselves stay in their files, which are
mapped; each has counts of a histogram's size.

{table}

To localise, the frames of the chosen experience are prepared once, and a localiser follows the robot in
them.

{localise}

Trust in the choice holds what the map knows about itself, and the warmup so far.

{trust}
"""

COMPILED = """\
## Stack

The deepest path below each public function on a Cortex-M4 at `-Os`, without (`cortex-m4`) and with
(`cortex-m4f`) the processor's own floats, libgcc's arithmetic included. There is no recursion, no
frame of variable size and no call through a pointer.

{stack}

## Code

`lib/core`, `lib/health`, `lib/localise` and `lib/select` with their constants. What libgcc adds for arithmetic that
a processor lacks is counted apart.

{code}
"""


def table(head, rows):
    """A table in Markdown; numbers to the right."""
    cells = [[f"{c:,}" if isinstance(c, int) else c for c in row] for row in rows]
    rule = ["---:" if isinstance(c, int) else "---" for c in rows[0]]
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, rule, *cells])


def ram_part(program):
    output = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    first, *lines = output.splitlines()
    further, trusting = first.split()
    rows = [tuple(map(int, line.split())) for line in lines]
    head = ["neurons", "bins", "histogram", "working memory of the distance", "selector"]
    localise_head = ["map frames", "dim", "prepared frames", "localiser"]
    return RAM.format(further=further, trusting=trusting, table=table(head, [row for row in rows if len(row) == 5]),
                      localise=table(localise_head, [row for row in rows if len(row) == 4]),
                      trust=table(["experiences", "trust"], [row for row in rows if len(row) == 2]))


def stacks(machine, folder, objects):
    """Worst stack of every public function."""
    image = Path(folder, "image")
    machine.link(image, *objects, Path(folder, "start.o"), "-lgcc")
    graph = CallGraph(machine, folder, image)
    listed = set(re.findall(r"vdna_\w+(?=;)", (ROOT / "lib/vdna.map").read_text()))
    public = sorted(listed.intersection(*[set().union(*(machine.symbols(o, "T") for o in objects))]))
    return {function: graph.worst(function)[0] for function in public}


def text_of(machine, folder, *inputs):
    library = Path(folder, "library")
    machine.link(library, "-r", *inputs)
    return machine.sizes(library)[0]


def compiled_part(machines):
    deepest, code = [], []
    for machine in machines:
        with tempfile.TemporaryDirectory() as folder:
            fast = text_of(machine, folder, *machine.compile(folder, "-O3"))
            objects = machine.compile(folder, "-Os")
            small = text_of(machine, folder, *objects)
            arithmetic = text_of(machine, folder, *objects, "-lgcc") - small
            code.append((machine.name, f"gcc {machine.version}", small, arithmetic, fast))
            if machine.name in EMBEDDED:
                deepest.append(stacks(machine, folder, objects))
    rows = [(f"`{name}()`", *(stack[name] for stack in deepest)) for name in deepest[0]]
    return COMPILED.format(
        stack=table(["function", *EMBEDDED], rows),
        code=table(["machine", "compiler", "-Os", "with it, libgcc", "-O3"], code),
    )


def compilers_in(text):
    return re.findall(r"\| (\S+) \| gcc (\S+) \|", text)


def compare(found, committed, title):
    if found == committed:
        return
    sys.stdout.writelines(
        difflib.unified_diff(
            committed.splitlines(True), found.splitlines(True), f"{title}, committed", "measured"
        )
    )
    sys.exit(f"{PAGE} is out of date; run: cmake --build build --target memory_core")


def main():
    program, write = sys.argv[1], "--write" in sys.argv[2:]
    ram = INTRODUCTION + ram_part(program)
    try:
        machines = [Machine(name) for name in MACHINES]
    except FileNotFoundError as missing:
        machines, reason = None, f"no {missing.filename}; ./dev test --all installs it"
    if write:
        if not machines:
            sys.exit(reason)
        PAGE.write_text(ram + "\n" + compiled_part(machines), encoding="utf-8")
        return

    committed_ram, mark, committed_rest = PAGE.read_text(encoding="utf-8").partition("\n## Stack")
    compare(ram, committed_ram, "RAM")
    if machines:
        found = [(machine.name, machine.version) for machine in machines]
        reason = f"the page is of other compilers: {compilers_in(committed_rest)}, here {found}"
    if not machines or found != compilers_in(committed_rest):
        print(f"skipped: {reason}")
        sys.exit(77)
    compare("\n" + compiled_part(machines), mark + committed_rest, "Stack and code")


if __name__ == "__main__":
    main()
