"""Exact searches that need few exact distances, because lower bounds rule most of them out."""

from __future__ import annotations

import hashlib
import heapq
import io
import json
import os
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import pyarrow as pa  # type: ignore[import-untyped,unused-ignore]
import pyarrow.parquet as pq  # type: ignore[import-untyped,unused-ignore]

from ..distance import emd_block, emd_mean
from ..experience import Experience
from ..histogram import HistogramView
from . import engine
from .collection import Collection, DamagedObject, batches, writing_local
from .index import Index, Summary, Where, bound_by_means

_BY_MEANS, _BY_SUMS, _EXACT = range(3)


class Neighbour(NamedTuple):
    """An experience of a collection, and how far away it is."""

    name: str
    distance_bins: float


class Found(NamedTuple):
    """The nearest of a collection, and what finding them took."""

    neighbours: List[Neighbour]
    """By ascending distance; equal ones in the order of the index."""
    candidates: int
    """Experiences where `where` held."""
    exact: int
    """Distances computed exactly."""
    bytes_read: int
    """Of the index and of objects."""
    damaged: List[str]
    """What was wrong with objects that were left out."""


def nearest(
    collection: Collection,
    dna: HistogramView,
    comparable: str,
    k: int = 5,
    where: Where = None,
) -> Found:
    """The `k` experiences nearest to a Visual DNA, exactly as if all distances had been computed.

    Best first: what has the least bound is looked at next, more closely each time: by the means, by
    the block sums, by the object itself. What comes up with an exact distance is the next neighbour,
    as all others are at least as far away. Block sums are read once: all of a group are then used.

    dna: must compare with `comparable`, as Experience.comparable says
    """
    read_before = collection.bytes_read
    index = Index(collection, comparable, where)
    live = Summary.of(dna)
    heap: List[Tuple[float, int, int]] = [
        (bound, _BY_MEANS, row)
        for row, bound in enumerate(bound_by_means(index.means, live.means, index.bins).tolist())
    ]
    heapq.heapify(heap)
    by_sums: Dict[int, float] = {}
    neighbours: List[Neighbour] = []
    exact, damaged = 0, []
    while heap and len(neighbours) < k:
        bound, level, row = heapq.heappop(heap)
        if level == _EXACT:
            neighbours.append(Neighbour(index.names[row], bound))
        elif level == _BY_MEANS:
            if row not in by_sums:
                for one in index.together(row):
                    by_sums[one] = live.bound(index.summary(one), index.bins)
            heapq.heappush(heap, (max(bound, by_sums[row]), _BY_SUMS, row))
        else:
            try:
                stored = index.load(row)
            except DamagedObject as damage:
                damaged.append(str(damage))
                continue
            exact += 1
            heapq.heappush(heap, (emd_mean(dna, stored.experience.histogram), _EXACT, row))
    read = collection.bytes_read - read_before
    return Found(neighbours, len(index.names), exact, read, damaged)


class FoundFor(NamedTuple):
    """The nearest of one live run among many."""

    path: str
    found: Optional[Found]
    """None if it failed."""
    failure: str
    """"" if it did not."""


def nearest_of_each(
    collection: Collection,
    paths: Sequence[str],
    run_on: engine.Engine,
    k: int = 5,
    where: Where = None,
) -> List[FoundFor]:
    """nearest() for many experience files, each a task."""
    tasks = [(collection.uri, os.path.abspath(path), k, where) for path in paths]
    return [
        FoundFor(path, done.result, done.failure)
        for path, done in zip(paths, engine.run(run_on, _nearest_of_file, tasks))
    ]


def _nearest_of_file(uri: str, path: str, k: int, where: Where) -> Found:
    """Task."""
    live = Experience.open(path)
    return nearest(Collection(uri), live.histogram, str(live.comparable), k, where)


class Duplicate(NamedTuple):
    """An experience that another one makes superfluous."""

    name: str
    of: str
    distance_bins: float


class Duplicates(NamedTuple):
    """What duplicates() found."""

    duplicates: List[Duplicate]
    pairs: int
    """Pairs on the same routes."""
    exact: int
    """Distances computed exactly."""
    damaged: List[str]


def duplicates(
    collection: Collection,
    comparable: str,
    within_bins: float,
    run_on: engine.Engine,
    where: Where = None,
) -> Duplicates:
    """Experiences no further than `within_bins` from an earlier one on the same route that is kept.

    Earlier: by first_utime, then by name. A task is a route.
    """
    routes = sorted(set(Index(collection, comparable, where).columns["route"]))
    tasks = [(collection.uri, comparable, within_bins, route, where) for route in routes]
    found: List[Duplicate] = []
    pairs = exact = 0
    damaged: List[str] = []
    for done in engine.run(run_on, _duplicates_of_route, tasks):
        if done.failure:
            damaged.append(f"{collection.uri}: route {done.arguments[3]!r}: {done.failure}")
            continue
        of_route: Duplicates = done.result
        found += of_route.duplicates
        pairs, exact = pairs + of_route.pairs, exact + of_route.exact
        damaged += of_route.damaged
    return Duplicates(found, pairs, exact, damaged)


def _duplicates_of_route(
    uri: str, comparable: str, within_bins: float, route: str, where: Where
) -> Duplicates:
    """Task."""
    on_route = [*(where or []), ("route", "==", route)]
    index = Index(Collection(uri), comparable, on_route)
    count = len(index.names)
    order = sorted(range(count), key=lambda row: (index.columns["first_utime"][row], index.names[row]))
    kept: List[int] = []
    found: List[Duplicate] = []
    damaged: Dict[int, str] = {}
    exact = 0
    for row in order:
        near = [
            other
            for other, bound in zip(
                kept, bound_by_means(index.means[kept], index.means[row], index.bins)
            )
            if bound <= within_bins
        ]
        experience: Optional[Experience] = None
        duplicate: Optional[Duplicate] = None
        summary = index.summary(row) if near else None
        for other in near:
            if summary and summary.bound(index.summary(other), index.bins) > within_bins:
                continue
            try:
                experience = experience or index.load(row).experience
            except DamagedObject as damage:
                damaged[row] = str(damage)
                break
            try:
                earlier = index.load(other).experience
            except DamagedObject as damage:
                damaged[other] = str(damage)
                continue
            exact += 1
            distance = emd_mean(experience.histogram, earlier.histogram)
            if distance <= within_bins:
                duplicate = Duplicate(index.names[row], index.names[other], distance)
                break
        if duplicate:
            found.append(duplicate)
        elif row not in damaged:
            kept.append(row)
    return Duplicates(found, count * (count - 1) // 2, exact, list(damaged.values()))


#: Most experiences whose pairs are computed without `where`: half a million pairs.
PAIRS_MAX = 1000
#: Experiences on either side of a task of pairs(): together 340 MB with 1280 neurons in 1000 bins.
#: Reading them takes longer than their distances; with half as many, all takes nearly twice as long.
_PAIRS_SIDE = 32


class Pairs(NamedTuple):
    """What pairs() did."""

    pairs: int
    failures: List[str]


def pairs(
    collection: Collection,
    comparable: str,
    out: str,
    run_on: engine.Engine,
    where: Where = None,
) -> Pairs:
    """Write the distances of all pairs to the Parquet file `out`, a local path: a, b, distance_bins.

    A task is a square of the table. ValueError: more than PAIRS_MAX experiences, and no `where`
    """
    collection.sweep()
    index = Index(collection, comparable, where)
    names, digests = index.names, index.columns["sha256"]
    if not where and len(names) > PAIRS_MAX:
        raise ValueError(
            f"{collection.uri}: {len(names)} experiences have {len(names) * (len(names) - 1) // 2}"
            f" pairs; choose some by --where, or at most {PAIRS_MAX} experiences"
        )
    folder = f"parts/pairs-{comparable}/{hashlib.sha256(json.dumps([names, digests]).encode()).hexdigest()}"
    blocks = list(batches(names, _PAIRS_SIDE))
    tasks = [
        (collection.uri, comparable, blocks[a], blocks[b], f"{folder}/{a}-{b}.parquet")
        for a in range(len(blocks))
        for b in range(a, len(blocks))
    ]
    done = engine.run(run_on, _pairs_of_blocks, tasks)
    failures = [f"{one.failure}" for one in done if one.failure]
    parts = [collection.get(one.arguments[-1]) for one in done if not one.failure]
    empty = _PAIRS_SCHEMA.empty_table()
    table = pa.concat_tables([empty, *(pq.read_table(io.BytesIO(part)) for part in parts)])
    with writing_local(out) as file:
        pq.write_table(table.sort_by([("a", "ascending"), ("b", "ascending")]), file)
    if not failures:
        collection.remove_folder(f"parts/pairs-{comparable}")
    return Pairs(table.num_rows, failures)


_PAIRS_SCHEMA = pa.schema(
    [("a", pa.string()), ("b", pa.string()), ("distance_bins", pa.float64())]
)


def _pairs_of_blocks(uri: str, comparable: str, left: List[str], right: List[str], key: str) -> None:
    """Task: the pairs of one block with another or with itself."""
    collection = Collection(uri)
    if collection.exists(key):
        return
    loaded = {name: collection.load(comparable, name).experience for name in {*left, *right}}
    distances = emd_block(
        [loaded[a].histogram for a in left], [loaded[b].histogram for b in right]
    )
    rows = [
        (a, b, float(distances[i, j]))
        for i, a in enumerate(left)
        for j, b in enumerate(right)
        if left != right or i < j
    ]
    columns = [list(column) for column in zip(*rows)] if rows else [[], [], []]
    sink = io.BytesIO()
    pq.write_table(pa.table(columns, schema=_PAIRS_SCHEMA), sink)
    collection.put(key, sink.getvalue())
