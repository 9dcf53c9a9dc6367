"""From one robot's directory to the traversals of a fleet; vdna-fleet is the program.

Needs the packages of `pip install libvdna[fleet]`. A Collection is a folder under a URI; the functions
here fill and search it on any concurrent.futures.Executor, or on Ray with `pip install libvdna[ray]`:

    collection = Collection("/data/fleet")
    build(collection, [Source.of("monday.vdna")], local(), "vdna")
    update(collection, collection.only_comparable(), local())
    dna = libvdna.Experience.open("now.vdna")
    nearest(collection, dna.histogram, dna.comparable, k=5, where=[("route", "==", "ring")])
"""

from .sources import Ended, Source, build, calibrate, merge, merged_ranges, rebin, rebinned
from .collection import Collection, DamagedObject, Labels
from .engine import Engine, RayExecutor, local, on_ray, run
from .index import Index, Indexed, Where, update
from .search import (
    Duplicate,
    Duplicates,
    Found,
    FoundFor,
    Neighbour,
    Pairs,
    duplicates,
    nearest,
    nearest_of_each,
    pairs,
)
from .subset import Shipped, ship

__all__ = [
    "Collection",
    "DamagedObject",
    "Duplicate",
    "Duplicates",
    "Ended",
    "Engine",
    "Found",
    "FoundFor",
    "Index",
    "Indexed",
    "Labels",
    "Neighbour",
    "Pairs",
    "RayExecutor",
    "Shipped",
    "Source",
    "Where",
    "build",
    "calibrate",
    "duplicates",
    "local",
    "merge",
    "merged_ranges",
    "nearest",
    "nearest_of_each",
    "on_ray",
    "pairs",
    "rebin",
    "rebinned",
    "run",
    "ship",
    "update",
]
