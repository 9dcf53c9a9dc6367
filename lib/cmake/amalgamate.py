"""Write the part of the library that needs nothing, core, health, localise, trust and select, as one vdna.h
and one vdna.c.

    amalgamate.py VERSION FOLDER HEADER_OR_SOURCE...

The headers come in the order in which they need one another, private ones, found in the folders of
the sources, where they are first included. Includes of the system stay where they are.
"""

import re
import sys
from pathlib import Path

PUBLIC = re.compile(r"^#include <vdna/(\w+\.h)>\n", re.M)
PRIVATE = re.compile(r'^#include "(\w+\.h)"\n', re.M)

TITLE = """/* vdna {version}, the part that needs nothing: histograms, distances, ranking,
 * selector, localisation, trust, frame health.
 * Written from lib/core, lib/health, lib/localise, lib/trust and lib/select by the CMake target `amalgamation`; change it there.
 *
 * Compile vdna.c as C99 with -std=c99, or with -ffp-contract=off: the same counts then give the
 * same bits on every machine.
 *
{licence} */
"""


def in_order(headers):
    """The names of the headers, each behind those that it includes."""
    ordered = []

    def place(name):
        if name not in ordered:
            for needed in PUBLIC.findall(headers[name]):
                place(needed)
            ordered.append(name)

    for name in headers:
        place(name)
    return ordered


def with_private_headers(sources):
    """The texts of the sources, and in them those of the private headers, each once."""
    seen = set()
    folders = {path.parent for path in sources}

    def header(name):
        (path,) = (folder / name for folder in folders if (folder / name).exists())
        return path

    def text_of(path):
        if path in seen:
            return ""
        seen.add(path)
        return PRIVATE.sub(lambda include: text_of(header(include[1])), path.read_text())

    return [text_of(path) for path in sources]


def write(path, title, parts):
    path.write_text("\n".join([title, *(PUBLIC.sub("", part) for part in parts)]))


def main():
    version, folder, *names = sys.argv[1:]
    paths = [Path(name).resolve() for name in names]
    headers = {path.name: path.read_text() for path in paths if path.suffix == ".h"}
    sources = [path for path in paths if path.suffix == ".c"]
    licence = Path(__file__).resolve().parents[2].joinpath("LICENSE").read_text()
    title = TITLE.format(version=version, licence="".join(
        f" * {line}".rstrip() + "\n" for line in licence.splitlines()))

    write(Path(folder, "vdna.h"), title, [headers[name] for name in in_order(headers)])
    write(Path(folder, "vdna.c"), title + '#include "vdna.h"\n', with_private_headers(sources))


if __name__ == "__main__":
    main()
