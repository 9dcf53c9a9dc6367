"""What fills a collection: ranges of many recordings, experiences, and other bins for those there."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import Any, Dict, Iterator, List, NamedTuple, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from ..experience import Experience
from ..histogram import Histogram
from ..identity import clean_name, parse_taps
from ..ranges import Ranges
from . import engine
from .collection import WORKSPACE, Collection, Labels, aside_name

RANGES = "ranges.json"


class Source(NamedTuple):
    """A traversal to add."""

    path: str
    """An experience file, or a recording: whatever `vdna build` takes. Absolute."""
    name: str
    """Of the experience; of an experience file, it stays as it is."""
    labels: Labels

    @classmethod
    def of(cls, path: str, labels: Labels = Labels()) -> Source:
        """Named as `vdna build` would."""
        stem = pathlib.Path(path).resolve()
        return cls(os.path.abspath(path), clean_name(stem.name if stem.is_dir() else stem.stem), labels)

    @property
    def is_experience(self) -> bool:
        return self.path.endswith(".vdna")


class Ended(NamedTuple):
    """What became of the tasks."""

    made: int
    there: int
    """Were there before."""
    failures: List[str]


@contextlib.contextmanager
def _workspace() -> Iterator[pathlib.Path]:
    """A folder of this process, which Collection.sweep() removes if the process cannot."""
    folder = pathlib.Path(tempfile.gettempdir()) / f"{WORKSPACE}{aside_name()}"
    folder.mkdir()
    try:
        yield folder
    finally:
        shutil.rmtree(folder)


def _found(program: str) -> str:
    """The program by an absolute path, unless $PATH has it."""
    return os.path.abspath(program) if os.sep in program else program


def _run_program(*command: Any) -> None:
    try:
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    except OSError as failure:
        raise RuntimeError(f"{command[0]}: {failure.strerror}; name vdna by --vdna PATH") from None
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip() or f"{command[0]}: exit status {done.returncode}")


def _ended(done: List[engine.Done], where: str) -> Ended:
    results = [one.result for one in done if not one.failure]
    failures = [f"{where}: {one.failure}" for one in done if one.failure]
    return Ended(sum(results), len(results) - sum(results), failures)


def calibrate(
    collection: Collection, sources: Sequence[str], run_on: engine.Engine, program: str
) -> Ended:
    """Write the collection's ranges: those of one `vdna calibrate` of all sources, bit for bit.

    Nothing is written if a source fails.
    """
    collection.sweep()
    paths = sorted(map(os.path.abspath, sources))
    digest = hashlib.sha256(json.dumps(paths).encode()).hexdigest()
    folder = f"parts/calibrate-{digest}"
    keys = [f"{folder}/{number}.json" for number in range(len(paths))]
    tasks = [(collection.uri, key, path, _found(program)) for key, path in zip(keys, paths)]
    ended = _ended(engine.run(run_on, _observe, tasks), collection.uri)
    if not ended.failures:
        merged = merged_ranges([json.loads(collection.get(key)) for key in keys])
        collection.put(RANGES, json.dumps(merged, separators=(",", ":")).encode() + b"\n")
        collection.remove_folder(folder)
    return ended


def _observe(uri: str, key: str, source: str, program: str) -> bool:
    """Task: the ranges of one source."""
    collection = Collection(uri)
    if collection.exists(key):
        return False
    with _workspace() as folder:
        _run_program(program, "calibrate", "--threads", 1, folder / "ranges.json", source)
        collection.put(key, (folder / "ranges.json").read_bytes())
    return True


def merged_ranges(files: Sequence[Dict[str, Any]]) -> Dict[str, Any]:
    """One ranges file of several, as if all that they observed had been observed for it.

    ValueError: they are of different networks or rules, or do not say what was observed
    """
    merged = dict(files[0])
    ranges = Ranges(len(merged["range"]))
    for file in files:
        for key, value in file.items():
            if key not in ("range", "observed") and value != merged.get(key):
                raise ValueError(f"ranges of {key} {value!r} and {merged.get(key)!r} do not merge")
        if "observed" not in file:
            raise ValueError("a ranges file does not say what was observed; make it again")
        ranges.merge(Ranges.observed_as(np.array(file["observed"], np.float32)))
    rule = "about_zero" if merged["rule"] == "zero" else "about_midpoint"
    merged["range"] = ranges.expand(merged["factor"], rule).tolist()
    merged["observed"] = ranges.observed.tolist()
    return merged


def build(
    collection: Collection, sources: Sequence[Source], run_on: engine.Engine, program: str
) -> Ended:
    """Add experiences: files as they are, recordings through `vdna build` with the collection's
    ranges. One whose name is there already with these ranges is not made again."""
    collection.sweep()
    recordings = [source for source in sources if not source.is_experience]
    there = _names_with_ranges(collection) if recordings else set()
    known = [source for source in recordings if source.name in there]
    tasks = [(collection.uri, source, _found(program)) for source in sources if source not in known]
    ended = _ended(engine.run(run_on, _add, tasks), collection.uri)
    return ended._replace(there=ended.there + len(known))


def _names_with_ranges(collection: Collection) -> set[str]:
    """Names of the experiences that have the collection's ranges."""
    range = collection_range(collection)
    names: set[str] = set()
    for comparable in collection.comparables():
        stored = collection.names(comparable)
        if not stored:
            continue
        first = collection.load(comparable, next(iter(stored))).experience
        if np.array_equal(first.histogram.range, range):
            names |= set(stored)
    return names


def collection_range(collection: Collection) -> NDArray[np.float32]:
    """[neurons][2], of the collection's ranges. ValueError: it has none"""
    if not collection.exists(RANGES):
        raise ValueError(
            f"{collection.uri}/{RANGES}: is not there; make it of some recordings by"
            f" vdna-fleet calibrate {collection.uri} SOURCE..., or copy a ranges file there"
        )
    return np.array(json.loads(collection.get(RANGES))["range"], np.float32)


def _add(uri: str, source: Source, program: str) -> bool:
    """Task: whether it was not there."""
    collection = Collection(uri)
    if source.is_experience:
        return collection.add(pathlib.Path(source.path).read_bytes(), source.labels)[1]
    with _workspace() as folder:
        (folder / RANGES).write_bytes(collection.get(RANGES))
        _run_program(
            *(program, "build", folder / "map", source.path, "--name", source.name),
            *("--ranges", folder / RANGES, "--threads", 1),
        )
        vdna = (folder / "map" / f"{source.name}.vdna").read_bytes()
    return collection.add(vdna, source.labels)[1]


def merge(collection: Collection, others: Sequence[str], run_on: engine.Engine) -> Ended:
    """Add the experiences of other collections, such as those of single robots. Names that are there
    stay as they are."""
    collection.sweep()
    tasks = [
        (collection.uri, other.uri, comparable, name)
        for other in map(Collection, others)
        for comparable in other.comparables()
        for name in other.names(comparable)
    ]
    return _ended(engine.run(run_on, _copy, tasks), collection.uri)


def _copy(uri: str, other: str, comparable: str, name: str) -> bool:
    """Task: whether it was not there."""
    collection = Collection(uri)
    key = collection.object_key(comparable, name)
    if collection.exists(key):
        return False
    source = Collection(other)
    source.load(comparable, name)
    collection.put(key, source.get(key))
    return True


def rebin(collection: Collection, comparable: str, run_on: engine.Engine) -> Ended:
    """Add every experience of `comparable` once more, in the bins of the collection's ranges, bit for
    bit as building it anew. Needs no network, but experiences whose only tap is the embedding."""
    collection.sweep()
    collection_range(collection)
    tasks = [(collection.uri, comparable, name) for name in collection.names(comparable)]
    return _ended(engine.run(run_on, _rebin, tasks), collection.uri)


def _rebin(uri: str, comparable: str, name: str) -> bool:
    """Task: whether it was not there."""
    collection = Collection(uri)
    stored = collection.load(comparable, name)
    experience = rebinned(stored.experience, collection_range(collection))
    with _workspace() as folder:
        experience.write(folder / "new.vdna")
        return collection.add((folder / "new.vdna").read_bytes(), stored.labels)[1]


def rebinned(experience: Experience, range: NDArray[np.float32]) -> Experience:
    """The experience with its embeddings counted over another range.

    ValueError: its counts are not those of its embeddings
    """
    if not _tap_is_embedding(experience):
        raise ValueError(
            f"{experience.name}: its Visual DNA is not that of its embeddings, so it cannot be counted"
            " again without the network; build it anew from the recording"
        )
    return experience.with_histogram(_counted(experience, range))


def _tap_is_embedding(experience: Experience) -> bool:
    """Counts itself out: embeddings that give the counts that are there are what was counted."""
    taps = parse_taps(experience.taps)
    if len(taps) != 1 or (taps[0].neurons, taps[0].samples) != (experience.dim, 1):
        return False
    again = _counted(experience, experience.histogram.range)
    return np.array_equal(again.counts, experience.histogram.counts)


def _counted(experience: Experience, range: NDArray[np.float32]) -> Histogram:
    histogram = Histogram(range, experience.histogram.bins)
    for embedding in experience.embeddings:
        histogram.add(embedding)
    return histogram
