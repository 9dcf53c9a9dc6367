"""The selector."""

import gc

import numpy as np
import pytest
from conftest import histogram_of, small_experience

from libvdna import (
    Candidate,
    Experience,
    Localiser,
    Match,
    RankEntry,
    Selector,
    Status,
    StoredRun,
    Trust,
    TrustTables,
    VdnaError,
    Verdict,
    emd_mean,
)


@pytest.fixture
def candidates(unit_range):
    """Dark and bright; each has two frames, whose embeddings are the axes."""
    return [
        Candidate(histogram_of([[level] * 3] * 2, unit_range), np.eye(2, dtype=np.float32))
        for level in (-0.9, 0.9)
    ]


BRIGHT = np.array([0.7, 0.7, 0.7], np.float32)


def test_it_warms_up_chooses_and_localises(candidates, unit_range):
    selector = Selector(candidates, warmup_frames=2)
    assert (selector.selected, selector.chosen, selector.ranking) == (False, None, None)
    assert (selector.progress, selector.margin_bins) == (0, None)

    answer = selector.feed(0, [1, 0], BRIGHT)
    assert answer == (False, False, False, None, False)
    assert selector.progress == 0.5 and selector.live.mass.tolist() == [1, 1, 1]
    assert (selector.window_frames, selector.window_utime) == (1, (0, 0))

    answer = selector.feed(1000, [1, 0], BRIGHT)
    assert answer.selected and answer.newly_ranked
    live = histogram_of([BRIGHT, BRIGHT], unit_range)
    distances = [emd_mean(live, candidate.histogram) for candidate in candidates]
    assert selector.ranking == [
        RankEntry(distances[1], 1, False),
        RankEntry(distances[0], 0, False),
    ]
    assert selector.chosen == 1
    assert selector.margin_bins == distances[0] - distances[1]

    answer = selector.feed(2000, [0, 0.5], BRIGHT)
    assert answer.match == Match(1, 0.25) and not answer.newly_ranked
    assert (selector.accepted, selector.rejected, selector.restarts) == (3, 0, 0)

    selector.reset()
    assert not selector.selected and selector.ranking is None and selector.progress == 0
    assert (selector.window_frames, selector.window_utime) == (0, None)


def test_places_beyond_the_exact_ones_have_bounds(candidates):
    for exact, is_bound in ((0, False), (1, True), (2, False)):
        selector = Selector(candidates, warmup_frames=1, exact=exact)
        assert not selector.is_bound(0)
        selector.feed(0, [1, 0], BRIGHT)
        assert [entry.candidate for entry in selector.ranking] == [1, 0]
        assert (selector.is_bound(1), selector.is_bound(0)) == (False, is_bound)
        with pytest.raises(ValueError, match="candidate is 2"):
            selector.is_bound(2)


def on_circle(turns):
    return np.array([np.cos(2 * np.pi * turns), np.sin(2 * np.pi * turns)], np.float32)


def test_localisers_follow_from_the_warmup_on(unit_range):
    """Both experiences go once round a circle; the drive is bright."""
    frames = np.array([on_circle(i / 12) for i in range(12)])
    levels = [histogram_of([[level] * 3], unit_range) for level in (-0.9, 0.9)]
    localisers = [Localiser(frames, tolerance=1) for _ in levels]
    selector = Selector(
        [Candidate(histogram, frames) for histogram in levels],
        warmup_frames=2,
        localisers=localisers,
        top=2,
    )
    for i in range(8):
        assert (selector.where is None) == (i < 2)
        answer = selector.feed(1000 * i, on_circle(i / 12), BRIGHT)
    candidate, place = selector.where
    assert candidate == 1 and abs(place.frame - 7) <= 1 and place.moving
    assert answer.match == Match(place.nearest, 2 * place.nearest_distance)
    assert localisers[1].evidence > 0
    selector.reset()
    assert selector.where is None and localisers[1].evidence == 0


def tables_of(count, nearest=0.1, recall=0.9):
    """Runs that are `nearest` to one another, and localise one another as well."""
    cells = np.full((count, count, 4, 7), np.nan)
    cells[:, :, 0], cells[:, :, 2], cells[:, :, 3] = nearest, recall, 1
    return TrustTables(np.full(count, 30, np.uint32), np.ones(count), np.ones(count), cells)


def test_where_none_fits_it_says_so_and_chooses_again(candidates):
    runs = [StoredRun(candidate.embeddings) for candidate in candidates]
    selector = Selector(candidates, warmup_frames=5, trust=Trust(tables_of(2)), runs=runs)
    assert selector.trust is None and selector.ranked_by is None
    for i in range(5):
        answer = selector.feed(1000 * i, [-1, 0], BRIGHT)
    assert answer == (True, True, False, None, True)
    assert selector.selected and selector.none_fits and selector.chosen == 1
    assert selector.trust.verdict is Verdict.UNLIKE and selector.trust.frames == 5
    assert len(selector.trust.predictions) == 2 and selector.ranked_by == "emd"
    for i in range(5, 10):
        assert selector.none_fits
        answer = selector.feed(1000 * i, [1, 0], BRIGHT)
    assert answer == (True, True, False, Match(0, 0), False)
    assert selector.trust.verdict is Verdict.FITS
    assert (selector.switches, selector.previous) == (0, None)


def test_it_stops_early_and_ranks_by_transfer(candidates):
    three = [*candidates, candidates[0]]
    runs = [StoredRun(candidate.embeddings + np.float32(i)) for i, candidate in enumerate(three)]
    options = {"trust": Trust(tables_of(3)), "runs": runs, "warmup_frames": 20}
    early = Selector(three, stop_early=True, **options)
    frames = 1
    while not early.feed(1000 * frames, [1, 0], BRIGHT).selected:
        frames += 1
    assert frames == early.trust.settled_frames == 10
    scores = [prediction.score for prediction in early.trust.predictions]
    assert early.ranked_by == "relative" and early.chosen == np.argmax(scores) == 0
    assert early.margin_bins < 0

    whole = Selector(three, rank="transfer", **options)
    for i in range(20):
        whole.feed(1000 * i, [1, 0], BRIGHT)
    assert whole.ranked_by == "transfer" and whole.chosen == 1


def test_the_last_layer_is_given_where_trust_judges_by_it(candidates):
    tables = tables_of(2)
    tables.cells[:, :, 1] = 0.1
    layer = np.array([[100, 0, 3], [0, 100, 3]], np.float32)
    runs = [StoredRun(candidate.embeddings, last_layer=layer) for candidate in candidates]
    selector = Selector(candidates, warmup_frames=5, trust=Trust(tables), runs=runs)
    with pytest.raises(VdnaError) as caught:
        selector.feed(0, [1, 0], BRIGHT)
    assert caught.value.status is Status.ARG
    with pytest.raises(ValueError, match=r"last_layer has the shape \[1\], expected \[3\]"):
        selector.feed(0, [1, 0], BRIGHT, last_layer=[1])
    for i in range(5):
        selector.feed(1000 * i, [1, 0], BRIGHT, last_layer=-layer[0])
    assert selector.none_fits


def test_it_chooses_again_while_driving(unit_range):
    """The second experience goes round the circle, the first one stands elsewhere."""
    circle = np.array([on_circle(i / 12) for i in range(12)])
    frames = [circle[:1] + np.linspace(0, 0.01, 12)[:, None], circle]
    runs = [StoredRun(values) for values in frames]
    selector = Selector(
        [
            Candidate(histogram_of([[level] * 3], unit_range), values)
            for level, values in zip((0.9, -0.9), frames)
        ],
        warmup_frames=2,
        localisers=[Localiser(values, tolerance=1) for values in frames],
        trust=Trust(None, runs=2, switch_cost=1),
        runs=runs,
        reselect=True,
    )
    for i in range(60):
        selector.feed(1000 * i, on_circle(i / 12), BRIGHT)
    assert selector.switches == 1 and (selector.previous, selector.chosen) == (0, 1)
    assert selector.where[0] == 1 and selector.ranking[0].candidate == 1


def test_what_does_not_go_with_trust_is_refused(candidates):
    trust, runs = Trust(None, runs=2), [StoredRun(candidates[0].embeddings)] * 2
    with pytest.raises(ValueError, match="give trust and runs, or neither"):
        Selector(candidates, warmup_frames=2, trust=trust)
    with pytest.raises(ValueError, match="there are 1 runs, expected one for each of 2"):
        Selector(candidates, warmup_frames=2, trust=trust, runs=runs[:1])
    with pytest.raises(ValueError, match="rank is 'relative', expected 'emd' or 'transfer'"):
        Selector(candidates, warmup_frames=2, rank="relative")
    for wrong in ({"reselect": True}, {"reselect": True, "trust": trust, "runs": runs}):
        with pytest.raises(VdnaError) as caught:
            Selector(candidates, warmup_frames=2, **wrong)
        assert caught.value.status is Status.ARG


def test_localisers_must_be_those_of_the_candidates(candidates):
    one = [Localiser(candidates[0].embeddings, tolerance=0)]
    with pytest.raises(ValueError, match="1 localisers, expected one for each of 2"):
        Selector(candidates, warmup_frames=2, localisers=one)
    short = one + [Localiser(np.eye(2, dtype=np.float32)[:1], tolerance=0)]
    with pytest.raises(VdnaError, match="invalid argument"):
        Selector(candidates, warmup_frames=2, localisers=short)


def test_a_window_of_time_ends_with_the_first_frame_beyond_it(candidates):
    selector = Selector(candidates, warmup_us=1_000_000, warmup_frames_min=2)
    assert not selector.feed(5, [0, 1], BRIGHT).selected
    assert not selector.feed(1_000_004, [0, 1], BRIGHT).selected
    assert selector.feed(1_000_005, [0, 1], BRIGHT).selected


def test_time_that_runs_backwards_begins_anew(candidates):
    selector = Selector(candidates, warmup_frames=3)
    selector.feed(2_000_000, [0, 1], BRIGHT)
    assert selector.feed(999_999, [0, 1], BRIGHT).restarted
    assert selector.restarts == 1 and selector.live.mass.tolist() == [1, 1, 1]


def test_a_late_frame_is_refused_and_counted(candidates):
    selector = Selector(candidates, warmup_frames=3, late_us=5, time_unit="ms")
    selector.feed(10, [0, 1], BRIGHT)
    selector.feed(11, [0, 1], BRIGHT)
    with pytest.raises(VdnaError) as caught:
        selector.feed(10, [0, 1], BRIGHT)
    assert caught.value.status is Status.LATE
    assert (selector.late, selector.rejected, selector.window_frames) == (1, 0, 2)
    assert selector.window_utime == (10_000, 11_000)
    with pytest.raises(ValueError, match="time_unit"):
        Selector(candidates, warmup_frames=3, time_unit="minutes")


def test_a_refused_frame_is_counted_and_nothing_else(candidates):
    selector = Selector(candidates, warmup_frames=2)
    for bad in ([np.nan] * 3, [0, 0]):
        with pytest.raises(VdnaError):
            selector.feed(0, [0, 1], bad)
    assert (selector.rejected, selector.accepted, selector.progress) == (2, 0, 0)
    for embedding in ([0], [0, 0, 0], [[0, 0]]):
        with pytest.raises(ValueError, match="embedding has the shape"):
            selector.feed(0, embedding, BRIGHT)
    with pytest.raises(ValueError, match="utime"):
        selector.feed(2**63, [0, 1], BRIGHT)
    assert selector.rejected == 2


def test_a_selector_that_cannot_be_is_refused(candidates, unit_range):
    for warmup in ({}, {"warmup_frames": 1, "warmup_us": 1}, {"warmup_frames": -1}):
        with pytest.raises(ValueError):
            Selector(candidates, **warmup)
    with pytest.raises(ValueError):
        Selector([], warmup_frames=1)
    other = histogram_of([[0, 0, 0]], unit_range, 11)
    with pytest.raises(VdnaError) as caught:
        Selector([candidates[0], Candidate(other, [[0, 1]])], warmup_frames=1)
    assert caught.value.status is Status.MISMATCH
    dna = candidates[0].histogram
    for embeddings in ([[0, 1, 2]], [0, 1], np.empty((0, 2)), np.empty((2, 0))):
        with pytest.raises(ValueError):
            Selector([candidates[0], Candidate(dna, embeddings)], warmup_frames=1)


def test_it_keeps_its_experiences_open(tmp_path):
    path = tmp_path / "winter.vdna"
    small_experience().write(path)
    selector = Selector([Experience.open(path)], warmup_frames=1)
    gc.collect()
    taps = [np.zeros((4, 2)), [0]]
    selector.feed(0, [0, 0.5, -0.5, 0.5, -0.5], *taps)
    answer = selector.feed(1, [0, 0.5, -0.5, 0.5, -0.5], *taps)
    assert answer.match == Match(1, 0.0)
    assert str(path) in open("/proc/self/maps").read()
    live = selector.live
    del selector
    gc.collect()
    assert live.counts.sum() == 9
