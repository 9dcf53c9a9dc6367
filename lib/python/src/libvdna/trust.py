"""Trust in the choice: what a map knows about itself, and what a live run may expect in it."""

from __future__ import annotations

import enum
from ctypes import Array, byref, c_double, c_uint32, c_void_p, pointer
from typing import Iterable, List, NamedTuple, Optional, Sequence, SupportsIndex, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, block, floats, integer, integers, shaped, view
from ._library import Error, ExperienceFile, MapTrustFields, TrustAnswerFields, TrustCell, TrustConfig, TrustFitFields
from ._library import TrustPredictionFields, TrustRunFields, TrustTablesFields, lib
from .experience import Experience, Path, _path, encoded

#: Most windows of a run.
TRUST_WINDOWS = 7

#: Numbers of a cell, in the order of `TrustTables.cells`.
TRUST_CELL = ("nearest", "likeness", "recall", "distance")


class StoredRun:
    """A stored run, as one of a map: what `trust_tables()` plays against the others."""

    def __init__(
        self,
        embeddings: ArrayLike,
        *,
        places: Optional[ArrayLike] = None,
        positions: Optional[ArrayLike] = None,
        last_layer: Optional[ArrayLike] = None,
    ) -> None:
        """
        embeddings: float32 [frames][dim], about no mean: those of an experience
        places: int64 [frames], PLACE_NONE = this frame has none; None = not labelled with places
        positions: float64 [frames][3], metres in one frame for all runs, NaN = this frame has none;
                   for horizontal distances the third is 0; they decide before places
        last_layer: float32 [frames][its own size], those of an experience; kept in 8 bits
        VdnaError: NONFINITE for a number of the last layer that is not finite
        """
        values = shaped(floats(embeddings, "embeddings"), ("frames", "dim"), "embeddings")
        self._fields = TrustRunFields()
        self._fields.embeddings = values.ctypes.data
        self._fields.frames = integer(values.shape[0], "the number of frames", 0, UINT32_MAX)
        self._fields.dim = integer(values.shape[1], "dim", 0, UINT32_MAX)
        self._borrowed: List[NDArray[np.generic]] = [values]
        if places is not None:
            numbers = integers(places, "places", np.int64)
            self._fields.place = self._kept(shaped(numbers, (len(values),), "places"))
        if positions is not None:
            metres = floats(positions, "positions", np.float64)
            self._fields.position = self._kept(shaped(metres, (len(values), 3), "positions"))
        self._codes: Optional[Tuple[NDArray[np.int8], NDArray[np.float32]]] = None
        if last_layer is not None:
            rows = shaped(
                floats(last_layer, "last_layer"), (len(values), "numbers"), "last_layer"
            )
            codes, scales = self._codes = encoded(rows)
            self._fields.last_layer = codes.ctypes.data
            self._fields.last_layer_scale = scales.ctypes.data
            self._fields.last_layer_dim = integer(rows.shape[1], "last_layer", 0, UINT32_MAX)
        self._embeddings = values

    def __repr__(self) -> str:
        frames, dim = self._embeddings.shape
        return f"<StoredRun of {frames} frames, embeddings of {dim}>"

    def _kept(self, array: NDArray[np.generic]) -> int:
        self._borrowed.append(array)
        return int(array.ctypes.data)

    def nearest(self, embedding: ArrayLike) -> Tuple[float, int]:
        """Relative distance, 0..2, of a live frame to the nearest of this run, and its index.

        embedding: float32 [dim], about no mean
        VdnaError: NONFINITE if a distance is not finite
        """
        one = shaped(floats(embedding, "embedding"), (self._embeddings.shape[1],), "embedding")
        relative, index = c_double(), c_uint32()
        lib.vdna_trust_nearest(
            one.ctypes.data,
            self._embeddings.ctypes.data,
            self._fields.dim,
            self._fields.frames,
            byref(relative),
            byref(index),
        )
        return relative.value, index.value

    def likeness(self, last_layer: ArrayLike) -> float:
        """The relative distance on the last layer, in 8 bits.

        last_layer: float32 [dim], of a live frame
        ValueError: this run has no last layer
        VdnaError: NONFINITE for a number that is not finite
        """
        if self._codes is None:
            raise ValueError("this run has no last layer")
        codes, scales = self._codes
        one = shaped(floats(last_layer, "last_layer"), (codes.shape[1],), "last_layer")
        live, live_scale = encoded(one[None])
        relative = c_double()
        lib.vdna_trust_nearest_int8(
            live.ctypes.data,
            live_scale[0],
            codes.ctypes.data,
            scales.ctypes.data,
            self._fields.last_layer_dim,
            self._fields.frames,
            byref(relative),
        )
        return relative.value

    @property
    def frames(self) -> int:
        """Number of frames."""
        return int(self._fields.frames)

    @property
    def fields(self) -> TrustRunFields:
        """The struct of the library, which borrows from this run."""
        return self._fields


class TrustTables(NamedTuple):
    """What a map knows about itself. vdna/trust.h has the definitions."""

    frames: NDArray[np.uint32]
    """[runs]: of each run."""
    own_scale: NDArray[np.float64]
    """[runs]: mean relative distance of a run's frames to the nearest at another place."""
    correlation: NDArray[np.float64]
    """[runs]: correlation time in frames; NaN = not known."""
    cells: NDArray[np.float64]
    """[runs as if live][candidates][TRUST_CELL][TRUST_WINDOWS]; NaN = not known."""


def trust_windows(frames: SupportsIndex) -> Tuple[NDArray[np.uint32], int]:
    """Tell the windows of a run of `frames` frames: the first frame of each, and frames in each."""
    first, length = np.empty(TRUST_WINDOWS, np.uint32), c_uint32(0)
    count = lib.vdna_trust_windows(
        integer(frames, "frames", 0, UINT32_MAX), first.ctypes.data, byref(length)
    )
    return first[:count], length.value


def trust_tables(
    runs: Sequence[StoredRun],
    tolerance: float,
    *,
    distances: Optional[ArrayLike] = None,
    centred: bool = True,
) -> TrustTables:
    """Let each run of a map play the live one against every other.

    runs: those of the map, in its order
    tolerance: metres or place numbers: as far apart are frames of one place
    distances: float64 [runs][runs][TRUST_WINDOWS], the mean EMD of each window of a run to all of
               another, in bins; NaN = not known. None = none is known, so nothing is predicted
    centred: whose recall: of the nearest frame about the means, or of embeddings as they are
    VdnaError: NONFINITE for a number that is not finite, MISMATCH for different dimensions
    """
    count = len(runs)
    cells = np.full((count, count, len(TRUST_CELL), TRUST_WINDOWS), np.nan)
    own_scale, correlation = np.empty(count), np.empty(count)
    for a, live in enumerate(runs):
        own = c_double()
        lib.vdna_trust_own_scale(live._fields, tolerance, byref(own))
        own_scale[a] = own.value
        relative = np.empty((max(1, count - 1), live.frames))
        others = [(b, candidate) for b, candidate in enumerate(runs) if b != a]
        for row, (b, candidate) in zip(relative, others):
            scratch = block(lib.vdna_trust_pair_scratch_size(live._fields, candidate._fields))
            cell = TrustCell.from_buffer(cells[a, b])
            lib.vdna_trust_pair(
                live._fields, candidate._fields, tolerance, 0 if centred else 1,
                scratch.ctypes.data, scratch.nbytes, row.ctypes.data, byref(cell),
            )  # fmt: skip
        tau, pairs = c_double(), np.empty(max(1, count * count))
        lib.vdna_trust_correlation_time(
            relative.ctypes.data, count - 1, live.frames, pairs.ctypes.data, byref(tau)
        )
        correlation[a] = tau.value
    if distances is not None:
        given = floats(distances, "distances", np.float64)
        cells[:, :, 3] = shaped(given, (count, count, TRUST_WINDOWS), "distances")
    frames = np.array([run.frames for run in runs], np.uint32)
    return TrustTables(frames, own_scale, correlation, cells)


def trust_recall(
    live: StoredRun, candidate: StoredRun, tolerance: float, *, centred: bool = True
) -> float:
    """Let a run play the live one against a candidate: Recall@1, 0..1, the mean over its windows.

    tolerance, centred: as for `trust_tables()`
    returns: NaN if no frame has a label in one unit with the candidate's
    VdnaError: NONFINITE for a number that is not finite, MISMATCH for different dimensions
    """
    scratch = block(lib.vdna_trust_pair_scratch_size(live._fields, candidate._fields))
    relative, cell = np.empty(max(1, live.frames)), TrustCell()
    lib.vdna_trust_pair(
        live._fields, candidate._fields, tolerance, 0 if centred else 1,
        scratch.ctypes.data, scratch.nbytes, relative.ctypes.data, byref(cell),
    )  # fmt: skip
    recall = np.array(cell.recall)
    known = recall[~np.isnan(recall)]
    return float(known.mean()) if known.size else float("nan")


class MapTrust(NamedTuple):
    """What a map knows about itself, as the file trust.safetensors beside its experiences has it."""

    tables: TrustTables
    tolerance: float
    """Metres or place numbers: as far apart were frames of one place."""
    centred: bool
    """Whose recall the tables have, as for `trust_tables()`."""

    @classmethod
    def open(cls, directory: Path, experiences: Sequence[Experience]) -> MapTrust:
        """Open the file of a map, for these experiences of it, in their order.

        experiences: as open_map() gives them; some of them will do
        VdnaError: EMPTY if there is no such file, MISMATCH if it does not know one of them as it is
                   now, FORMAT, CHECKSUM, IO, UNSUPPORTED for a newer format
        """
        n, fields = len(experiences), MapTrustFields()
        lib.vdna_map_trust_open(_path(directory), _structs(experiences), n, Error(), fields)
        try:
            tables = TrustTables(
                view(fields, fields.tables.frames, (n,), np.uint32).copy(),
                view(fields, fields.tables.own_scale, (n,), np.float64).copy(),
                view(fields, fields.tables.correlation, (n,), np.float64).copy(),
                view(
                    fields, fields.tables.cells, (n, n, len(TRUST_CELL), TRUST_WINDOWS), np.float64
                ).copy(),
            )
            return cls(tables, fields.tolerance, fields.localiser == 0)
        finally:
            lib.vdna_map_trust_close(fields)

    def write(self, directory: Path, experiences: Sequence[Experience]) -> None:
        """Write the file of a map crash-safely.

        experiences: of that map, from files, in the order of the tables
        VdnaError: ARG, NONFINITE or MISMATCH for tables that break their rules or are not of these
                   experiences, IO
        """
        arrays = _checked(self.tables, len(experiences))
        fields = MapTrustFields(_tables_fields(arrays), self.tolerance, len(experiences))
        fields.localiser = 0 if self.centred else 1
        lib.vdna_map_trust_write(_path(directory), _structs(experiences), fields, Error())


def _structs(experiences: Sequence[Experience]) -> Array[ExperienceFile]:
    """Copies that borrow from the experiences."""
    return (ExperienceFile * max(1, len(experiences)))(*(e.struct for e in experiences))


def _checked(tables: TrustTables, runs: int) -> Tuple[NDArray[np.generic], ...]:
    """The tables as C has them, of the right shapes."""
    return (
        shaped(integers(tables.frames, "frames", np.uint32), (runs,), "frames"),
        shaped(floats(tables.own_scale, "own_scale", np.float64), (runs,), "own_scale"),
        shaped(floats(tables.correlation, "correlation", np.float64), (runs,), "correlation"),
        shaped(
            floats(tables.cells, "cells", np.float64),
            (runs, runs, len(TRUST_CELL), TRUST_WINDOWS),
            "cells",
        ),
    )


def _tables_fields(arrays: Tuple[NDArray[np.generic], ...]) -> TrustTablesFields:
    """Borrows from the arrays."""
    return TrustTablesFields(*(array.ctypes.data for array in arrays))


class Verdict(enum.IntEnum):
    """Whether any of the candidates fits."""

    FITS = 0
    """Nothing speaks against it, or there are too few frames to tell."""
    UNLIKE = 1
    """The live run looks like none of the candidates."""
    POOR = 2
    """The best predicted recall is below `min_recall`."""
    BLANK = 3
    """The live frames hardly differ, and look like none of the candidates: the lens is covered, or
    the camera broken."""


class Prediction(NamedTuple):
    """What to expect of a candidate."""

    recall: float
    """Predicted share of frames localised correctly in it, 0..1; NaN = `reason`."""
    low: float
    """Lower end of its 80 % interval."""
    high: float
    """Upper end."""
    transfer: float
    """What runs like this one got in it, 0..1: for ranking; NaN = not known."""
    nearest: float
    """Mean relative nearest distance of the live frames; 1 = no nearer than a wrong place."""
    score: float
    """By which the choice settles: for ranking after a few frames, descending."""
    reason: str
    """Why there is no prediction; "" if there is."""


class TrustAnswer(NamedTuple):
    """What the warmup says so far."""

    verdict: Verdict
    frames: int
    """Live frames."""
    choice: int
    """Candidate of which `settled_frames` speaks."""
    settled_frames: int
    """Frames after which the choice had settled; 0 = not yet."""
    unlike: float
    """How much farther than the loneliest stored run, in ln; NaN = not known."""
    predictions: List[Prediction]
    """For each candidate."""


class TrustFit(NamedTuple):
    """What the tables say as a whole."""

    labelled: int
    """Runs with labels in cells with all others."""
    by_likeness: bool
    """Whether `unlike` is judged on the last layer, so that feed() needs `likeness`."""
    skill: float
    """At 0 or below, distances say nothing about recall; to be judged of 6 labelled runs or more."""
    slope: float
    """Of the angle of recall in ln of the nearest distance."""
    sd: float
    """Of a prediction, in radians."""
    sd_best: float
    """Of that of the best candidate."""
    quantile: float
    """Half of an interval, in standard deviations."""
    far: float
    """ln of the distance of the loneliest stored run to its nearest."""
    correlation: float
    """Correlation time, frames; NaN = not known."""


class Trust:
    """Trust in the choice among the candidates of a map. vdna/trust.h has the definition."""

    def __init__(
        self,
        tables: Optional[TrustTables],
        *,
        runs: Optional[SupportsIndex] = None,
        centred: bool = True,
        min_recall: float = 0.0,
        switch_cost: float = 5.0,
    ) -> None:
        """
        tables: of the candidates, in their order; not kept; None = the map knows nothing about
                itself, then say `runs`
        centred: whose recall the tables have, as for trust_tables()
        min_recall: POOR below this predicted recall of the best candidate; 0 = never
        switch_cost: frames that a switch to another candidate costs
        VdnaError: NONFINITE for a number of the tables beyond its range, ARG for a setting beyond its
                   range
        """
        if (tables is None) == (runs is None):
            raise ValueError("give either tables or runs")
        config = TrustConfig()
        lib.vdna_trust_config_init(config)
        count = len(tables.frames) if tables is not None else runs
        assert count is not None
        self._runs = config.runs = integer(count, "the number of runs", 0, UINT32_MAX)
        config.localiser = 0 if centred else 1
        config.min_recall, config.switch_cost = min_recall, switch_cost
        if tables is not None:
            arrays = _checked(tables, self._runs)
            fields = _tables_fields(arrays)
            config.tables = pointer(fields)
        self._memory = block(lib.vdna_trust_mem_size(config))
        self._trust = c_void_p()  # within `_memory`
        lib.vdna_trust_init(
            config, self._memory.ctypes.data, self._memory.nbytes, byref(self._trust)
        )

    def __repr__(self) -> str:
        return f"<Trust among {self._runs} candidates>"

    def _row(self, values: ArrayLike, what: str) -> NDArray[np.float64]:
        return shaped(floats(values, what, np.float64), (self._runs,), what)

    def feed(self, nearest: ArrayLike, likeness: Optional[ArrayLike] = None) -> None:
        """Take a frame of the warmup.

        nearest: float64 [runs], StoredRun.nearest() of each candidate
        likeness: float64 [runs], StoredRun.likeness() of each; needed if `fit.by_likeness`
        VdnaError: NONFINITE for a number beyond 0..2, FULL after a million frames, ARG without a
                   likeness that is needed
        """
        like = None if likeness is None else self._row(likeness, "likeness")
        lib.vdna_trust_feed(
            self._trust,
            self._row(nearest, "nearest").ctypes.data,
            None if like is None else like.ctypes.data,
        )

    def predict(self, distance_bins: Optional[ArrayLike] = None) -> TrustAnswer:
        """Predict, of the frames so far.

        distance_bins: float64 [runs], of the live Visual DNA to each candidate's; None = not known
        VdnaError: NONFINITE for a distance that is negative or not finite
        """
        distances = None if distance_bins is None else self._row(distance_bins, "distance_bins")
        fields, answer = (TrustPredictionFields * self._runs)(), TrustAnswerFields()
        lib.vdna_trust_predict(
            self._trust, None if distances is None else distances.ctypes.data, fields, answer
        )
        return trust_answer(answer, fields)

    def choose(self, candidate: SupportsIndex) -> None:
        """Begin to watch a choice, whoever made it.

        candidate: index of a run
        VdnaError: ARG if there is no such run
        """
        lib.vdna_trust_choose(self._trust, integer(candidate, "candidate", 0, UINT32_MAX))

    def expect(self, nearest: ArrayLike) -> NDArray[np.float64]:
        """Expect a frame's recall in each candidate, 0..1; NaN = not known.

        nearest: as for feed()
        """
        out = np.empty(self._runs)
        row = self._row(nearest, "nearest")
        lib.vdna_trust_expect(self._trust, row.ctypes.data, out.ctypes.data)
        return out

    def suit(
        self, nearest: ArrayLike, confidence: Optional[ArrayLike] = None
    ) -> NDArray[np.float64]:
        """Tell how well each candidate suits a frame, 0..1: for reconsider().

        nearest: as for feed()
        confidence: float64 [runs], of a Localiser in each candidate; None = nearness is all
        """
        out = np.empty(self._runs)
        row = self._row(nearest, "nearest")
        sure = None if confidence is None else self._row(confidence, "confidence")
        address = None if sure is None else sure.ctypes.data
        lib.vdna_trust_suit(self._trust, row.ctypes.data, address, out.ctypes.data)
        return out

    def reconsider(self, recall: ArrayLike, frames: SupportsIndex = 1) -> int:
        """Take a frame of the drive; return the choice, which is another one if that has paid.

        recall: float64 [runs], expected in each candidate, in any currency of 0..1; NaN = not known
        frames: of the drive for which this one stands
        VdnaError: ARG before choose(), or for a recall beyond 0..1
        """
        choice = c_uint32()
        lib.vdna_trust_reconsider(
            self._trust,
            self._row(recall, "recall").ctypes.data,
            integer(frames, "frames", 0, UINT32_MAX),
            byref(choice),
        )
        return choice.value

    @property
    def address(self) -> Optional[int]:
        """Of the C object."""
        return self._trust.value

    def reset(self) -> None:
        """Begin the warmup anew."""
        lib.vdna_trust_reset(self._trust)

    @property
    def settled_frames(self) -> int:
        """Frames after which the choice had settled; 0 = not yet."""
        return int(lib.vdna_trust_settled_frames(self._trust))

    @property
    def fit(self) -> TrustFit:
        """What the tables say as a whole."""
        fields: TrustFitFields = lib.vdna_trust_fitted(self._trust).contents
        names = TrustFit._fields
        return TrustFit(*(getattr(fields, name) for name in names))._replace(
            by_likeness=fields.by_likeness != 0
        )

    @property
    def intercepts(self) -> NDArray[np.float64]:
        """[runs]: the angle of recall at a nearest distance of 1; NaN = not known."""
        address = lib.vdna_trust_intercepts(self._trust)
        return view(self._memory, address, (self._runs,), np.float64)


def trust_answer(
    answer: TrustAnswerFields, predictions: Iterable[TrustPredictionFields]
) -> TrustAnswer:
    """Of the fields of the library."""
    return TrustAnswer(
        Verdict(answer.verdict),
        answer.frames,
        answer.choice,
        answer.settled_frames,
        answer.unlike,
        [_prediction_of(fields) for fields in predictions],
    )


def _prediction_of(fields: TrustPredictionFields) -> Prediction:
    reason: bytes = lib.vdna_trust_reason_text(fields.reason)
    return Prediction(
        fields.recall,
        fields.low,
        fields.high,
        fields.transfer,
        fields.nearest,
        fields.score,
        reason.decode(),
    )
