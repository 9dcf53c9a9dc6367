"""The program vdna-fleet."""

from __future__ import annotations

import argparse
import csv
import re
import sys
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple

if TYPE_CHECKING:
    from . import fleet

_CONDITION = re.compile(r"(\w+)(==|!=|<=|>=|=|<|>)(.*)", re.DOTALL)
_NUMBERS = ("first_utime", "last_utime", "frames", "size", "object_size")


def _condition(text: str) -> Tuple[str, str, Any]:
    """COLUMN=VALUE as a condition on the index."""
    parts = _CONDITION.fullmatch(text)
    if not parts:
        raise argparse.ArgumentTypeError(f"{text!r}: expected COLUMN=VALUE, or !=, <, <=, >, >=")
    column, sign, value = parts.groups()
    try:
        number = int(value) if column in _NUMBERS else value
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: {column} is a whole number") from None
    return column, "==" if sign == "=" else sign, number


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="vdna-fleet",
        description="Keep and search the experiences of many robots: a collection is a folder, local"
        " or in an object store. docs/operating/fleet.md is the guide.",
        epilog="Exit status: 0 = done, 1 = not done, 2 = wrong usage, 3 = done, but something was left"
        " out, as standard error says. A command that was interrupted goes on where it was when it is"
        " given again.",
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    every = argparse.ArgumentParser(add_help=False)
    every.add_argument("uri", metavar="URI", help="of the collection: a path, or any of fsspec")
    every.add_argument(
        "--engine", choices=("local", "ray"), default="local",
        help="processes of this machine, or Ray: the cluster of $RAY_ADDRESS, else this machine"
        " (default: local)",
    )  # fmt: skip
    every.add_argument(
        "--workers", type=int, metavar="N", help="tasks at a time (default: one for each core)"
    )
    stored = argparse.ArgumentParser(add_help=False)
    stored.add_argument(
        "--comparable", metavar="HASH",
        help="which, if the collection has several; its beginning will do",
    )  # fmt: skip
    where = argparse.ArgumentParser(add_help=False)
    where.add_argument(
        "--where", type=_condition, action="append", metavar="COLUMN=VALUE",
        help="only these: name, route, condition, first_utime, last_utime, frames, size; also !=, <,"
        " <=, >, >=; may be repeated, all must hold",
    )  # fmt: skip
    recordings = argparse.ArgumentParser(add_help=False)
    recordings.add_argument(
        "--vdna", metavar="PROGRAM", default="vdna", help="the program vdna (default: that of $PATH)"
    )

    def command(name: str, text: str, *parents: argparse.ArgumentParser) -> argparse.ArgumentParser:
        return commands.add_parser(name, help=text, description=text + ".", parents=[every, *parents])

    one = command("calibrate", "Find the ranges of the collection from recordings", recordings)
    one.add_argument("sources", metavar="SOURCE", nargs="+", help="as for vdna calibrate")
    one = command("build", "Add experiences", recordings)
    one.add_argument(
        "sources", metavar="SOURCE", nargs="*", help="an experience file, or as for vdna build"
    )
    one.add_argument("--route", default="", help="of every SOURCE")
    one.add_argument("--condition", default="", help="of every SOURCE")
    one.add_argument(
        "--table", metavar="FILE.csv", help="more sources: columns source, route, condition, name"
    )
    one = command("merge", "Add the experiences of other collections")
    one.add_argument("others", metavar="OTHER", nargs="+", help="URI of a collection")
    command("rebin", "Count the experiences again in the bins of the collection's ranges", stored)
    command("index", "Give every experience a row in the index", stored)
    one = command("nearest", "Find the experiences nearest to others", where)
    one.add_argument("files", metavar="FILE.vdna", nargs="+", help="an experience file; each is a task")
    one.add_argument("-k", type=int, default=5, help="how many (default: 5)")
    one = command("pairs", "Write the distances of all pairs", stored, where)
    one.add_argument("out", metavar="OUT.parquet", help="columns a, b, distance_bins")
    one = command("duplicates", "Find experiences that an earlier one of their route repeats", stored, where)
    one.add_argument("--within", type=float, metavar="BINS", default=0.0,
                     help="no further away than this (default: 0, the same Visual DNA)")  # fmt: skip
    one.add_argument("--drop", action="store_true", help="remove them from the collection")
    one = command("ship", "Write the subset that loses least recall as a map", stored, where)
    one.add_argument("out", metavar="MAP", help="folder to write; must not have experiences yet")
    one.add_argument("--budget", type=int, metavar="BYTES", required=True, help="of its files")
    one.add_argument("--tolerance", type=float, default=5.0, metavar="T",
                     help="metres or place numbers within which frames show one place (default: 5)")  # fmt: skip
    return parser


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Gives the exit status, see --help."""
    options = _parser().parse_args(arguments)
    try:
        # Here, so that --help needs no packages.
        from . import fleet

        collection = fleet.Collection(options.uri)
        engine = (fleet.on_ray if options.engine == "ray" else fleet.local)(options.workers)
        left_out = _COMMANDS[options.command](options, collection, engine)
    except Exception as failure:
        print(f"vdna-fleet: {failure}", file=sys.stderr)
        return 1
    for sentence in left_out:
        print(f"vdna-fleet: {sentence}", file=sys.stderr)
    return 3 if left_out else 0


def _calibrate(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    ended = fleet.calibrate(collection, options.sources, engine, options.vdna)
    if ended.failures:
        raise ValueError("\n".join([*ended.failures, "no ranges were written"]))
    print(f"{collection.uri}/ranges.json: of {len(options.sources)} recordings")
    return []


def _build(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    labels = fleet.Labels(options.route, options.condition)
    sources = [fleet.Source.of(path, labels) for path in options.sources]
    if options.table:
        with open(options.table, newline="", encoding="utf-8") as file:
            sources += [_source_of(row) for row in csv.DictReader(file)]
    names = [source.name for source in sources]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"{', '.join(twice)}: named twice; give names by the column name of --table")
    ended = fleet.build(collection, sources, engine, options.vdna)
    print(f"{collection.uri}: {ended.made} experiences added, {ended.there} were there")
    return ended.failures


def _source_of(row: Any) -> fleet.Source:
    from . import fleet

    labels = fleet.Labels(row.get("route") or "", row.get("condition") or "")
    source = fleet.Source.of(row["source"], labels)
    return source._replace(name=row["name"]) if row.get("name") else source


def _merge(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    ended = fleet.merge(collection, options.others, engine)
    print(f"{collection.uri}: {ended.made} experiences added, {ended.there} were there")
    return ended.failures


def _rebin(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    ended = fleet.rebin(collection, collection.only_comparable(options.comparable), engine)
    print(f"{collection.uri}: {ended.made} experiences counted again, {ended.there} were there")
    return ended.failures


def _index(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    left_out: List[str] = []
    for comparable in collection.comparables():
        if comparable.startswith(options.comparable or ""):
            done = fleet.update(collection, comparable, engine)
            print(f"{comparable[:12]}: {done.rows} rows, {done.added} new, {done.removed} removed")
            left_out += done.damaged
    return left_out


def _nearest(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    several = len(options.files) > 1
    results = fleet.nearest_of_each(
        collection, options.files, engine if several else _here, options.k, options.where
    )
    left_out = [one.failure for one in results if not one.found]
    if len(left_out) == len(results):
        raise ValueError("\n".join(left_out))
    for path, found, _ in results:
        if not found:
            continue
        for neighbour in found.neighbours:
            print(f"{neighbour.distance_bins:9.4f} {neighbour.name}" + (f" to {path}" if several else ""))
        print(
            f"{found.exact} of {found.candidates} distances computed, {found.bytes_read} bytes read",
            file=sys.stderr,
        )
        left_out += found.damaged
    return left_out


def _here() -> Executor:
    """An engine for what is not worth a process."""
    return ThreadPoolExecutor(1)


def _pairs(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    comparable = collection.only_comparable(options.comparable)
    done = fleet.pairs(collection, comparable, options.out, engine, options.where)
    print(f"{options.out}: {done.pairs} pairs")
    return done.failures


def _duplicates(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    comparable = collection.only_comparable(options.comparable)
    done = fleet.duplicates(collection, comparable, options.within, engine, options.where)
    for one in done.duplicates:
        print(f"{one.distance_bins:9.4f} {one.name} repeats {one.of}")
        if options.drop:
            collection.remove(collection.object_key(comparable, one.name))
    if options.drop and done.duplicates:
        fleet.update(collection, comparable, engine)
    print(f"{done.exact} of {done.pairs} distances computed", file=sys.stderr)
    return done.damaged


def _ship(options: Any, collection: fleet.Collection, engine: fleet.Engine) -> List[str]:
    from . import fleet

    comparable = collection.only_comparable(options.comparable)
    done = fleet.ship(
        collection, comparable, options.out, options.budget, engine, options.where, options.tolerance
    )
    print(f"{options.out}: {len(done.names)} experiences, {done.size} bytes")
    for route, (worth, whole) in done.worth.items():
        what = "expected recall" if done.by[route] == "recall" else "nearness, for want of labels"
        print(f"{route or 'no route'}: {what} {worth:.3f} of {whole:.3f} with all")
    print(f"at least {100 * done.best_share:.1f} % of the best subset's", file=sys.stderr)
    return done.damaged


_COMMANDS = {
    "calibrate": _calibrate,
    "build": _build,
    "merge": _merge,
    "rebin": _rebin,
    "index": _index,
    "nearest": _nearest,
    "pairs": _pairs,
    "duplicates": _duplicates,
    "ship": _ship,
}
