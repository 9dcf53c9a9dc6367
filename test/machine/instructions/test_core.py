"""Instructions of the core, counted by callgrind: exactly repeatable, on any machine.

    test_core.py            compare with baseline.json
    test_core.py --renew    write baseline.json

The core is compiled here, with fixed flags for any x86-64, so that the counts depend on source and
compiler alone. With a compiler other than the baseline's, only the independence of the data is
checked, which holds with any.

VDNA_CORE is the folder of the core's sources, VDNA_LOCALISE that of lib/localise, VDNA_TRUST that of
lib/trust, VDNA_HEALTH that of lib/health, VDNA_INCLUDE that of the public headers.
"""
import glob
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
CORE = os.environ.get("VDNA_CORE", os.path.join(ROOT, "lib", "core"))
LOCALISE = os.environ.get("VDNA_LOCALISE", os.path.join(ROOT, "lib", "localise"))
TRUST = os.environ.get("VDNA_TRUST", os.path.join(ROOT, "lib", "trust"))
HEALTH = os.environ.get("VDNA_HEALTH", os.path.join(ROOT, "lib", "health"))
INCLUDE = os.environ.get("VDNA_INCLUDE", os.path.join(ROOT, "lib", "include"))
BASELINE = os.path.join(HERE, "baseline.json")
# The last one, as for proofs, leaves out the versions of loops that the loader chooses by the
# processor.
FLAGS = ["-std=c99", "-O3", "-march=x86-64", "-mtune=generic", "-ffp-contract=off", "-DVDNA_VECTORISED="]
THINGS = {
    "hist_add": "a frame of tokens, counted",
    "hist_add_map": "the same as a feature map",
    "count": "a frame of a window: slots are kept",
    "uncount": "a frame that leaves a window",
    "emd": "sums of 32 bits (add_narrow_row): nearly every distance",
    "emd_wide": "sums of 64 bits (add_row)",
    "rank": "16 distances",
    "knn": "the nearest of 1150 embeddings",
    "localise": "a frame among 1150 map frames, with a step of the filter",
    "trust_4": "a frame of a warmup among 4 experiences, its nearest distances found",
    "trust_100": "the same among 100",
    "predict_4": "predictions for 4 experiences, their distances found",
    "predict_100": "the same for 100",
    "health": "a picture of 640x480 in colour, measured",
}
DEPENDENT = {"trust_4", "trust_100", "predict_4", "predict_100"}  # maxima, roundings, equal candidates
KINDS = ["random", "constant", "sorted", "extreme"]
DRIFT_MAX = 0.01      # from the baseline
SPREAD_MAX = 1.02     # largest over smallest count, over all kinds of data


def compiler():
    return subprocess.run(["gcc", "--version"], capture_output=True, text=True,
                          check=True).stdout.split("\n")[0]


def build(folder, gcc="gcc", flags=FLAGS):
    program = os.path.join(folder, "instructions")
    # Keeps our own memset() from being compiled into calls of memset().
    subprocess.run([gcc, *flags, "-I", INCLUDE, "-I", CORE, "-fno-builtin",
                    "-fno-tree-loop-distribute-patterns", "-c",
                    os.path.join(HERE, "instructions.c"), "-o", program + ".o"], check=True)
    subprocess.run([gcc, *flags, "-I", INCLUDE, program + ".o",
                    "-I", CORE, *sorted(glob.glob(os.path.join(CORE, "*.c"))),
                    *sorted(glob.glob(os.path.join(LOCALISE, "*.c"))),
                    *sorted(glob.glob(os.path.join(TRUST, "*.c"))),
                    *sorted(glob.glob(os.path.join(HEALTH, "*.c"))), "-o", program], check=True)
    return program


def count(program, thing, kind):
    """Instructions of one call."""
    result = subprocess.run(
        ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no",
         "--toggle-collect=measured", program, thing, kind], capture_output=True, text=True)
    found = re.search(r"Collected : (\d+)", result.stderr)
    if result.returncode != 0 or not found:
        sys.exit(f"{thing} on {kind} data: valgrind exits with {result.returncode}: "
                 f"{result.stderr}")
    return int(found[1])


def count_all():
    with tempfile.TemporaryDirectory() as folder:
        program = build(folder)
        return {thing: {kind: count(program, thing, kind) for kind in KINDS} for thing in THINGS}


def independence_faults(counts):
    """Sentences about things whose cost depends on the data."""
    for thing, kinds in counts.items():
        spread = max(kinds.values()) / min(kinds.values())
        print(f"{thing:12} {kinds['random']:10} instructions, largest/smallest {spread:.4f}")
        if spread > SPREAD_MAX and thing not in DEPENDENT:
            yield f"{thing} depends on the data, {spread:.4f} > {SPREAD_MAX}: {kinds}"


def drift_faults(counts, baseline):
    """Sentences about counts that differ from the baseline."""
    if compiler() != baseline["compiler"]:
        print(f"the baseline is of {baseline['compiler']}, this is {compiler()}: not compared")
        return
    for thing, kinds in counts.items():
        for kind, found in kinds.items():
            expected = baseline["counts"][thing][kind]
            if abs(found - expected) > DRIFT_MAX * expected:
                yield (f"{thing} on {kind} data takes {found} instructions, {expected} expected "
                       f"({100 * (found / expected - 1):+.1f} %); if that is meant, run: "
                       f"python3 {os.path.relpath(__file__)} --renew")


def main():
    if platform.machine() != "x86_64":
        print("skipped: the flags are those of x86-64")
        return 77
    for tool in ("gcc", "valgrind"):
        if not shutil.which(tool):
            print(f"skipped: no {tool}; ./dev test --all installs it")
            return 77
    counts = count_all()
    faults = list(independence_faults(counts))
    if sys.argv[1:] == ["--renew"]:
        with open(BASELINE, "w", encoding="ascii") as file:
            json.dump({"compiler": compiler(), "flags": FLAGS, "counts": counts}, file, indent=2)
            file.write("\n")
    with open(BASELINE, encoding="ascii") as file:
        faults += drift_faults(counts, json.load(file))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
