"""The localiser."""

import gc
import pathlib
import sys

import numpy as np
import pytest

from conftest import small_experience

from libvdna import PLACE_NONE, Gear, Localiser, Status, VdnaError

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "test" / "golden"))
from make_localise import Filter, Live  # noqa: E402  the definition in plain Python

FRAMES, DIM = 60, 24
RATES, PHASES = 0.2 + 0.043 * np.arange(DIM), 1.3 * np.arange(DIM)


def look(place, light=1.0):
    return (light * np.sin(np.multiply.outer(place, RATES) + PHASES)).astype(np.float32)


ROUTE = look(np.arange(FRAMES))


def test_it_follows_a_robot():
    localiser = Localiser(ROUTE, tolerance=3)
    for place in range(20, 45):
        answer = localiser.feed(look(place, 0.7))
    assert abs(answer.frame - 44) <= 3 and answer.nearest == 44
    assert answer.confidence > 0.9 and answer.mass > 0.99 and answer.moving
    stood = localiser.feed(look(place, 0.7))
    assert stood == answer._replace(moving=False)


def two_laps(**changes):
    """An experience that drives a circle of 60 m twice, and looks alike in both laps."""
    turns = 2 * np.pi * np.arange(2 * FRAMES) / FRAMES
    circle = 60 / (2 * np.pi) * np.array([np.cos(turns), np.sin(turns), 0 * turns]).T
    frames = 2 * FRAMES
    fields = {
        "embeddings": np.concatenate([ROUTE, ROUTE]),
        "frame_utime": np.arange(frames),
        "frame_grey": np.zeros(frames, np.float32),
        "frame_place": None,
        "frame_position": circle,
        "embedding": "grid 3x3 centred",
    }
    return small_experience(**{**fields, **changes})


def test_a_spot_that_is_passed_again_is_one_place():
    def mass(experience):
        localiser = Localiser.of(experience, tolerance=3)
        for place in range(20, 45):
            answer = localiser.feed(look(place, 0.7))
        assert abs(answer.frame % FRAMES - 44) <= 3
        return answer.mass

    assert mass(two_laps()) > 0.9 > 0.6 > mass(two_laps(frame_position=None))
    with pytest.raises(VdnaError, match="invalid argument"):
        Localiser.of(two_laps(), tolerance=-1)


def test_the_filter_is_that_of_the_definition():
    random = np.random.default_rng(1)
    places = [*range(30), *range(1029, 1000, -1), PLACE_NONE]
    gears = [Gear(-8, (0.5, 0.5)), Gear(3, (0.25, 0.25, 0.5))]
    options = {"sharpness": 1.5, "clutter": 0.3, "jump": 0.05, "gear_change": 0.2,
               "evidence_share": 0.4, "confidence": (-1, 0.5, 2, -3)}  # fmt: skip
    localiser = Localiser(ROUTE, tolerance=2, places=places, gears=gears, **options)
    padded = [(gear.first, list(gear.shares) + [0] * (6 - len(gear.shares))) for gear in gears]
    definition = Filter(FRAMES, 2, places, gears=padded, **options)
    for _ in range(10):
        distances = random.random(FRAMES, np.float32)
        found, expected = localiser.feed_distances(distances), definition.step(distances.tolist())
        assert (found.frame, found.nearest) == (expected[0], distances.argmin())
        assert (found.confidence, found.mass) == pytest.approx(expected[1:], abs=1e-9)
    assert localiser.posterior == pytest.approx(definition.places(), abs=1e-9)
    assert localiser.evidence == pytest.approx(definition.evidence, abs=1e-9)


def test_live_mean_and_distances_are_those_of_the_definition():
    localiser, definition = Localiser(ROUTE, tolerance=3), Live(ROUTE.tolist(), 3)
    assert localiser.step == definition.step
    for place in (20, 21.5, 21.5, 25):
        frame = look(place, 0.6)
        moving = localiser.feed(frame).moving
        assert moving == definition.add(frame.tolist())
        expected = definition.distances(frame.tolist())
        assert localiser.distances == pytest.approx(expected, abs=np.sqrt(DIM) / 32500)
    assert localiser.mean == pytest.approx(definition.mean, abs=1e-12)


def test_a_warmup_moves_the_mean_only():
    localiser = Localiser(ROUTE, tolerance=3)
    begin = localiser.mean.copy()
    assert begin == pytest.approx(ROUTE.mean(0, np.float64), abs=1e-12)
    localiser.warm_up(look(20))
    assert localiser.mean == pytest.approx((3 * begin + look(20)) / 4, abs=1e-12)
    assert localiser.posterior == pytest.approx(np.full(FRAMES, 1 / FRAMES))
    localiser.reset()
    assert (localiser.mean == begin).all()


def test_what_it_gave_outlives_it():
    localiser = Localiser(ROUTE, tolerance=3)
    localiser.feed(look(20))
    distances, kept = localiser.distances, localiser.distances.tolist()
    del localiser
    gc.collect()
    assert distances.tolist() == kept
    assert not distances.flags.writeable


def test_a_number_that_is_not_finite_is_refused_and_changes_nothing():
    localiser, bad = Localiser(ROUTE, tolerance=3), look(20)
    localiser.feed(look(19))
    before = localiser.posterior
    bad[3] = np.nan
    for refused in (localiser.feed, localiser.warm_up, lambda _: Localiser([bad], tolerance=3)):
        with pytest.raises(VdnaError) as caught:
            refused(bad)
        assert caught.value.status is Status.NONFINITE
    assert (localiser.posterior == before).all()


@pytest.mark.parametrize(
    "wrong",
    [
        {"clutter": 0},
        {"jump": 2},
        {"gate": -1},
        {"mean_frames_max": 0},
        {"gears": []},
        {"gears": [Gear(0, (0.5,))]},
        {"gears": [Gear(4, (1,))]},
        {"gears": [Gear(0, (0.1,) * 10)]},
        {"places": [1, 2]},
        {"tolerance": -1},
        {"confidence": (1, 2, 3, 4, 5)},
    ],
)
def test_a_setting_beyond_its_range_is_refused(wrong):
    with pytest.raises((VdnaError, ValueError, IndexError)):
        Localiser(ROUTE, **{"tolerance": 3, **wrong})


def test_an_embedding_of_another_shape_is_refused():
    localiser = Localiser(ROUTE, tolerance=3)
    with pytest.raises(ValueError, match=r"embedding has the shape \[3\], expected \[24\]"):
        localiser.feed([1, 2, 3])
    with pytest.raises(ValueError, match=r"distances has the shape \[24\], expected \[60\]"):
        localiser.feed_distances(look(20))
    with pytest.raises(ValueError, match="embeddings has the shape"):
        Localiser(look(20), tolerance=3)
