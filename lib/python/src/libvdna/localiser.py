"""The localiser: where in one experience is the robot, by the frames so far and not the last alone."""

from __future__ import annotations

from ctypes import POINTER, c_double, c_int64, c_void_p
from typing import NamedTuple, Optional, Sequence, SupportsIndex, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, block, floats, integer, integers, shaped, view
from ._library import GearFields, LocaliseAnswer, LocaliseConfig, LocaliseMapConfig, lib
from .experience import Experience

_GEAR_SHARES = 6


class Gear(NamedTuple):
    """How far the robot may get in the map from one live frame to the next."""

    first: int
    """Map frames, -8..3, for the first share."""
    shares: Tuple[float, ...]
    """Probabilities of `first`, `first` + 1, ...: at most 6, their sum 1."""


class Place(NamedTuple):
    """Where the robot is."""

    frame: int
    """Frame of the experience, by the filter."""
    confidence: float
    """0..1, of `frame`."""
    mass: float
    """Posterior of the frames within the tolerance of `frame`'s window."""
    moving: bool
    """Whether the filter was stepped; while the robot stands, the three above stay."""
    nearest: int
    """Frame of least distance to this live frame alone."""
    nearest_distance: float
    """Of `nearest`: 0 = same direction, 1 = no likeness."""


class Localiser:
    """Follows a robot in one experience. vdna/localise.h has the definition."""

    def __init__(
        self,
        embeddings: ArrayLike,
        *,
        tolerance: SupportsIndex,
        places: Optional[ArrayLike] = None,
        centred: bool = True,
        mean_frames: SupportsIndex = 3,
        mean_frames_max: SupportsIndex = 1000,
        gate: float = 0.15,
        gears: Optional[Sequence[Gear]] = None,
        sharpness: float = 2.0,
        clutter: float = 0.1,
        jump: float = 0.01,
        gear_change: float = 0.05,
        evidence_share: float = 0.15,
        confidence: Sequence[float] = (3.6, 0.53, 1.1, -12.0),
    ) -> None:
        """
        embeddings: float32 [frames][dim] of the experience, in the order of the drive; not kept
        tolerance: greatest difference of two numbers of the same place
        places: int64 [frames], place numbers in any order, PLACE_NONE = a place of its own; None =
                the index of the frame
        centred: whether directions are about the means
        mean_frames: frames that the experience's mean is worth in the live mean; 0 = begins empty
        mean_frames_max: frames of memory of the live mean
        gate: of the experience's median step: standing if nearer to the last frame that counted
        gears: None = those of the definition
        sharpness, clutter, jump, gear_change, evidence_share, confidence: of the definition
        VdnaError: NONFINITE for a number that is not finite, ARG for a setting beyond its range
        """
        frames = shaped(floats(embeddings, "embeddings"), ("frames", "dim"), "embeddings")
        self._frames, self._dim = frames.shape
        map_config = LocaliseMapConfig()
        lib.vdna_localise_map_config_init(map_config)
        map_config.frames = integer(self._frames, "the number of frames", 0, UINT32_MAX)
        map_config.dim = integer(self._dim, "dim", 0, UINT32_MAX)
        map_config.centred = bool(centred)
        map_config.embeddings = frames.ctypes.data
        map_memory = block(lib.vdna_localise_map_mem_size(map_config))
        self._map = c_void_p()  # within `map_memory`
        lib.vdna_localise_map_init(map_config, map_memory.ctypes.data, map_memory.nbytes, self._map)

        config = LocaliseConfig()
        lib.vdna_localise_config_init(config)
        config.map = self._map
        config.tolerance = integer(tolerance, "tolerance", 0, UINT32_MAX)
        config.mean_frames = integer(mean_frames, "mean_frames", 0, UINT32_MAX)
        config.mean_frames_max = integer(mean_frames_max, "mean_frames_max", 0, UINT32_MAX)
        config.gate, config.sharpness, config.clutter = gate, sharpness, clutter
        config.jump, config.gear_change = jump, gear_change
        config.evidence_share = evidence_share
        config.confidence = (c_double * 4)(*confidence)
        numbers = None if places is None else self._places(places)
        if numbers is not None:
            config.place = numbers.ctypes.data_as(POINTER(c_int64))
        table = None if gears is None else (GearFields * len(gears))(*map(_fields_of, gears))
        if table is not None:
            config.gears = table
            config.gear_count = integer(len(table), "the number of gears", 1, UINT32_MAX)
        memory = block(lib.vdna_localise_mem_size(config))
        self._localise = c_void_p()  # within `memory`
        lib.vdna_localise_init(config, memory.ctypes.data, memory.nbytes, self._localise)
        self._owner = (map_memory, memory)

    @classmethod
    def of(cls, experience: Experience, tolerance: float = 5.0) -> Localiser:
        """A localiser in an experience, by places that fit it: a spot that the route passes again is
        one place. vdna/experience_localise.h has the definition.

        tolerance: within which a match is good: metres if the experience has positions, else place
                   numbers
        """
        place = np.empty(experience.frames, np.int64)
        config = LocaliseConfig()
        lib.vdna_localise_config_init(config)
        lib.vdna_experience_localise_config(
            experience.struct, float(tolerance), place.ctypes.data, config
        )
        return cls(
            experience.embeddings,
            tolerance=config.tolerance,
            places=place if config.place else None,
            centred=experience.identity.is_centred,
            clutter=config.clutter,
            confidence=tuple(config.confidence),
        )

    def __repr__(self) -> str:
        return f"<Localiser in {self._frames} frames, embeddings of {self._dim}>"

    def _places(self, places: ArrayLike) -> NDArray[np.int64]:
        return shaped(integers(places, "places", np.int64), (self._frames,), "places")

    def _embedding(self, embedding: ArrayLike) -> NDArray[np.float32]:
        return shaped(floats(embedding, "embedding"), (self._dim,), "embedding")

    def warm_up(self, embedding: ArrayLike) -> None:
        """Take a frame of the warmup into the live mean only.

        embedding: float32 [dim]
        VdnaError: NONFINITE for a number that is not finite
        """
        lib.vdna_localise_warm_up(self._localise, self._embedding(embedding).ctypes.data)

    def feed(self, embedding: ArrayLike) -> Place:
        """Localise a frame.

        embedding: float32 [dim]
        VdnaError: NONFINITE for a number that is not finite
        """
        answer = LocaliseAnswer()
        lib.vdna_localise_feed(self._localise, self._embedding(embedding).ctypes.data, answer)
        return place_of(answer)

    def feed_distances(self, distances: ArrayLike) -> Place:
        """Step the filter by distances from elsewhere; the live mean stays.

        distances: float32 [frames], smaller = more alike; of any scale, but the last constant of the
                   confidence counts them as they are
        VdnaError: NONFINITE for one that is not finite, or beyond 1e18
        """
        row = shaped(floats(distances, "distances"), (self._frames,), "distances")
        answer = LocaliseAnswer()
        lib.vdna_localise_feed_distances(self._localise, row.ctypes.data, answer)
        return place_of(answer)

    def reset(self) -> None:
        """Forget the live mean and the posterior."""
        lib.vdna_localise_reset(self._localise)

    @property
    def address(self) -> Optional[int]:
        """Of the C object, as long as this one lives."""
        return self._localise.value

    @property
    def distances(self) -> NDArray[np.float32]:
        """[frames]: of the frame that was fed last; follows the next one."""
        address = lib.vdna_localise_distances(self._localise)
        return view(self._owner, address, (self._frames,), np.float32)

    @property
    def mean(self) -> NDArray[np.float64]:
        """[dim]: the live mean; follows the next frame."""
        address = lib.vdna_localise_mean(self._localise)
        return view(self._owner, address, (self._dim,), np.float64)

    @property
    def posterior(self) -> NDArray[np.float64]:
        """[frames]: the posterior of every frame, their sum 1; a copy."""
        out = np.empty(self._frames, np.float64)
        lib.vdna_localise_posterior(self._localise, out.ctypes.data)
        return out

    @property
    def evidence(self) -> float:
        """Running mean of the log evidence, in nats; 0 = the frames look like any place."""
        return float(lib.vdna_localise_evidence(self._localise))

    @property
    def jumps(self) -> int:
        """Among the last 64 steps, those that no gear makes: on another route there are many."""
        return int(lib.vdna_localise_jumps(self._localise))

    @property
    def step(self) -> float:
        """Median Euclidean distance of the experience's neighbouring frames."""
        return float(lib.vdna_localise_map_step(self._map))


def _fields_of(gear: Gear) -> GearFields:
    first, shares = gear
    if len(shares) > _GEAR_SHARES:
        raise ValueError(f"a gear has {len(shares)} shares, expected at most {_GEAR_SHARES}")
    padded = (c_double * _GEAR_SHARES)(*shares)
    return GearFields(integer(first, "first", -(2**31), 2**31 - 1), 0, padded)


def place_of(answer: LocaliseAnswer) -> Place:
    """What the library says of a place."""
    return Place(
        answer.frame,
        answer.confidence,
        answer.mass,
        answer.moving != 0,
        answer.nearest,
        answer.nearest_distance,
    )
