"""Line, branch and MC/DC coverage of the C99 part by its tests.

Builds the preset `coverage` with clang-19, runs the suites unit and golden, prints a table, and
fails if anything is not covered that gaps.txt does not excuse. Exit code 77 = skipped: no clang-19.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
BUILD = ROOT / "build" / "coverage"
PARTS = [ROOT / "lib" / part
         for part in ("checksum", "core", "health", "localise", "trust", "identity", "select", "replace", "map")]
TOOLS = ["clang-19", "llvm-profdata-19", "llvm-cov-19"]
KINDS = ["line", "branch", "MC/DC"]


def run(*command, **options):
    """Run a command; return its output, or exit with it if the command fails."""
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=False, **options
    )
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}:\n{done.stdout}{done.stderr}")
    return done.stdout


def measure():
    """Build and test; return llvm-cov's report of the parts."""
    run("cmake", "--preset", "coverage")
    run("cmake", "--build", "--preset", "coverage")
    profiles = BUILD / "profiles"
    shutil.rmtree(profiles, ignore_errors=True)
    environment = {**os.environ, "LLVM_PROFILE_FILE": f"{profiles}/%p.profraw"}
    run("ctest", "--test-dir", BUILD, "-L", "unit|golden", "--output-on-failure", env=environment)

    merged = profiles / "merged.profdata"
    run("llvm-profdata-19", "merge", "-sparse", *profiles.glob("*.profraw"), "-o", merged)
    programs = [
        path
        for path in sorted(BUILD.glob("test/*/test_*"))
        if path.is_file() and os.access(path, os.X_OK)
    ]
    objects = [word for path in programs[1:] for word in ("-object", path)]
    report = run(
        "llvm-cov-19", "export", "-instr-profile", merged, programs[0], *objects, *PARTS
    )  # fmt: skip
    return json.loads(report)["data"][0]["files"]


def uncovered_lines(segments):
    """Lines at the beginning of a region that never ran. A segment is line, column, count, whether
    it has a count, whether a region begins here, whether it is a gap between regions."""
    return {line for line, _, count, counted, begins, gap in segments
            if counted and begins and not gap and count == 0}  # fmt: skip


def gaps_of(file):
    """{line: the kinds of gaps there}."""
    gaps = {line: ["line"] for line in uncovered_lines(file["segments"])}
    for branch in file["branches"]:
        gaps.setdefault(branch[0], []).extend(["branch"] * branch[4:6].count(0))
    for record in file["mcdc_records"]:
        gaps.setdefault(record[0], []).extend(["MC/DC"] * record[-1].count(False))
    return {line: kinds for line, kinds in gaps.items() if kinds}


def excused():
    """The gaps of gaps.txt, each above its indented reason."""
    lines = (HERE / "gaps.txt").read_text(encoding="utf-8").splitlines()
    return {line for line in lines if line and not line.startswith(("#", " "))}


def share(summary):
    return f"{summary['covered']}/{summary['count']}" if summary["count"] else "-"


def main():
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if missing:
        print(f"skipped: no {', '.join(missing)}; ./dev test --all installs them")
        sys.exit(77)

    excuses, used, gaps, files = excused(), set(), [], measure()
    print(f"{'file':24}" + "".join(f"{kind:>12}" for kind in KINDS))
    for file in files:
        name, summary = os.path.relpath(file["filename"], ROOT), file["summary"]
        if summary["lines"]["count"] == 0:  # a header without code
            continue
        print(
            f"{name:24}{share(summary['lines']):>12}{share(summary['branches']):>12}"
            f"{share(summary['mcdc']):>12}"
        )
        source = Path(file["filename"]).read_text(encoding="utf-8").splitlines()
        for line, kinds in sorted(gaps_of(file).items()):
            missed = ", ".join(f"{kinds.count(kind)} {kind}" for kind in KINDS if kind in kinds)
            excuse = f"{name}: {missed}: {source[line - 1].strip()}"
            used.add(excuse)
            if excuse not in excuses:
                gaps.append(f"line {line} of {excuse}")

    not_measured = {str(path) for part in PARTS for path in part.glob("*.c")}
    gaps += sorted(f"{path}: no test" for path in not_measured - {f["filename"] for f in files})
    gaps += sorted(f"gaps.txt excuses what is covered: {excuse}" for excuse in excuses - used)
    if gaps:
        sys.exit("\n".join(["not covered, and not excused in test/hostile/coverage/gaps.txt:", *gaps]))
    print(f"not covered, for reasons in test/hostile/coverage/gaps.txt: {len(excuses)} lines")


if __name__ == "__main__":
    main()
