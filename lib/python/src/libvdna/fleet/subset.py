"""Which experiences a robot should carry when it cannot carry all."""

from __future__ import annotations

import hashlib
import io
import json
import pathlib
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from ..distance import emd_mean
from ..experience import Experience
from ..trust import StoredRun, trust_recall
from . import engine
from .collection import Collection
from .index import Index, Where

#: Rows of a table that a task makes.
_ROWS_OF_TASK = 4


class Shipped(NamedTuple):
    """A subset, and what it is worth."""

    names: List[str]
    """In the order in which they were chosen."""
    size: int
    """Bytes of their experience files."""
    by: Dict[str, str]
    """For each route: "recall", played from the labels, or "distance" without them."""
    worth: Dict[str, Tuple[float, float]]
    """For each route: of the subset, and of all experiences."""
    best_share: float
    """The worth of the subset is at least this share of that of the best possible subset."""
    damaged: List[str]


def choose(
    value: Sequence[NDArray[np.float64]], sizes: Sequence[NDArray[np.int64]], budget: int
) -> Tuple[List[Tuple[int, int]], float]:
    """Choose candidates of several tables within a budget; (table, candidate) in their order, and the
    least share of the worth of the best possible choice that this one has.

    The worth of a choice is the sum over all rows of the greatest value among its candidates, which
    is submodular: what a candidate adds becomes less as more are chosen. The better of two greedy
    choices, by what is added and by what is added for each byte, has at least (1 - 1/e) / 2 of the
    best worth (Leskovec 2007); what is left to add gives a bound for these tables, mostly greater.

    value: [rows][candidates] of each table, >= 0
    sizes: [candidates] of each table, bytes
    """
    by_gain = _greedy(value, sizes, budget, by_size=False)
    by_rate = _greedy(value, sizes, budget, by_size=True)
    chosen, worth, _ = max((by_gain, by_rate), key=lambda one: one[1])
    most = min(by_gain[2], by_rate[2])
    share = worth / most if most > 0 else 1.0
    return chosen, max(min(share, 1.0), (1 - 1 / np.e) / 2)


def _greedy(
    value: Sequence[NDArray[np.float64]],
    sizes: Sequence[NDArray[np.int64]],
    budget: int,
    by_size: bool,
) -> Tuple[List[Tuple[int, int]], float, float]:
    """The choice, its worth, and an upper bound of the worth of any choice."""
    best = [np.zeros(len(table)) for table in value]
    chosen: List[Tuple[int, int]] = []
    left, worth, most = budget, 0.0, np.inf
    while True:
        gains = [np.maximum(table - b[:, None], 0).sum(axis=0) for table, b in zip(value, best)]
        most = min(most, worth + _fractional(np.concatenate(gains), np.concatenate(sizes), budget))
        pick: Optional[Tuple[float, int, int]] = None
        for t, gain in enumerate(gains):
            score = gain / sizes[t] if by_size else gain
            score = np.where((sizes[t] <= left) & (gain > 0), score, 0)
            c = int(score.argmax())
            if score[c] > 0 and (pick is None or score[c] > pick[0]):
                pick = (float(score[c]), t, c)
        if pick is None:
            return chosen, worth, most
        _, t, c = pick
        worth += float(gains[t][c])
        best[t] = np.maximum(best[t], value[t][:, c])
        left -= int(sizes[t][c])
        chosen.append((t, c))


def _fractional(gains: NDArray[np.float64], sizes: NDArray[np.int64], budget: int) -> float:
    """The most that candidates could add within the budget if they could be cut."""
    order = np.argsort(-gains / sizes, kind="stable")
    room = np.clip(budget - (np.cumsum(sizes[order]) - sizes[order]), 0, sizes[order])
    return float((gains[order] * room / sizes[order]).sum())


def ship(
    collection: Collection,
    comparable: str,
    out: str,
    budget_bytes: int,
    run_on: engine.Engine,
    where: Where = None,
    tolerance: float = 5,
) -> Shipped:
    """Write the subset that loses least into the folder `out`, a map for a robot.

    What a run like `a` may expect is the greatest recall that `a` had in an experience on its route
    that is there; 1 if `a` itself is. Without labels, near ones are worth most.

    budget_bytes: of experience files
    tolerance: metres or place numbers within which frames show one place
    """
    collection.sweep()
    index = Index(collection, comparable, where)
    rows_of: Dict[str, List[int]] = {}
    for row, route in enumerate(index.columns["route"]):
        rows_of.setdefault(route, []).append(row)
    tables, by, damaged = _tables(collection, index, rows_of, run_on, tolerance)
    routes = [route for route in rows_of if route in tables]
    sizes = [np.array([index.columns["size"][row] for row in rows_of[route]]) for route in routes]
    chosen, share = choose([tables[route] for route in routes], sizes, budget_bytes)

    worth: Dict[str, Tuple[float, float]] = {}
    for t, route in enumerate(routes):
        candidates = [c for of, c in chosen if of == t]
        table = tables[route]
        reached = table[:, candidates].max(axis=1) if candidates else np.zeros(len(table))
        worth[route] = float(reached.mean()), float(table.max(axis=1).mean())
    rows = [rows_of[routes[t]][c] for t, c in chosen]
    _write(index, rows, out)
    size = sum(index.columns["size"][row] for row in rows)
    return Shipped([index.names[row] for row in rows], size, by, worth, share, damaged)


def _write(index: Index, rows: List[int], out: str) -> None:
    folder = pathlib.Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    for row in rows:
        index.load(row).experience.write(folder / f"{index.names[row]}.vdna")


def _tables(
    collection: Collection,
    index: Index,
    rows_of: Dict[str, List[int]],
    run_on: engine.Engine,
    tolerance: float,
) -> Tuple[Dict[str, NDArray[np.float64]], Dict[str, str], List[str]]:
    """Values of each route, what they are, and what failed. The parts stay until all are there."""
    recall, failures = _compared(collection, index, rows_of, run_on, "recall", tolerance)
    by = {route: "distance" if np.isnan(table).any() else "recall" for route, table in recall.items()}
    unlabelled = {route: rows_of[route] for route in by if by[route] == "distance"}
    distance, more = _compared(collection, index, unlabelled, run_on, "distance", tolerance)
    failures += more
    tables = {
        route: _nearness(distance[route]) if by[route] == "distance" else recall[route]
        for route in by
        if by[route] == "recall" or route in distance
    }
    if not failures:
        collection.remove_folder(f"parts/ship-{index.comparable}")
    return tables, by, failures


def _compared(
    collection: Collection,
    index: Index,
    rows_of: Dict[str, List[int]],
    run_on: engine.Engine,
    by: str,
    tolerance: float,
) -> Tuple[Dict[str, NDArray[np.float64]], List[str]]:
    """Tables of the routes of which all experiences could be compared, and what failed."""
    tasks: List[Tuple[Any, ...]] = []
    for route, rows in rows_of.items():
        names = [index.names[row] for row in rows]
        digests = [index.columns["sha256"][row] for row in rows]
        text = json.dumps([route, names, digests, by, tolerance])
        folder = f"parts/ship-{index.comparable}/{hashlib.sha256(text.encode()).hexdigest()}"
        for begin in range(0, len(names), _ROWS_OF_TASK):
            key = f"{folder}/{begin}.npy"
            tasks.append((collection.uri, index.comparable, names, begin, by, tolerance, key, route))
    failures: List[str] = []
    parts: Dict[str, List[NDArray[np.float64]]] = {route: [] for route in rows_of}
    for done in engine.run(run_on, _part, tasks):
        *_, key, route = done.arguments
        if done.failure:
            failures.append(f"{done.failure}; route {route!r} is left out")
            parts.pop(route, None)
        elif route in parts:
            parts[route].append(np.load(io.BytesIO(collection.get(key))))
    return {route: np.concatenate(found) for route, found in parts.items()}, failures


def _nearness(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    """1 for no distance, 0 for the greatest of the route."""
    greatest = distance.max()
    return 1 - distance / greatest if greatest > 0 else np.ones_like(distance)


def _part(
    uri: str,
    comparable: str,
    names: List[str],
    begin: int,
    by: str,
    tolerance: float,
    key: str,
    route: str,
) -> None:
    """Task: some rows of a route's table, [rows][names]."""
    collection = Collection(uri)
    if collection.exists(key):
        return
    live = [collection.load(comparable, name).experience for name in names[begin : begin + _ROWS_OF_TASK]]
    table = np.empty((len(live), len(names)))
    for column, name in enumerate(names):
        candidate = collection.load(comparable, name).experience
        for row, one in enumerate(live):
            if by == "distance":
                table[row, column] = emd_mean(one.histogram, candidate.histogram)
            else:
                itself = begin + row == column
                table[row, column] = 1 if itself else _recall(one, candidate, tolerance)
    file = io.BytesIO()
    np.save(file, table)
    collection.put(key, file.getvalue())


def _recall(live: Experience, candidate: Experience, tolerance: float) -> float:
    """Recall@1 of the frames of `live` in the candidate; NaN without labels of both in one frame."""
    if live.position_frame != candidate.position_frame:
        return np.nan
    live_run, run = _run_of(live, live), _run_of(candidate, live)
    if live_run is None or run is None:
        return np.nan
    return trust_recall(live_run, run, tolerance, centred=live.identity.is_centred)


def _run_of(experience: Experience, live: Experience) -> Optional[StoredRun]:
    """With horizontal positions about the first of `live`, as heights by GPS are off by many metres."""
    positions, places = experience.frame_position, experience.frame_place
    if positions is not None and live.frame_position is not None:
        first = live.frame_position[0]
        up = first / np.linalg.norm(first) if live.position_frame == "wgs84" else np.array([0, 0, 1])
        about = positions - first
        return StoredRun(experience.embeddings, positions=about - np.outer(about @ up, up))
    if places is not None:
        return StoredRun(experience.embeddings, places=places)
    return None
