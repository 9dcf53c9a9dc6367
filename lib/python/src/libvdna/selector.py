"""The selector: warm up on live frames, rank the experiences, choose one or say that none fits,
localise in it, choose again."""

from __future__ import annotations

from ctypes import c_uint32, c_void_p, sizeof
from typing import Any, List, NamedTuple, Optional, Sequence, SupportsIndex, Tuple, Union

from numpy.typing import ArrayLike

from ._arrays import UINT32_MAX, block, floats, integer, shaped
from ._library import HistView, SelectAnswer, SelectCandidate, SelectConfig, SelectFrame
from ._library import TrustRunFields, lib
from .activations import Tap, Taps
from .distance import RankEntry, entries
from .experience import Experience
from .histogram import HistogramView, view_of
from .localiser import Localiser, Place, place_of
from .trust import StoredRun, Trust, TrustAnswer, trust_answer

_WARMUP, _NONE_FITS = 0, 2
_METHODS = ("emd", "transfer", "relative")  # indexed by VDNA_SELECT_BY_...
_INT64_MAX = 2**63 - 1
_TIME_UNITS = ("auto", "us", "ns", "ms", "s")  # indexed by VDNA_TIME_UNIT_...


class Candidate(NamedTuple):
    """What a selector needs of an experience that has no file."""

    histogram: HistogramView
    """Of all frames of the experience."""
    embeddings: ArrayLike
    """float32 [frames][dim]; do not change it while the selector is in use."""


class Match(NamedTuple):
    """The nearest frame of the experience localised in."""

    frame: int
    """Index of the frame."""
    distance_sq: float
    """Squared Euclidean distance of the embeddings; of their directions, by a localiser."""


class Answer(NamedTuple):
    """What a frame led to."""

    selected: bool
    """Whether an experience is chosen."""
    newly_ranked: bool
    """Whether this frame completed a warmup."""
    restarted: bool
    """Whether the warmup began anew: camera time stepped back, or had a gap longer than the warmup,
    or turned out to have another unit."""
    match: Optional[Match]
    """None if the frame was not localised."""
    none_fits: bool
    """Whether no experience fits, so that the chosen is but the least bad."""


class Selector:
    """Chooses an experience from the first live frames, then localises every frame in it.

    Frames and their times are arguments, so a replay gives the same answers at any speed.
    """

    def __init__(
        self,
        candidates: Sequence[Union[Experience, Candidate]],
        *,
        warmup_frames: SupportsIndex = 0,
        warmup_us: SupportsIndex = 0,
        warmup_frames_min: SupportsIndex = 10,
        late_us: SupportsIndex = 1_000_000,
        time_unit: str = "auto",
        localisers: Optional[Sequence[Localiser]] = None,
        top: SupportsIndex = 1,
        trust: Optional[Trust] = None,
        runs: Optional[Sequence[StoredRun]] = None,
        rank: str = "emd",
        stop_early: bool = False,
        reselect: bool = False,
        exact: SupportsIndex = 0,
    ) -> None:
        """
        candidates: at least one, all of one shape, range and dim; not copied
        warmup_frames: the first N accepted frames, or
        warmup_us: the first T microseconds of camera time; exactly one of both is not 0
        warmup_frames_min: a warmup by time goes on until it has as many frames
        late_us: a frame at most this much older than the newest is late; an older one begins the
                 warmup anew
        time_unit: of the stamps: "us", "ns", "ms", "s", or "auto" to recognise it
        localisers: one for each candidate, of its embeddings, which this selector feeds: `where` then
                    tells the place by the filter; None = the nearest frame by Euclidean distance
        top: localise in so many of the first of the ranking at once; 1 without localisers
        trust: in the choice among the candidates, which this selector feeds; with it, it may find that
               none fits, and then warms up again while it localises in the least bad
        runs: needed with trust: of each candidate, with its last layer if `trust.fit.by_likeness`
        rank: "emd", by the distance, or "transfer", where trust tells that of every candidate
        stop_early: choose when trust says that the choice has settled
        reselect: reconsider the choice while driving; needs trust and localisers
        exact: places of a ranking that have the distance, the rest a lower bound: see is_bound();
               0 = all
        VdnaError: MISMATCH if the candidates do not compare, EMPTY or OVERFLOW as emd()
        """
        if not candidates:
            raise ValueError("there is no candidate")
        embeddings = [floats(c.embeddings, "embeddings") for c in candidates]
        self._dim = shaped(embeddings[0], ("frames", "dim"), "embeddings").shape[1]
        structs = (SelectCandidate * len(candidates))()
        for candidate, values, out in zip(candidates, embeddings, structs):
            shaped(values, ("frames", self._dim), "embeddings")
            out.dna = view_of(candidate.histogram)
            out.embeddings = values.ctypes.data
            out.frames = integer(len(values), "the number of frames", 1, UINT32_MAX)

        config = SelectConfig()
        lib.vdna_select_config_init_sized(config, sizeof(config))
        config.candidates = structs
        config.candidate_count = len(structs)
        config.dim = integer(self._dim, "dim", 1, UINT32_MAX)
        config.warmup_frames = integer(warmup_frames, "warmup_frames", 0, UINT32_MAX)
        config.warmup_us = integer(warmup_us, "warmup_us", 0, _INT64_MAX)
        if (config.warmup_frames > 0) == (config.warmup_us > 0):
            raise ValueError("give either warmup_frames or warmup_us")
        config.warmup_frames_min = integer(warmup_frames_min, "warmup_frames_min", 0, UINT32_MAX)
        config.late_us = integer(late_us, "late_us", 0, _INT64_MAX)
        if time_unit not in _TIME_UNITS:
            raise ValueError(f"time_unit is {time_unit!r}, expected one of {', '.join(_TIME_UNITS)}")
        config.time_unit = _TIME_UNITS.index(time_unit)
        config.top = integer(top, "top", 1, UINT32_MAX)
        table = None if localisers is None else _addresses(localisers, len(candidates))
        if table is not None:
            config.localisers = table
        if rank not in _METHODS[:2]:
            raise ValueError(f"rank is {rank!r}, expected 'emd' or 'transfer'")
        if (trust is None) != (runs is None):
            raise ValueError("give trust and runs, or neither")
        config.rank = _METHODS.index(rank)
        config.stop_early, config.reselect = bool(stop_early), bool(reselect)
        config.exact = integer(exact, "exact", 0, UINT32_MAX)
        run_structs, self._last_layer_dim = None, 0
        if trust is not None and runs is not None:
            run_structs = _run_structs(runs, len(candidates))
            config.trust, config.runs = trust.address, run_structs
            self._last_layer_dim = run_structs[0].last_layer_dim if trust.fit.by_likeness else 0
        memory = block(lib.vdna_select_mem_size(config))
        self._select = c_void_p()  # within `memory`
        lib.vdna_select_init(config, memory.ctypes.data, memory.nbytes, self._select)

        self._candidates = len(candidates)
        # All that the library borrows.
        self._owner: Any = (
            (list(candidates), embeddings, structs, localisers, table, memory),
            (trust, runs, run_structs),
        )
        live = HistView()
        lib.vdna_select_live(self._select, live)
        self._live = HistogramView._over(self._owner, live)

    def __repr__(self) -> str:
        state = f"chosen {self.chosen}" if self.selected else f"{self.progress:.0%} of the warmup"
        return f"<Selector among {self._candidates} candidates, {state}>"

    def feed(
        self,
        utime: SupportsIndex,
        embedding: ArrayLike,
        *taps: Tap,
        last_layer: Optional[ArrayLike] = None,
    ) -> Answer:
        """Take one live frame; nothing of it is kept.

        utime: the camera's stamp
        embedding: float32 [dim]
        taps: as for Histogram.add()
        last_layer: float32 [its own size]; needed if `trust.fit.by_likeness`, ignored otherwise
        VdnaError: MISMATCH or NONFINITE for a bad frame, which is counted as rejected; LATE for one
                   older than a frame before it, which is counted as late; OVERFLOW or
                   FULL if the window is too large to rank, in which case the warmup begins anew
        """
        values = shaped(floats(embedding, "embedding"), (self._dim,), "embedding")
        activations = Taps(taps)
        frame = SelectFrame(
            integer(utime, "utime", -_INT64_MAX - 1, _INT64_MAX),
            activations.array,
            activations.count,
            values.ctypes.data,
        )
        last = None
        if self._last_layer_dim > 0 and last_layer is not None:
            last = shaped(floats(last_layer, "last_layer"), (self._last_layer_dim,), "last_layer")
        answer = SelectAnswer()
        last_address = None if last is None else last.ctypes.data
        lib.vdna_select_feed_seen(self._select, frame, last_address, answer)
        match = Match(answer.match.index, answer.match.distance_sq) if answer.localised else None
        return Answer(
            answer.state != _WARMUP,
            answer.newly_ranked != 0,
            answer.restarted != 0,
            match,
            answer.state == _NONE_FITS,
        )

    def reset(self) -> None:
        """Forget the choice and the window, and warm up again. Counters stay."""
        lib.vdna_select_reset(self._select)

    @property
    def selected(self) -> bool:
        """Whether an experience is chosen; else the warmup goes on."""
        return bool(lib.vdna_select_state(self._select) != _WARMUP)

    @property
    def none_fits(self) -> bool:
        """Whether no experience fits, so that the chosen is but the least bad; `trust` says why."""
        return bool(lib.vdna_select_state(self._select) == _NONE_FITS)

    @property
    def progress(self) -> float:
        """How far the warmup is: 0 to 1. If none fits, that of the next one."""
        return float(lib.vdna_select_progress(self._select))

    @property
    def chosen(self) -> Optional[int]:
        """Index of the chosen candidate; None during the warmup."""
        return int(lib.vdna_select_chosen(self._select)) if self.selected else None

    @property
    def where(self) -> Optional[Tuple[int, Place]]:
        """Index of the candidate localised in, and the place in it, by the newest frame that was
        localised; None without localisers, and until the first."""
        position = lib.vdna_select_where(self._select)
        if not position:
            return None
        return int(position.contents.candidate), place_of(position.contents.answer)

    @property
    def ranking(self) -> Optional[List[RankEntry]]:
        """All candidates, the chosen first; None during the warmup."""
        count = c_uint32()
        ranking = lib.vdna_select_ranking(self._select, count)
        return entries(ranking[: count.value]) if ranking else None

    def is_bound(self, candidate: SupportsIndex) -> bool:
        """Whether the ranking has a lower bound of this candidate's distance: see `exact`. False
        during the warmup."""
        index = integer(candidate, "candidate", 0, self._candidates - 1)
        return bool(lib.vdna_select_is_bound(self._select, index))

    @property
    def margin_bins(self) -> Optional[float]:
        """Distance of the second candidate less that of the first, 0 if there is but one, below 0 if
        something else than distance ranked them; None during the warmup."""
        return float(lib.vdna_select_margin_bins(self._select)) if self.selected else None

    @property
    def ranked_by(self) -> Optional[str]:
        """What ordered the ranking: "emd", "transfer", or "relative", after a warmup that stopped
        early without transfer of all; None during the warmup."""
        return _METHODS[lib.vdna_select_ranked_by(self._select)] if self.selected else None

    @property
    def trust(self) -> Optional[TrustAnswer]:
        """What trust said of the warmup; None without trust and during the warmup."""
        answer = lib.vdna_select_trust(self._select)
        if not answer:
            return None
        count = c_uint32()
        predictions = lib.vdna_select_predictions(self._select, count)
        return trust_answer(answer.contents, predictions[: count.value])

    @property
    def switches(self) -> int:
        """Switches to another choice while driving."""
        return int(lib.vdna_select_switches(self._select))

    @property
    def previous(self) -> Optional[int]:
        """Index of what was chosen before the newest switch; None if there was none."""
        return int(lib.vdna_select_previous(self._select)) if self.switches else None

    @property
    def live(self) -> HistogramView:
        """The Visual DNA of the warmup window so far."""
        return self._live

    @property
    def window_frames(self) -> int:
        """Frames in the warmup window so far."""
        return int(lib.vdna_select_window_frames(self._select))

    @property
    def window_utime(self) -> Optional[Tuple[int, int]]:
        """Stamps of the oldest and the newest frame in the warmup window; None if it is empty."""
        if self.window_frames == 0:
            return None
        first = lib.vdna_select_first_utime(self._select)
        return int(first), int(lib.vdna_select_last_utime(self._select))

    @property
    def accepted(self) -> int:
        """Frames taken since the selector was made."""
        return int(lib.vdna_select_accepted(self._select))

    @property
    def rejected(self) -> int:
        """Frames refused since the selector was made."""
        return int(lib.vdna_select_rejected(self._select))

    @property
    def late(self) -> int:
        """Frames left out because they were older than one before them."""
        return int(lib.vdna_select_time(self._select).contents.late)

    @property
    def restarts(self) -> int:
        """Warmups begun anew because of their frames' times."""
        return int(lib.vdna_select_restarts(self._select))


def _addresses(localisers: Sequence[Localiser], count: int) -> Any:
    if len(localisers) != count:
        raise ValueError(
            f"there are {len(localisers)} localisers, expected one for each of {count} candidates"
        )
    return (c_void_p * count)(*(localiser.address for localiser in localisers))


def _run_structs(runs: Sequence[StoredRun], count: int) -> Any:
    if len(runs) != count:
        raise ValueError(
            f"there are {len(runs)} runs, expected one for each of {count} candidates"
        )
    return (TrustRunFields * count)(*(run.fields for run in runs))
