"""A user's two programs, built in one of the ways to use the library, print what they should.

    test_consumer.py WAY        a function of this file

Environment: as given by test/contract/package/CMakeLists.txt. Exit code 77 = skipped: a tool is missing.
"""

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
CONSUMER = HERE / "consumer" / "consumer.c"  # core and select
CHOOSE = ROOT / "apps" / "examples" / "choose.c"  # map as well
FIRST = ROOT / "apps" / "examples" / "first.c"  # shown in the README, with what it prints
BACKBONE = HERE / "backbone" / "backbone.c"  # libvdna_backbone
SMALL = ROOT / "test" / "machine" / "small"  # the additions of a machine without a C library
GREY_LEVELS = ROOT / "apps" / "examples" / "grey_levels.c"  # a plug-in for it

CC, CMAKE = os.environ["VDNA_CC"], os.environ["VDNA_CMAKE"]
STAGE, BUILD = Path(os.environ["VDNA_STAGE"]), Path(os.environ["VDNA_BUILD"])
PREFIX = STAGE / "prefix"
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run(command, check=True, text=True, **options)


def output_of(*command):
    return run(*command, stdout=subprocess.PIPE).stdout


def need(tool):
    if not shutil.which(tool):
        print(f"skipped: no {tool}; on Debian, ./dev installs it")
        sys.exit(77)


def build_with_cmake(scratch, *settings):
    project = scratch / "project"
    shutil.copytree(CONSUMER.parent, project)
    shutil.copy(CHOOSE, project)
    # A generator of its own choice: the user's.
    run(CMAKE, "-S", project, "-B", scratch / "build", f"-DCMAKE_C_COMPILER={CC}",
        "-DCMAKE_BUILD_TYPE=Release", *settings)
    run(CMAKE, "--build", scratch / "build", "--parallel", "2")
    return [(scratch / "build" / f"consumer{kind}", scratch / "build" / f"choose{kind}")
            for kind in ("", "_static")]


def find_package(scratch):
    return build_with_cmake(scratch, f"-DCMAKE_PREFIX_PATH={PREFIX}")


def subdirectory(scratch):
    programs = build_with_cmake(scratch, f"-DVDNA_SOURCE={ROOT}", "-DBUILD_SHARED_LIBS=ON")
    shared = {path.name for path in scratch.glob("build/**/*.so")}
    assert shared == {"libvdna.so"}, f"{shared}: a part of libvdna is a library of its own"
    installed = output_of(CMAKE, "--install", scratch / "build", "--prefix", scratch / "none")
    assert "vdna" not in installed, "a part of another project installs nothing of itself"
    return programs


def check_first(command, scratch):
    """The README's program, built by the same command, prints what the README says."""
    shutil.copy(FIRST, scratch)
    run("sh", "-c", command.replace("cc ", f"{CC} ", 1).replace("choose", "first"), cwd=scratch)
    printed = "".join(f"    {line}\n" for line in output_of(scratch / "first").splitlines())
    text = (ROOT / "README.md").read_text()
    assert printed and f"```\n\nprints\n\n{printed}\n" in text, printed


def readme(scratch):
    """By the commands of the pages that the README leads to, with this build's folder in place of
    theirs."""
    need("pkg-config")
    pages = [ROOT / "docs" / page for page in ("operating/install.md", "start/own-program.md")]
    commands = [line.strip() for page in pages for line in page.read_text().splitlines()
                if line.startswith("    ")]
    os.environ["HOME"] = str(scratch)
    os.environ["PKG_CONFIG_PATH"] = str(scratch / "vdna" / "lib" / "pkgconfig")
    os.environ["LD_LIBRARY_PATH"] = str(scratch / "vdna" / "lib")
    [install] = [command for command in commands if command.startswith("cmake --install build ")
                 and "--component" not in command]
    run("sh", "-c", install.replace(" build ", f" {BUILD} ", 1), cwd=scratch)
    programs = []
    for command in commands:
        if command.startswith("cc "):
            shutil.copy(CHOOSE, scratch)
            run("sh", "-c", command.replace("cc ", f"{CC} ", 1), cwd=scratch)
            programs.append((None, shutil.move(scratch / "choose", scratch / str(len(programs)))))
            check_first(command, scratch)
    assert len(programs) == 2, commands
    return programs


def pkg_config(scratch, *options, prefix=PREFIX):
    """Built by the compiler alone, with the flags that pkg-config gives."""
    need("pkg-config")
    [folder] = prefix.glob("lib/**/pkgconfig")
    os.environ["PKG_CONFIG_PATH"] = str(folder)
    flags = shlex.split(output_of("pkg-config", "--cflags", "--libs", *options, "vdna"))
    flags.append("-static" if options else f"-Wl,-rpath,{folder.parent}")
    for source in (CONSUMER, CHOOSE):
        run(CC, *STRICT, "-o", scratch / source.stem, source, *flags)
    return [(scratch / "consumer", scratch / "choose")]


def pkg_config_static(scratch):
    return pkg_config(scratch, "--static")


def deb(scratch):
    """From the packages libvdna0 and libvdna-dev, unpacked."""
    debs = [*STAGE.glob("debs/libvdna0_*.deb"), *STAGE.glob("debs/libvdna-dev_*.deb")]
    if not debs:
        need("dpkg-shlibdeps")
    for package in debs:
        run("dpkg", "-x", package, scratch / "root")
    prefix = scratch / "root" / "usr"
    return [*build_with_cmake(scratch, f"-DCMAKE_PREFIX_PATH={prefix}"),
            *pkg_config(scratch, prefix=prefix)]


def amalgamation(scratch):
    """One .c and one .h in a folder of the user's; without the map, so CHOOSE is left out."""
    shutil.copytree(BUILD / "amalgamation", scratch / "vdna")
    source = scratch / "vdna" / "vdna.c"
    for compiler in (CC, "clang-19"):
        if shutil.which(compiler):
            run(compiler, *STRICT, "-fsyntax-only", source)
    programs = []
    for level in ("-O0", "-O3"):
        program = scratch / f"consumer{level}"
        run(CC, "-std=c99", level, f"-I{scratch}", "-o", program, CONSUMER, source)
        programs.append((program, None))
    return programs


def freestanding(scratch):
    """What is installed, on a Cortex-M4 without a C library: the compiler's own headers and the two
    beside vdna.c, and in the program three functions."""
    compiler = "arm-none-eabi-gcc"
    need(compiler)
    installed = PREFIX / "share" / "vdna" / "amalgamation"
    shutil.copytree(installed, scratch / "vdna")
    own = output_of(compiler, "-print-file-name=include").strip()
    objects = []
    for source in (scratch / "vdna" / "vdna.c", SMALL / "start.c"):
        objects.append(scratch / f"{source.stem}.o")
        run(compiler, *STRICT, "-mcpu=cortex-m4", "-mthumb", "-Os", "-ffreestanding", "-nostdinc",
            "-isystem", own, "-isystem", scratch / "vdna" / "freestanding", "-c", source,
            "-o", objects[-1])
    run(compiler, "-mcpu=cortex-m4", "-mthumb", "-nostdlib", *objects, "-lgcc",
        "-o", scratch / "image")
    symbols = output_of("arm-none-eabi-nm", scratch / "image")
    assert " T vdna_rank\n" in symbols and " T vdna_select_feed\n" in symbols, symbols
    return []


def configure_backbone(scratch, prefix):
    project = scratch / "networks"
    shutil.copytree(BACKBONE.parent, project)
    shutil.copy(GREY_LEVELS, project)
    return subprocess.run(
        [CMAKE, "-S", project, "-B", scratch / "networks-build", f"-DCMAKE_C_COMPILER={CC}",
         "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={prefix}"],
        text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def check_backbone(program, plugin):
    found = output_of(program, plugin)
    assert found == "grey_levels levels:16:1\n0.5 0.5 127.5\nok\n", found


def backbone_find_package(scratch):
    """A program and a plug-in on vdna::backbone; ONNX Runtime and the networks of its installation."""
    configured = configure_backbone(scratch, PREFIX)
    assert configured.returncode == 0, configured.stdout
    build = scratch / "networks-build"
    run(CMAKE, "--build", build)
    check_backbone(build / "backbone", build / "grey_levels.so")
    if (PREFIX / "share" / "vdna" / "models").exists():
        for name in ("VDNA_MODELS", "VDNA_ONNXRUNTIME"):
            os.environ.pop(name, None)
        said = run(build / "backbone", "efficientnet_lite0", stdout=subprocess.PIPE,
                   env={**os.environ, "LD_DEBUG": "files"}, stderr=subprocess.PIPE)
        assert said.stdout.startswith("efficientnet_lite0 embedding:1280:1\n"), said.stdout
        assert f"file={PREFIX}/lib/vdna/libonnxruntime.so" in said.stderr
    return []


def backbone_pkg_config(scratch, prefix=PREFIX):
    need("pkg-config")
    [folder] = prefix.glob("lib/**/pkgconfig")
    os.environ["PKG_CONFIG_PATH"] = str(folder)
    flags = shlex.split(output_of("pkg-config", "--cflags", "--libs", "vdna-backbone"))
    flags.append(f"-Wl,-rpath,{folder.parent}")
    run(CC, *STRICT, "-o", scratch / "backbone", BACKBONE, *flags)
    run(CC, *STRICT, "-shared", "-fPIC", "-o", scratch / "mine.so", GREY_LEVELS, *flags)
    check_backbone(scratch / "backbone", scratch / "mine.so")
    return []


def backbone_deb(scratch):
    """From the four packages of the libraries; without those of the backbone, CMake says so."""
    prefix = scratch / "root" / "usr"
    for names in (("libvdna0", "libvdna-dev"), ("libvdna-backbone0", "libvdna-backbone-dev")):
        debs = [deb for name in names for deb in STAGE.glob(f"debs/{name}_*.deb")]
        if not debs:
            need("dpkg-shlibdeps")
        for package in debs:
            run("dpkg", "-x", package, scratch / "root")
        if names[0] == "libvdna0":
            refused = configure_backbone(scratch / "without", prefix)
            assert refused.returncode != 0
            assert "installed here without its component backbone" in refused.stdout.replace(
                "\n", " ").replace("  ", " "), refused.stdout
    return backbone_pkg_config(scratch, prefix)


def main():
    way = sys.argv[1]
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        run(os.environ["VDNA_MAKE_EXPERIENCES"], scratch)
        files = [scratch / f"{name}.vdna" for name in ("live", "far", "near")]
        expected = output_of(os.environ["VDNA_CONSUMER"])
        expected_choice = output_of(os.environ["VDNA_CHOOSE"], *files)
        assert expected_choice.startswith("near "), expected_choice

        for consumer, choose in globals()[way](scratch):
            if consumer:
                found = output_of(consumer)
                assert found == expected, f"{found}\nexpected\n{expected}"
            if choose:
                found = output_of(choose, *files)
                assert found == expected_choice, f"{found}\nexpected\n{expected_choice}"


if __name__ == "__main__":
    main()
