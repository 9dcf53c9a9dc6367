"""The program vdna-mcap."""

from __future__ import annotations

import argparse
import sys
from typing import Optional, Sequence


def _printable(text: str) -> str:
    """A text of the log on one line, without what moves a terminal's cursor."""
    return "".join(
        one if one.isprintable() else one.encode("unicode_escape").decode() for one in text
    )


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Gives the exit status, see --help."""
    parser = argparse.ArgumentParser(
        prog="vdna-mcap",
        description="Turn an LCM log into an MCAP file for Foxglove and Rerun: camera messages as "
        "pictures, answers of vdna_selectord as typed columns, positions as locations.",
        epilog="Exit status: 0 = all of the log is in the file, 1 = not converted, 3 = converted, "
        "but some of the log was left out, as standard error says.",
    )
    parser.add_argument("log", metavar="LOG", help="as lcm-logger writes it")
    parser.add_argument("out", metavar="OUT.mcap", help="the file to write; replaced if it exists")
    parser.add_argument(
        "--types",
        metavar="PATH",
        action="append",
        default=[],
        help="a .lcm file, or a folder with such, of further types in the log; may be repeated",
    )
    options = parser.parse_args(arguments)
    try:
        # Here, so that --help needs no packages.
        from .mcap import convert

        done = convert(options.log, options.out, options.types)
    except (ImportError, ValueError, OSError) as failure:
        print(f"vdna-mcap: {_printable(str(failure))}", file=sys.stderr)
        return 1
    for (topic, schema), count in done.topics.items():
        print(f"{_printable(topic)}: {count} {schema}")
    for sentence in done.left_out:
        print(f"vdna-mcap: {options.log}: {_printable(sentence)}", file=sys.stderr)
    return 3 if done.left_out else 0


if __name__ == "__main__":
    sys.exit(main())
