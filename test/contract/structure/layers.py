"""Fails if a room of lib/ or apps/ includes or links anything that its floor does not permit, if a
permission is not used, or if two rooms share a C++ namespace. docs/internals/DESIGN.md explains the floors.

    layers.py ROOT
"""

import re
import sys
from pathlib import Path

# room: (floor, the rooms that it may use); a room may use its own files.
ROOMS = {
    "lib/checksum": (1, []),
    "lib/core": (1, []),
    "lib/fail": (2, ["lib/core"]),
    "lib/baseline": (2, ["lib/core"]),
    "lib/geodesy": (2, ["lib/core"]),
    "lib/health": (2, ["lib/core"]),
    "lib/localise": (2, ["lib/core"]),
    "lib/trust": (2, ["lib/core"]),
    "lib/identity": (3, ["lib/core", "lib/fail"]),
    "lib/picture": (3, ["lib/core", "lib/fail"]),
    "lib/replace": (3, ["lib/core", "lib/fail"]),
    "lib/backbone": (4, ["lib/core", "lib/fail", "lib/health", "lib/identity", "lib/picture"]),
    "lib/map": (4, ["lib/checksum", "lib/core", "lib/fail", "lib/geodesy", "lib/identity", "lib/localise",
                    "lib/replace", "lib/trust"]),
    "lib/select": (3, ["lib/core", "lib/localise", "lib/trust"]),
    "lib/transport": (3, ["lib/checksum", "lib/core", "lib/fail"]),
    "lib/cpp": (5, ["lib/backbone", "lib/core", "lib/identity", "lib/localise", "lib/map",
                    "lib/picture", "lib/select", "lib/transport", "lib/trust"]),
    "apps/program": (6, ["lib/cpp", "lib/replace"]),
    "apps/usage": (6, []),
    "apps/frames": (7, ["apps/program", "lib/core", "lib/cpp", "lib/fail", "lib/geodesy",
                        "lib/identity", "lib/map", "lib/picture",
                        "lib/transport"]),
    "apps/simulate": (7, ["apps/program", "lib/cpp"]),
    "apps/telemetry": (7, ["apps/program", "lib/cpp", "lib/transport"]),
    "apps/watch": (8, ["apps/program", "apps/telemetry", "lib/cpp"]),
    "apps/record": (8, ["apps/frames", "apps/program", "lib/backbone", "lib/core", "lib/cpp",
                        "lib/geodesy", "lib/health", "lib/localise", "lib/map", "lib/picture",
                        "lib/select", "lib/trust"]),
    "apps/doctor": (9, ["apps/program", "apps/record", "apps/telemetry", "lib/backbone", "lib/core",
                        "lib/cpp", "lib/transport"]),
    "apps/eval": (9, ["apps/frames", "apps/program", "apps/record", "lib/backbone", "lib/baseline",
                      "lib/core", "lib/cpp", "lib/localise", "lib/trust"]),
    "apps/report": (10, ["apps/eval", "apps/frames", "apps/program", "apps/record", "lib/core",
                         "lib/cpp", "lib/trust"]),
    "apps/vdna": (11, ["apps/doctor", "apps/eval", "apps/frames", "apps/program", "apps/record", "apps/report",
                       "apps/simulate", "apps/telemetry", "apps/usage", "apps/watch", "lib/backbone", "lib/core",
                       "lib/cpp", "lib/geodesy", "lib/localise", "lib/transport"]),
    "apps/selectord": (11, ["apps/program", "apps/telemetry", "apps/usage", "lib/backbone", "lib/core", "lib/cpp",
                            "lib/geodesy", "lib/health", "lib/identity", "lib/map", "lib/picture",
                            "lib/select", "lib/transport"]),
    "apps/serve": (11, ["apps/program", "apps/telemetry", "apps/usage", "lib/core", "lib/cpp",
                        "lib/map", "lib/picture", "lib/transport"]),
    "apps/manual": (12, ["apps/selectord", "apps/serve", "apps/usage", "apps/vdna", "lib/cpp"]),
}

# The public headers of rooms whose name they do not bear.
CORE_HEADERS = "activation bounds camera_time emd explain hist image int8 knn pixels range rank status version window"
HEADERS = {**{name: "lib/core" for name in CORE_HEADERS.split()},
           "experience_localise": "lib/map", "listener": "lib/transport", "map_trust": "lib/map",
           "message": "lib/transport", "parked": "lib/health"}
UMBRELLA = "vdna"

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.M)
NAMESPACE = re.compile(r"^namespace (vdna(?:::\w+)*)$", re.M)
LINK = re.compile(r"\b(?:vdna_|vdna::)(\w+)\b")


def room_of_public(name):
    """The room of <vdna/NAME>; None for the umbrella, which includes what libvdna has."""
    if name.startswith("cpp/"):
        return "lib/cpp"
    stem = name.removesuffix(".h")
    return None if stem == UMBRELLA else HEADERS.get(stem, "lib/" + stem)


def room_of_private(root, file, name):
    """The room of a quoted include: beside the file, {apps,lib}/ROOM/FILE or the one lib/*/FILE."""
    if (file.parent / name).is_file():
        return None
    for part in ("apps", "lib"):
        if (root / part / name).is_file():
            return part + "/" + name.split("/")[0]
    found = [path for path in root.glob("lib/*/" + name)]
    return str(found[0].parent.relative_to(root)) if found else None


def sources_of(root, room):
    if room == "lib/cpp":
        return sorted((root / "lib/include/vdna/cpp").glob("*.hpp"))
    files = sorted(path for path in (root / room).rglob("*") if path.suffix in {
        ".c", ".h", ".cpp", ".hpp"})
    public = [root / "lib/include/vdna" / (name + ".h")
              for name in [room.split("/")[1], *(n for n, r in HEADERS.items() if r == room)]]
    return files + ([path for path in public if path.is_file()] if room.startswith("lib/") else [])


def rooms_included(root, room):
    """(room, where) for each include of another room."""
    for file in sources_of(root, room):
        for include in INCLUDE.finditer(file.read_text()):
            name = include[2]
            if name.startswith("vdna/"):
                used = room_of_public(name.removeprefix("vdna/"))
                if used and used not in ROOMS:
                    used = room_of_private(root, file, name) or used
            else:
                used = room_of_private(root, file, name)
            if used and used != room:
                yield used, f"{file.relative_to(root)}: includes {name}"


def rooms_linked(root, room):
    """(room, where) for each target of another room in the folder's CMake file."""
    file = root / room / "CMakeLists.txt"
    text = re.sub(r"#.*", "", file.read_text())
    for call in re.finditer(r"(?:target_link_libraries|vdna_room)\(([^()]*)\)", text):
        for target in LINK.finditer(call[1]):
            for parent in ("lib/", "apps/"):
                used = parent + target[1]
                if used in ROOMS and used != room and not call[1].startswith(target[0]):
                    yield used, f"{room}/CMakeLists.txt: links {target[0]}"


def main():
    root = Path(sys.argv[1]).resolve()
    problems = []
    on_disk = {f"{part}/{path.parent.name}" for part in ("lib", "apps")
               for path in (root / part).glob("*/CMakeLists.txt")} - {
                   "apps/examples", "lib/python"}
    for room in sorted(on_disk ^ ROOMS.keys()):
        problems.append(f"{room}: is not in the table of {__file__}, or not on the disk")

    namespaces = {}
    for room, (floor, permitted) in ROOMS.items():
        if room not in on_disk:
            continue
        for lower in permitted:
            if ROOMS[lower][0] >= floor:
                problems.append(f"{room}: may use {lower}, which is not below it")
        used = set()
        for other, where in [*rooms_included(root, room), *rooms_linked(root, room)]:
            used.add(other)
            if other not in permitted:
                problems.append(f"{where}: {room} may not use {other}")
        for unused in sorted(set(permitted) - used):
            problems.append(f"{room}: is permitted to use {unused}, and does not: remove that")
        for file in sources_of(root, room):
            for name in NAMESPACE.findall(file.read_text()):
                namespaces.setdefault(name, set()).add(room)
    for name, rooms in namespaces.items():
        if len(rooms) > 1:
            problems.append(f"namespace {name}: shared by {', '.join(sorted(rooms))}")
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
