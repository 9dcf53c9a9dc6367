"""Our messages in another language: what lcm-gen writes for each type compiles, decodes what our
programs encode, and encodes the same bytes.

    round_trips.py LANGUAGE [TOOL]

LANGUAGE is c, cpp, python, java, lua, csharp or go. Each is tried with the lcm-gen of the build and
that of PyPI, whose output differs. All that is made goes to $VDNA_WORK.
"""

import itertools
import os
import re
import sys
from pathlib import Path

import spec_lcm
from tools import fresh, require_tool, run, skip, virtual_environment

HERE = Path(__file__).resolve().parent
WORK = Path(os.environ["VDNA_WORK"])
LANGUAGE = sys.argv[1]
FOLDER = WORK / LANGUAGE
LCMTYPES = spec_lcm.SOURCE / "lcmtypes"
sys.path.insert(0, str(LCMTYPES))
import message_table  # noqa: E402

TYPES = [line.split()[0] for line in (LCMTYPES / "fingerprints.txt").read_text().splitlines()]
# The only types that Go can have; see SPEC-lcm.
GO_TYPES = [name for name in TYPES if name.startswith("vdna_msg.")]
WARNINGS = ("-Wall", "-Werror")

# What lcm-gen defines beside members and constants, where these are in one space of names.
GENERATED = {
    "cpp": r"^ +inline (?:static )?[\w:]+ ?[ *](\w+)\(",
    "python": r"^    def (\w+)\(",
    "java": r"^    public (?:static |final )*[\w.]+ (\w+\(|LCM_\w+)",
    "lua": r"^(?:function \w+_t[.:](\w+)|\w+_t\.(\w+) =)",
    "csharp": r"^ +public (?:static |readonly )*[\w.]+ (\w+\(|LCM_\w+)",
    "go": r"^func \(\w+ \*?\w+\) (?!\w+Get\()(\w+)\(",
}


def generate(*options):
    """Run both versions of lcm-gen on all files; give the folder of each, and of its programs."""
    yield generate_with(Path(os.environ["VDNA_LCM_GEN"]), "build", options)
    # Without a network, what comes before this is tested all the same.
    yield generate_with(pypi() / "lcm-gen", "pypi", options)


def generate_with(lcm_gen, name, options):
    generated = fresh(FOLDER / name / "generated")
    run(lcm_gen, *(option.format(generated) for option in options), *sorted(LCMTYPES.glob("*.lcm")))
    check_names(generated)
    return generated, lcm_gen.parent


def pypi():
    return virtual_environment(WORK / "environment", "lcm==1.5.3")


def check_names(generated):
    """All that lcm-gen defines is reserved, so that no member takes its name."""
    if LANGUAGE not in GENERATED:
        return
    pattern = re.compile(GENERATED[LANGUAGE], re.M)
    found = {name.rstrip("(") for path in generated.rglob("*") if path.is_file()
             for match in pattern.finditer(path.read_text()) for name in match.groups() if name}
    found = {name for name in found if not name.startswith("_")}
    missing = {name for name in found if message_table.spelling(name) not in message_table.RESERVED}
    if not found or missing:
        sys.exit(f"lcm-gen's {LANGUAGE} defines {sorted(found)}; add to lcmtypes/reserved.txt: "
                 f"{sorted(missing)}")


def write_samples():
    samples = fresh(FOLDER / "samples")
    run(os.environ["VDNA_WRITE_SAMPLES"], samples)
    written = sorted(path.name for path in samples.iterdir())
    if written != sorted(TYPES):
        sys.exit(f"write_samples wrote {written}, fingerprints.txt has {TYPES}; add the sample to "
                 "write_samples.c")
    return samples


def round_trip(program, *arguments, types=tuple(TYPES), **options):
    """Run the program on the samples: it must write the same bytes."""
    samples, out = write_samples(), fresh(FOLDER / "out")
    run(*program, samples, out, *arguments, **options)
    written = {path.name: path.read_bytes() for path in out.iterdir()}
    for name in types:
        sample = (samples / name).read_bytes()
        if written.get(name) != sample:
            sys.exit(f"{name}: encoded as {written.get(name, b'').hex()}, expected {sample.hex()}")
    print(f"{LANGUAGE}: {', '.join(types)}: the same bytes")


def write_types(generated, header):
    """<messages.h> for round_trip.c and .cpp."""
    types = [name.split(".") for name in TYPES]
    lines = [f"#include <{header.format(*name)}>\n" for name in types]
    lines += ["#define MESSAGES", *(" MESSAGE({}, {})".format(*name) for name in types), "\n"]
    (generated / "messages.h").write_text("".join(lines))


def c(compiler):
    for generated, _ in generate("--c", "--c-cpath={}", "--c-hpath={}"):
        write_types(generated, "{}_{}.h")
        program = generated / "round_trip"
        run(compiler, "-std=c99", *WARNINGS, "-isystem", generated, "-o", program,
            HERE / "round_trip.c", *generated.glob("*.c"), "-llcm")
        round_trip([program])


def cpp(compiler):
    for generated, programs in generate("--cpp", "--cpp-hpath={}"):
        write_types(generated, "{}/{}.hpp")
        program = generated / "round_trip"
        # The headers of LCM beside its lcm-gen; PyPI's are in a folder of the virtual environment.
        headers = [path for name in programs.parent.glob("lib/python*/site-packages/include")
                   for path in ("-isystem", name)]
        run(compiler, "-std=c++17", *WARNINGS, "-isystem", generated, *headers, "-o", program,
            HERE / "round_trip.cpp")
        round_trip([program])


def python():
    for generated, _ in generate("--python", "--ppath={}"):
        round_trip([sys.executable, HERE / "round_trip.py"],
                   env={**os.environ, "PYTHONPATH": str(generated)})


def java(javac, *types_jar):
    """With the JAR of SPEC-lcm, and that of the package `vdna`."""
    require_tool(javac, "javac")
    if not spec_lcm.LCM_JAR.exists():
        skip("no liblcm-java; ./dev test --all installs it")
    for generated, programs in generate("--java", "--jpath={}"):
        folder = spec_lcm.in_a_checkout(fresh(generated.parent / "jar"))
        jar = spec_lcm.build_jar(folder, spec_lcm.with_path(programs))
        classes = fresh(generated.parent / "classes")
        run(javac, "-cp", spec_lcm.LCM_JAR, "-d", classes, HERE / "RoundTrip.java")
        lcm_jars = [spec_lcm.LCM_JAR, *WORK.glob("environment/lib/**/share/java/lcm.jar")]
        for lcm_jar, types in itertools.product(lcm_jars, (jar, *types_jar)):
            round_trip([Path(javac).with_name("java"), "-cp", f"{lcm_jar}:{classes}:{types}",
                        "RoundTrip"])


def lua(interpreter):
    require_tool(interpreter, "lua5.3")
    for generated, _ in generate("--lua", "--lpath={}"):
        path = f"{HERE}/?.lua;{generated}/?.lua"
        round_trip([interpreter, HERE / "round_trip.lua"], *TYPES,
                   env={**os.environ, "LUA_PATH": path})


def csharp(mcs):
    require_tool(mcs, "mcs")
    for generated, _ in generate("--csharp", "--csharp-path={}"):
        program = generated / "round_trip.exe"
        run(mcs, "-warnaserror", f"-out:{program}", HERE / "RoundTrip.cs", HERE / "Lcm.cs",
            *generated.rglob("*.cs"))
        round_trip(["mono", program])


def go_type(name):
    """VdnaMsgStatusT, of vdna_msg.status_t."""
    return "".join(word.capitalize() for word in re.split("[._]", name))


def go(tool):
    require_tool(tool, "go", "install one, in any way")
    folder = spec_lcm.in_a_checkout(fresh(FOLDER / "checkout"))
    (block,) = spec_lcm.commands("Other languages")
    spec_lcm.shell(block, folder, spec_lcm.with_path(pypi()))
    module = folder / "build/go"
    check_names(module)
    (module / "go.mod").write_text("module example\n\ngo 1.19\n")
    (module / "main.go").write_bytes((HERE / "round_trip.go").read_bytes())
    entries = "".join(f'\t"{name}": new(vdna_msg.{go_type(name)}),\n' for name in GO_TYPES)
    (module / "messages.go").write_text(
        'package main\n\nimport "example/vdna_msg"\n\n'
        f"var messages = map[string]message{{\n{entries}}}\n")
    program = module / "round_trip"
    run(tool, "build", "-o", program, ".", cwd=module,
        env={**os.environ, "GOTOOLCHAIN": "local"})
    round_trip([program], types=GO_TYPES)


def comments():
    """Generated code has the comments of the .lcm files at the members they explain."""
    explained = re.compile(r"^ +// ([^\n]+)\n +(?!const)\w+ (\w+)(?:\[\w+\])?;", re.M)
    (_, (generated, _)) = generate("--cpp", "--cpp-hpath={}")
    for path in sorted(LCMTYPES.glob("*.lcm")):
        header = "".join(path.read_text() for path in generated.rglob("*.hpp"))
        for comment, member in explained.findall(path.read_text()):
            pattern = rf"{re.escape(comment)}\n[^;]*?\*/\s+[\w:<> ]+ {member}(?:\[\d+\])?;"
            if not re.search(pattern, header):
                sys.exit(f"{path.name}: {member} has lost its comment '{comment}'")


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
