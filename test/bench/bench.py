#!/usr/bin/python3
"""Measure speed and memory beside peers in the same run (./dev bench).

Prints a table and keeps it in build/bench/MACHINE.json, in which a group that is measured again
replaces its old results. With --write-page, docs/reference/performance.md, docs/internals/memory.md,
their plots and the README's are made from that file.
"""
import argparse
import importlib
import json
import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
GROUPS = {"core": "group_core", "localise": "group_localise", "frame": "group_frame",
          "files": "group_files", "add": "group_add", "growth": "group_growth",
          "sizes": "group_sizes", "arm": "group_arm", "footprint": "group_footprint",
          "start": "group_start", "drive": "group_drive", "stages": "group_stages",
          "fleet": "group_fleet"}
FORMAT = 1  # of the JSON file
sys.dont_write_bytecode = True


def parsed():
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("groups", nargs="*", metavar="GROUP",
                        help=f"groups to measure; default: all of {' '.join(GROUPS)}")
    parser.add_argument("--quick", action="store_true", help="ten minutes at most")
    parser.add_argument("--peers", action="store_true",
                        help="first install the packages to compare with, from PyPI (3 GB)")
    parser.add_argument("--write-page", action="store_true",
                        help="measure nothing: write performance.md, memory.md and "
                             "gains.svg in docs from earlier measurements")
    parser.add_argument("--no-peers", action="store_true", help="skip peers, even installed ones")
    parser.add_argument("--tiny", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--build", type=Path, default=ROOT / "build", help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, help="another file than build/bench/MACHINE.json")
    options = parser.parse_args()
    for name in options.groups:
        if name not in GROUPS:
            parser.error(f"there is no group {name}; there are {' '.join(GROUPS)}")
    return options


class Context:
    """Tools and settings of the groups."""

    def __init__(self, options, build):
        from ours import Library
        from peers import Peers
        from scene import Scene
        self.build, self.tiny, self.quick = build, options.tiny, options.quick or options.tiny
        self.seconds = 0.01 if options.tiny else 0.5 if options.quick else 3.0
        self.library, self.peers, self.scene = Library(build), Peers(), Scene(build)
        self.packages = {}


def result(name, unit, scale, timed, more):
    """A result in its stored form: all times in its unit."""
    peers = {peer: {"median": scale * numbers["median"], "speedup": numbers["speedup"]}
             for peer, numbers in timed["peers"].items()}
    scaled = {key: scale * timed[key] for key in ("median", "least", "most")}
    return {"name": name, "unit": unit, **scaled, "rounds": timed["rounds"],
            "waited": round(timed["waited"], 4), "peers": peers, "more": more}


def print_result(entry):
    print(f"{entry['name']:<52} {entry['median']:>10.3f} {entry['unit']}", flush=True)
    for peer, numbers in entry["peers"].items():
        print(f"  {peer:<50} {numbers['median']:>10.3f}   ours is {numbers['speedup']:.2f} x "
              f"as {'small' if entry['unit'] == 'MiB' else 'fast'}", flush=True)
    for key, value in entry["more"].items():
        if not isinstance(value, (list, dict)):
            print(f"  {key:<50} {value:>10.4g}", flush=True)


def measure(context, name):
    """Run a group: yields its stored form after each result."""
    import machine
    print(f"\n{name} (load {machine.load()})", flush=True)
    about = {"date": machine.now(), "commit": machine.commit(), "quick": context.quick,
             "load_begin": machine.load(), "versions": machine.versions(context.library.vdna)}
    results = []
    for measured in importlib.import_module(GROUPS[name]).run(context):
        results.append(result(*measured))
        print_result(results[-1])
        yield {**about, "load_end": machine.load(), "results": results}


def stored(path):
    """Earlier measurements on this machine."""
    if path.exists():
        kept = json.loads(path.read_text(encoding="utf-8"))
        if kept.get("format") == FORMAT:
            return kept
    return {"format": FORMAT, "groups": {}}


def write_pages(kept, docs):
    """The pages of the measurements, and the README's picture."""
    import gains
    import page_memory
    import page_performance
    if not kept["groups"]:
        raise SystemExit("nothing was measured yet; run ./dev bench first")
    page_performance.write(kept, docs / "reference")
    page_memory.write(kept, docs / "internals")
    gains.write(kept, docs)


def main():
    options = parsed()
    build = options.build.resolve()
    sys.path[:0] = [str(HERE), str(ROOT / "test" / "system")]
    import machine
    path = options.out or build / "bench" / machine.file_name()
    if options.write_page:
        write_pages(stored(path), ROOT / "docs")
        return

    # Everything but the networks runs on one thread, peers too.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    groups = options.groups or list(GROUPS)
    if not options.no_peers:
        import peers
        peers.enter(build, options.peers)
    if {"drive", "stages"} & set(groups) and not options.tiny:
        from scene import NETWORKS, Scene
        Scene(build).int8_manifest(next(iter(NETWORKS)))  # fetches the quantiser: later, no network
    if "fleet" in groups and not options.tiny:
        import group_fleet
        from scene import Scene
        group_fleet.programs(Scene(build))  # likewise
    if {"footprint", "start", "drive", "stages"} & set(groups):
        os.environ["VDNA_BIN"] = str(build / "bin")
        import own_network
        own_network.enter()
    machine.pin()
    context = Context(options, build)
    for name in groups:
        kept = stored(path)
        kept["machine"] = machine.describe()
        path.parent.mkdir(parents=True, exist_ok=True)
        for kept["groups"][name] in measure(context, name):
            path.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    print(f"\nkept in {path}")
    import figures
    figures.print_all(stored(path))


if __name__ == "__main__":
    main()
