"""Static analysis of lib/ and apps/ leaves no finding that is not excused.

usage: analyse.py TOOL BUILD [PATH...]

TOOL is gcc (-fanalyzer of gcc-12; C alone, as it does not understand C++), cppcheck or clang-tidy; BUILD has
compile_commands.json and the generated headers; PATH begins the names of the sources to analyse,
all by default. Findings of gcc and cppcheck are excused in excused.txt, those of clang-tidy by
/.clang-tidy and NOLINT; excused.txt has its control alone. Exit code 77 = skipped: no such tool.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools import fresh, skip, virtual_environment

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
FINDING = re.compile(
    r"(?P<file>[^:\n]+):\d+:(?:\d+:)? (?P<text>(?:warning|error|performance|portability): .*)"
)
GCC = "gcc-12"  # others find other things
CLANG_TIDY = "clang-tidy==23.1.4"  # of PyPI: skips system headers, so it takes half of the time


def compilations(build, beginnings, ending):
    """How each source is compiled, once, by its path in the tree."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = os.path.relpath(entry["file"], ROOT)
        if path.startswith(beginnings) and path.endswith(ending):
            found.setdefault(path, entry)
    return found


def output_of(command, folder):
    """What a tool printed; an exit code that it does not use for findings is our failure."""
    done = subprocess.run(command, cwd=folder, text=True, capture_output=True, check=False,
                          env={**os.environ, "LC_ALL": "C"})  # fmt: skip
    if done.returncode not in (0, 1):
        sys.exit(f"{shlex.join(command)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def in_parallel(run, entries):
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return "".join(pool.map(run, entries))


def gcc(compiled, _build):
    if not shutil.which(GCC):
        skip(f"no {GCC}; ./dev check --static installs it")

    def run(entry):
        words = shlex.split(entry["command"])
        compiler = next(i for i, word in enumerate(words) if not word.endswith("ccache"))
        words = [GCC, *(word for word in words[compiler + 1:] if word != "-Werror"), "-fanalyzer"]
        words[words.index("-o") + 1] = os.devnull
        return output_of(words, entry["directory"]).stderr

    return in_parallel(run, compiled.values())


def cppcheck(compiled, build):
    if not shutil.which("cppcheck"):
        skip("no cppcheck; ./dev check --static installs it")
    project = fresh(build / "static") / "compile_commands.json"
    project.write_text(json.dumps(list(compiled.values())))
    return output_of(
        ["cppcheck", f"--project={project}", "--enable=warning,performance,portability", "--quiet",
         f"-j{os.cpu_count()}", "--template={file}:{line}: {severity}: {message} [{id}]"],
        ROOT,
    ).stderr  # fmt: skip


def clang_tidy(compiled, build):
    environment = build / "static_environment"
    if not environment.exists() and "VDNA_ALL" not in os.environ:
        skip("no clang-tidy; ./dev check --static installs it")
    program = virtual_environment(environment, CLANG_TIDY) / "clang-tidy"

    def run(path):
        return output_of([str(program), "--quiet", "-p", str(build), path], ROOT).stdout

    return in_parallel(run, [*compiled, "test/hostile/static/control.c"])


def findings_in(output):
    """{finding in the tree, without its line number: the finding}"""
    found = {}
    for match in FINDING.finditer(output):
        path = os.path.relpath(match["file"], ROOT)
        if not path.startswith(".."):
            found[f"{path}: {match['text']}"] = match[0]
    return found


def excused(tool):
    """The findings of excused.txt, each of which stands above its reason."""
    lines = (HERE / "excused.txt").read_text().splitlines()
    return {line.removeprefix(f"{tool} ") for line in lines if line.startswith(f"{tool} ")}


TOOLS = {"gcc": gcc, "cppcheck": cppcheck, "clang-tidy": clang_tidy}


def main(tool, build, *beginnings):
    build, sources = Path(build).resolve(), ".c" if tool == "gcc" else ""
    beginnings = beginnings or ("lib/", "apps/")
    compiled = compilations(build, beginnings, sources)
    output = TOOLS[tool](compiled, build)
    found, excuses = findings_in(output), excused(tool)
    new = [line for finding, line in found.items() if finding not in excuses]
    stale = [line for line in excuses - set(found) if line.startswith((*beginnings, "test/"))]
    if new:
        print(output)
    for line in new:
        print("not excused:", line)
    for line in stale:
        print(f"excused.txt excuses what {tool} does not find:", line)
    print(f"{tool}: {len(compiled)} files, {len(new)} findings, {len(found) - len(new)} excused")
    return 1 if new or stale else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
