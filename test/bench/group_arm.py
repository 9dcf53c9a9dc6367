"""Instructions of the core for 64-bit ARM and for x86-64, each counted under qemu: no times, and
nothing about a processor's own speed."""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "test" / "machine" / "instructions"))
# machine -> compiler, its flags, emulator: both with what all of its processors have
MACHINES = {"aarch64": ("aarch64-linux-gnu-gcc", ["-march=armv8-a"], "qemu-aarch64"),
            "x86-64": ("gcc", ["-march=x86-64"], "qemu-x86_64")}


def run(context):
    """All of the group."""
    missing = [tool for compiler, _, emulator in MACHINES.values() for tool in (compiler, emulator)
               if not shutil.which(tool)]
    if missing:
        print(f"skipped: no {', '.join(missing)}; ./dev test --all installs them")
        return
    from test_core import THINGS
    with tempfile.TemporaryDirectory() as folder:
        plugin = plugin_in(Path(folder))
        programs = [program_in(Path(folder, machine), plugin, *how)
                    for machine, how in MACHINES.items()]
        for thing in ("emd",) if context.tiny else THINGS:
            arm, x86 = (count(program, thing) for program in programs)
            timed = {"median": arm, "least": arm, "most": arm, "rounds": 1, "waited": 0, "peers": {}}
            yield (f"{thing}: {THINGS[thing]}", "thousand instructions", 1e-3, timed,
                   {"x86_64_thousands": x86 / 1e3, "of_x86_64": arm / x86})


def plugin_in(folder):
    plugin = folder / "libcount_instructions.so"
    subprocess.run(["gcc", "-O2", "-shared", "-fPIC", "-o", plugin,
                    ROOT / "test" / "bench" / "count_instructions.c"], check=True)
    return plugin


def program_in(folder, plugin, compiler, flags, emulator):
    """The command line of `instructions` under emulation."""
    from test_core import FLAGS, build
    folder.mkdir()
    common = [flag for flag in FLAGS if not flag.startswith("-m")]
    program = build(str(folder), compiler, [*common, *flags, "-static"])
    return [emulator, "-plugin", plugin, "-d", "plugin", program]


def count(program, thing):
    """Instructions of one call."""
    def of(*arguments):
        done = subprocess.run([*program, thing, "random", *arguments], capture_output=True,
                              text=True, check=True)
        return int(done.stderr)
    return of() - of("prepare")
