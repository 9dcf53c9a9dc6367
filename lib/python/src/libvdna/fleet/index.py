"""The index: one Parquet file for all experiences of one comparable, with what bounds distances."""

from __future__ import annotations

import contextlib
import hashlib
import json
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import pyarrow as pa  # type: ignore[import-untyped,unused-ignore]
import pyarrow.parquet as pq  # type: ignore[import-untyped,unused-ignore]
from numpy.typing import NDArray

from ..distance import bound_from_sums, bound_sums
from ..histogram import HistogramView
from . import engine
from .collection import Collection, DamagedObject, Stored, batches

#: Of the layout, in the file's metadata.
VERSION = 1
#: Bins in a block, as VDNA_BOUNDS_BINS of vdna/bounds.h.
BLOCK_BINS = 25
#: Rows that are read together.
ROW_GROUP = 32
#: Of these, the block sums are kept in memory: 50 MB with 1280 neurons in 1000 bins.
_GROUPS_CACHED = 8
#: Rows that a task makes.
_ROWS_OF_TASK = 16
#: What bounds by means are lowered by, in bins: more than double rounds in their sums.
_SLACK = 1e-9

Where = Optional[Sequence[Tuple[str, str, Any]]]
"""Conditions on columns that must all hold, as of pyarrow: [("route", "==", "ring"), ...]."""

#: Columns that `where` may name.
COLUMNS = (
    "name", "route", "condition", "first_utime", "last_utime", "frames", "size", "object_size",
    "sha256",
)  # fmt: skip


def key_of(comparable: str) -> str:
    return f"index/{comparable}.parquet"


def _blocks(bins: int) -> int:
    """Of bound_sums()."""
    return -(-(bins - 1) // BLOCK_BINS)


def mean_bins(dna: HistogramView) -> NDArray[np.float32]:
    """[neurons]: the mean of the bin numbers of a neuron's samples."""
    bins = np.arange(dna.bins, dtype=np.float64)
    return (bins @ dna.counts / dna.mass).astype(np.float32)


def bound_by_means(p: NDArray[np.float32], q: NDArray[np.float32], bins: int) -> NDArray[np.float64]:
    """Lower bounds of the distance, in bins, from mean_bins() of the two; either may have rows.

    Per neuron the means are no further apart than the distributions. The slack is what float32 has
    rounded off the two means.
    """
    means: NDArray[np.float64] = np.abs(np.subtract(p, q, dtype=np.float64)).mean(axis=-1)
    return np.maximum(0, means - bins * 2.0**-23 - _SLACK)


class Summary(NamedTuple):
    """What bounds the distances of one Visual DNA."""

    mass: NDArray[np.uint32]
    """[neurons]"""
    means: NDArray[np.float32]
    """[neurons], of mean_bins()"""
    sums: NDArray[np.uint32]
    """[blocks][neurons], of bound_sums()"""

    @classmethod
    def of(cls, dna: HistogramView) -> Summary:
        return cls(np.array(dna.mass), mean_bins(dna), bound_sums(dna))

    def bound(self, other: Summary, bins: int) -> float:
        """A lower bound of the distance, in bins, from the block sums of the two."""
        return bound_from_sums(self.sums, self.mass, other.sums, other.mass, bins)


def _row_of(stored: Stored) -> Dict[str, Any]:
    experience, dna = stored.experience, stored.experience.histogram
    summary = Summary.of(dna)
    return {
        "name": experience.name,
        "route": stored.labels.route,
        "condition": stored.labels.condition,
        "first_utime": int(experience.frame_utime.min()),
        "last_utime": int(experience.frame_utime.max()),
        "frames": experience.frames,
        "size": len(stored.vdna),
        "object_size": stored.object_size,
        "sha256": stored.sha256,
        "mass": summary.mass,
        "mean_bin": summary.means,
        "block_sums": summary.sums.reshape(-1),
    }


def _schema(comparable: str, dna: HistogramView) -> Any:
    metadata = {
        "version": VERSION,
        "comparable": comparable,
        "neurons": dna.neurons,
        "bins": dna.bins,
        "block_bins": BLOCK_BINS,
    }
    return pa.schema(
        [
            ("name", pa.string()),
            ("route", pa.string()),
            ("condition", pa.string()),
            ("first_utime", pa.int64()),
            ("last_utime", pa.int64()),
            ("frames", pa.uint32()),
            ("size", pa.uint64()),
            ("object_size", pa.uint64()),
            ("sha256", pa.string()),
            ("mass", pa.list_(pa.uint32(), dna.neurons)),
            ("mean_bin", pa.list_(pa.float32(), dna.neurons)),
            ("block_sums", pa.list_(pa.uint32(), _blocks(dna.bins) * dna.neurons)),
        ],
        metadata={"vdna": json.dumps(metadata, sort_keys=True)},
    )


def _writer(file: Any, schema: Any) -> Any:
    # By bytes of equal weight, numbers take a third less room and are read faster.
    split = {f"{column}.list.element": "BYTE_STREAM_SPLIT" for column in ("mean_bin", "block_sums")}
    return pq.ParquetWriter(
        file,
        schema,
        compression="zstd",
        use_dictionary=["route", "condition"],
        column_encoding=split,
        write_page_checksum=True,
    )


@contextlib.contextmanager
def _reading(collection: Collection, key: str) -> Iterator[None]:
    """Says which file does not have the checksums that it should."""
    try:
        yield
    except OSError as failure:
        raise ValueError(
            f"{collection.uri}/{key}: damaged: {failure}; remove it, and make it again by"
            " vdna-fleet index"
        ) from None


def _rows(uri: str, comparable: str, names: List[str], part: str) -> List[str]:
    """Task: write the rows of these objects to `part`; what was wrong with the others."""
    collection = Collection(uri)
    rows: List[Dict[str, Any]] = []
    schema: Any = None
    wrong: List[str] = []
    for name in names:
        try:
            stored = collection.load(comparable, name)
        except DamagedObject as damage:
            wrong.append(str(damage))
            continue
        schema = schema or _schema(comparable, stored.experience.histogram)
        rows.append(_row_of(stored))
    if rows:
        columns = [
            pa.array([row[field.name] for row in rows], type=field.type) for field in schema
        ]
        with collection.writing(part) as file, _writer(file, schema) as writer:
            writer.write_table(pa.Table.from_arrays(columns, schema=schema))
    return wrong


def _part_key(comparable: str, names: List[str], sizes: Dict[str, int]) -> str:
    text = json.dumps([comparable, [(name, sizes[name]) for name in names]])
    return f"parts/index-{comparable}/{hashlib.sha256(text.encode()).hexdigest()}.parquet"


class Indexed(NamedTuple):
    """What update() did."""

    rows: int
    added: int
    removed: int
    damaged: List[str]
    """What was wrong with the objects that were left out."""


def update(collection: Collection, comparable: str, run_on: engine.Engine) -> Indexed:
    """Give every object a row. Only objects without one are read."""
    collection.sweep()
    sizes = collection.names(comparable)
    key = key_of(comparable)
    before = [_Rows(collection, key)] if collection.exists(key) else []
    # Rows of objects that are as large as when they were read.
    kept = [one for rows in before for one in rows.keys if sizes.get(one.name) == one.object_size]
    known = {one.name for one in kept}
    missing = [name for name in sizes if name not in known]

    damaged: List[str] = []
    tasks, parts = [], []
    for names in batches(missing, _ROWS_OF_TASK):
        part = _part_key(comparable, names, sizes)
        if not collection.exists(part):
            tasks.append((collection.uri, comparable, names, part))
        parts.append(part)
    for done in engine.run(run_on, _rows, tasks):
        damaged += done.result if not done.failure else [f"{collection.uri}: {done.failure}"]
    made = [_Rows(collection, part) for part in parts if collection.exists(part)]
    new = [one for rows in made for one in rows.keys]

    old = sum(len(rows.keys) for rows in before)
    if new or len(kept) < old:
        _write(collection, key, sorted(kept + new))
    collection.remove_folder(f"parts/index-{comparable}")
    return Indexed(len(kept) + len(new), len(new), old - len(kept), damaged)


class _Key(NamedTuple):
    """A row, in the order of the index."""

    route: str
    name: str
    object_size: int
    rows: _Rows
    at: int


class _Rows:
    """The rows of an index or a part. Few are in memory at a time, and the file is not kept open."""

    def __init__(self, collection: Collection, key: str) -> None:
        self._collection, self._key = collection, key
        with collection.open(key) as stream:
            file = pq.ParquetFile(stream, page_checksum_verification=True)
            self._metadata, self.schema = file.metadata, file.schema_arrow
            columns = file.read(["route", "name", "object_size"]).to_pydict()
        named = zip(columns["route"], columns["name"], columns["object_size"])
        self.keys = [_Key(*one, self, at) for at, one in enumerate(named)]
        groups = range(self._metadata.num_row_groups)
        self._end = np.cumsum([self._metadata.row_group(group).num_rows for group in groups])
        self._group: Tuple[int, Any] = (-1, None)

    def row(self, at: int) -> Any:
        """A table of one row."""
        group = int(np.searchsorted(self._end, at, side="right"))
        if self._group[0] != group:
            with _reading(self._collection, self._key), self._collection.open(self._key) as stream:
                file = pq.ParquetFile(
                    stream, metadata=self._metadata, page_checksum_verification=True
                )
                self._group = (group, file.read_row_group(group))
        table = self._group[1]
        return table.slice(at - int(self._end[group]) + table.num_rows, 1)

    def drop(self) -> None:
        """What is in memory."""
        self._group = (-1, None)


def _write(collection: Collection, key: str, order: List[_Key]) -> None:
    """The index of these rows, or none without any."""
    if not order:
        collection.remove(key)
        return
    schema = order[0].rows.schema
    with collection.writing(key) as file, _writer(file, schema) as writer:
        for some in batches(order, ROW_GROUP):
            table = pa.concat_tables([one.rows.row(one.at) for one in some])
            writer.write_table(table.combine_chunks())
            for rows in {id(one.rows): one.rows for one in some}.values():
                rows.drop()


class Index:
    """The index of one comparable, to read: the small columns of the rows where `where` holds are in
    memory, their block sums are read when they are wanted."""

    def __init__(self, collection: Collection, comparable: str, where: Where = None) -> None:
        """ValueError: there is no index, or `where` names no column of it"""
        self.collection, self.comparable = collection, comparable
        key = key_of(comparable)
        if not collection.exists(key):
            raise ValueError(
                f"{collection.uri}/{key}: is not there; make it by vdna-fleet index {collection.uri}"
            )
        self._file = pq.ParquetFile(
            collection.open(key), pre_buffer=True, page_checksum_verification=True
        )
        about = json.loads(self._file.schema_arrow.metadata[b"vdna"])
        if about["version"] != VERSION or about["block_bins"] != BLOCK_BINS:
            raise ValueError(
                f"{collection.uri}/{key}: version {about['version']} with blocks of"
                f" {about['block_bins']} bins, expected version {VERSION} with {BLOCK_BINS};"
                " remove it, and make it again by vdna-fleet index"
            )
        self.neurons, self.bins = int(about["neurons"]), int(about["bins"])
        self._cached: Dict[int, NDArray[np.uint32]] = {}
        self._sized = self._chunk_sizes()
        metadata = self._file.metadata
        counts = np.array([metadata.row_group(g).num_rows for g in range(len(self._sized))], np.int64)
        self._group_end = np.cumsum(counts)
        labels = self._read(COLUMNS)
        rows = np.arange(labels.num_rows)
        if where:
            numbered = labels.append_column("row", pa.array(rows))
            rows = numbered.filter(_expression(where)).column("row").to_numpy()
        #: [rows]: where the file has them
        self.rows: NDArray[np.int64] = rows
        labels = labels.take(rows)
        self.columns: Dict[str, List[Any]] = {
            column: labels.column(column).to_pylist() for column in COLUMNS
        }
        self.names: List[str] = self.columns["name"]
        # Of groups with such rows only.
        group_of = np.searchsorted(self._group_end, rows, side="right")
        groups = sorted(set(group_of.tolist()))
        table = self._read(("mass", "mean_bin"), groups)
        begin = dict(zip(groups, np.cumsum([0, *(counts[g] for g in groups)]).tolist()))
        first = self._group_end - counts
        within = [begin[g] + int(r - first[g]) for r, g in zip(rows, group_of.tolist())]
        self.mass: NDArray[np.uint32] = _matrix(table, "mass", self.neurons)[within]
        self.means: NDArray[np.float32] = _matrix(table, "mean_bin", self.neurons)[within]

    def _chunk_sizes(self) -> List[Dict[str, int]]:
        metadata = self._file.metadata
        sizes = []
        for group in range(metadata.num_row_groups):
            row_group = metadata.row_group(group)
            chunks = [row_group.column(column) for column in range(row_group.num_columns)]
            sizes.append({c.path_in_schema.split(".")[0]: c.total_compressed_size for c in chunks})
        return sizes

    def _read(self, columns: Sequence[str], groups: Optional[List[int]] = None) -> Any:
        wanted = list(range(len(self._sized))) if groups is None else groups
        self.collection.bytes_read += sum(self._sized[g][c] for g in wanted for c in columns)
        with _reading(self.collection, key_of(self.comparable)):
            return self._file.read_row_groups(wanted, list(columns))

    def summary(self, row: int) -> Summary:
        """Of a row, by its place in `names`."""
        group = int(np.searchsorted(self._group_end, self.rows[row], side="right"))
        sums = self._sums_of(group)
        after_end = int(self.rows[row] - self._group_end[group])
        return Summary(self.mass[row], self.means[row], sums[after_end].reshape(-1, self.neurons))

    def together(self, row: int) -> range:
        """The rows, by their places in `names`, whose block sums are read together with those of one."""
        group = int(np.searchsorted(self._group_end, self.rows[row], side="right"))
        begin = self._group_end[group - 1] if group > 0 else 0
        return range(*np.searchsorted(self.rows, [begin, self._group_end[group]]).tolist())

    def _sums_of(self, group: int) -> NDArray[np.uint32]:
        if group not in self._cached:
            if len(self._cached) == _GROUPS_CACHED:
                del self._cached[next(iter(self._cached))]
            self.collection.bytes_read += self._sized[group]["block_sums"]
            with _reading(self.collection, key_of(self.comparable)):
                table = self._file.read_row_group(group, ["block_sums"])
            self._cached[group] = _matrix(table, "block_sums", _blocks(self.bins) * self.neurons)
        return self._cached[group]

    def load(self, row: int) -> Stored:
        """Its object. DamagedObject: it is damaged, or not the one that was indexed"""
        stored = self.collection.load(self.comparable, self.names[row])
        if stored.sha256 != self.columns["sha256"][row]:
            key = self.collection.object_key(self.comparable, self.names[row])
            raise DamagedObject(
                f"{self.collection.uri}/{key}: is another one than that of the index; remove the"
                " index, and make it again by vdna-fleet index"
            )
        return stored


def _matrix(table: Any, column: str, width: int) -> Any:
    values = table.column(column).combine_chunks()
    return values.flatten().to_numpy(zero_copy_only=False).reshape(-1, width)


def _expression(where: Sequence[Tuple[str, str, Any]]) -> Any:
    for column, _, _ in where:
        if column not in COLUMNS:
            raise ValueError(f"there is no column {column!r}, expected one of {', '.join(COLUMNS)}")
    return pq.filters_to_expression([tuple(one) for one in where])
