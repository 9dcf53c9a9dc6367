"""Trust in the choice, against the numbers of the references in test/golden."""

import gc
import math
import pathlib
import re

import numpy as np
import pytest
from conftest import small_experience

import libvdna
from libvdna import PLACE_NONE, TRUST_CELL, TRUST_WINDOWS, Status, StoredRun, Trust, TrustTables
from libvdna import VdnaError, Verdict, trust_recall, trust_tables, trust_windows

HEADER = pathlib.Path(__file__).resolve().parents[3] / "test/golden/trust_golden.h"
GOLDEN = {
    name: np.array([float(x.rstrip("f")) for x in values.split(",")])
    for name, values in re.findall(r"golden_(\w+)\[\] = \{([^}]*)\}", HEADER.read_text())
}


def near(values):
    return pytest.approx(values, rel=0, abs=1e-9, nan_ok=True)


def tables_of(name):
    count = len(GOLDEN[f"{name}_own"])
    return TrustTables(
        GOLDEN[f"{name}_frames"].astype(np.uint32),
        GOLDEN[f"{name}_own"],
        GOLDEN[f"{name}_correlation"],
        GOLDEN[f"{name}_cells"].reshape(count, count, len(TRUST_CELL), TRUST_WINDOWS),
    )


def fed(trust, name):
    for row in GOLDEN[f"{name}_live"].reshape(-1, len(GOLDEN[f"{name}_own"])):
        trust.feed(row)
    return trust


@pytest.mark.parametrize("name", ["centred", "six"])
def test_predictions_are_those_of_the_reference(name):
    answer = fed(Trust(tables_of(name)), name).predict(GOLDEN[f"{name}_distances"])
    for key in ("recall", "low", "high", "transfer"):
        assert [getattr(p, key) for p in answer.predictions] == near(GOLDEN[f"{name}_{key}"])
    assert {p.reason for p in answer.predictions} == {""}
    assert answer.verdict is Verdict.FITS and answer.frames == len(GOLDEN[f"{name}_live"]) / len(
        answer.predictions
    )


def test_the_papers_localiser_and_the_fit_are_those_of_the_reference():
    trust = fed(Trust(tables_of("euclidean"), centred=False), "euclidean")
    fit, answer = trust.fit, trust.predict()
    assert [fit.slope, fit.sd, fit.sd_best, fit.quantile] == near(GOLDEN["euclidean_fit"])
    assert [fit.skill, fit.far, fit.correlation, answer.unlike] == near(
        [GOLDEN[f"euclidean_{key}"][0] for key in ("skill", "far", "tau", "unlike")]
    )
    assert fit.labelled == 3 and fit.by_likeness is False
    assert trust.intercepts == near(GOLDEN["euclidean_c"])
    assert [p.recall for p in answer.predictions] == near(GOLDEN["euclidean_recall"])
    assert [p.nearest for p in answer.predictions] == near(GOLDEN["euclidean_nearest"])


def test_it_chooses_again_as_the_reference_does():
    trust = Trust(tables_of("euclidean"), centred=False, switch_cost=3)
    trust.choose(2)
    for t, row in enumerate(GOLDEN["drive_live"].reshape(-1, 3)):
        expected = trust.expect(row)
        assert expected == near(GOLDEN["drive_expected"][3 * t : 3 * t + 3])
        assert trust.reconsider(expected) == GOLDEN["drive_choice"][t]


def runs_of(**options):
    places, begin = GOLDEN["run_places"].astype(np.int64), 0
    for i in range(3):
        embeddings = GOLDEN[f"run{i}"].reshape(-1, 8).astype(np.float32)
        labels = places[begin : begin + len(embeddings)]
        begin += len(embeddings)
        yield StoredRun(embeddings, places=labels, **options)


def test_tables_of_runs_are_those_of_the_reference():
    runs = list(runs_of())
    distances = GOLDEN["run_cells"].reshape(3, 3, 4, 7)[:, :, 3]
    tables = trust_tables(runs, 2, distances=distances)
    assert tables.own_scale == near(GOLDEN["run_own"])
    assert tables.correlation == near(GOLDEN["run_correlation"])
    assert tables.cells == near(GOLDEN["run_cells"].reshape(3, 3, 4, 7))
    assert tables.frames.tolist() == [40, 17, 5]
    plain = trust_tables(runs, 2, centred=False).cells
    assert plain[:, :, 2] == near(GOLDEN["run_cells_euclidean"].reshape(3, 3, 4, 7)[:, :, 2])
    assert np.isnan(plain[:, :, 3]).all()
    assert Trust(tables).fit.labelled == 3


def test_positions_decide_before_places():
    embeddings = GOLDEN["run0"].reshape(-1, 8)
    places = GOLDEN["run_places"][:40]
    positions = np.stack([3 * places, 4 * places, 0 * places], 1)
    none = np.full(40, PLACE_NONE)
    tables = trust_tables([StoredRun(embeddings, places=none, positions=positions)], 7)
    assert tables.own_scale == near(GOLDEN["run_own_metres"][:1])
    assert trust_tables([StoredRun(embeddings, places=none)], 7).own_scale == [1]


def test_the_last_layer_judges_what_is_unlike():
    random = np.random.default_rng(1)
    last_layer = random.normal(size=(12, 6))
    runs = [
        StoredRun(random.normal(size=(12, 4)) + 3, last_layer=last_layer[::step]) for step in (1, -1)
    ]
    tables = trust_tables(runs, 0)
    assert np.allclose(tables.cells[0, 1, 1], 0) and np.isnan(tables.cells[0, 1, 2]).all()
    trust = Trust(tables)
    assert trust.fit.by_likeness and trust.fit.far == near(math.log(1e-6))
    with pytest.raises(VdnaError) as caught:
        trust.feed([0.1, 0.2])
    assert caught.value.status is Status.ARG
    assert [run.likeness(last_layer[3]) for run in runs] == near([0, 0])
    for _ in range(5):
        trust.feed([0.1, 0.2], [run.likeness(last_layer[3] + 0.3) for run in runs])
    answer = trust.predict()
    assert answer.verdict is Verdict.UNLIKE
    assert answer.predictions[0].reason == "the live frames look like none of the experiences"


def test_nearest_frames_by_hand():
    run = StoredRun([[300, 400], [0, 5]], last_layer=[[0, 127], [127, 0]])
    assert run.nearest([3, 4]) == (near(math.sqrt(10 / 25)), 1)
    assert run.likeness([0, 254]) == near(math.sqrt(127**2 / (254 * 127)))
    with pytest.raises(ValueError, match="no last layer"):
        StoredRun([[1, 2]]).likeness([1])
    with pytest.raises(ValueError, match=r"embedding has the shape \[1\], expected \[2\]"):
        run.nearest([1])
    first, length = trust_windows(48)
    assert first.tolist() == [0, 5, 11, 16, 21, 27, 32] and length == 16


def test_a_map_that_knows_nothing_says_so():
    trust = Trust(None, runs=2)
    for _ in range(20):
        trust.feed([0.1, 0.2])
    answer = trust.predict()
    assert (answer.verdict, answer.choice, answer.settled_frames) == (Verdict.FITS, 0, 0)
    assert answer.predictions[1].reason == "the map knows nothing about itself"
    assert math.isnan(answer.predictions[1].recall)
    trust.reset()
    assert trust.predict().frames == 0 and trust.settled_frames == 0


def test_what_it_gave_outlives_it():
    trust = Trust(tables_of("six"))
    intercepts = trust.intercepts
    del trust
    gc.collect()
    assert intercepts == near(GOLDEN["six_c"]) and not intercepts.flags.writeable


def test_bad_input_is_refused():
    tables = tables_of("centred")
    trust = Trust(tables)
    for wrong in ({}, {"tables": tables, "runs": 4}):
        with pytest.raises(ValueError, match="give either tables or runs"):
            Trust(**{"tables": None, **wrong})
    with pytest.raises(ValueError, match=r"cells has the shape \[4, 4, 4, 7\]"):
        Trust(tables._replace(frames=tables.frames[:3], own_scale=tables.own_scale[:3],
                              correlation=tables.correlation[:3]))  # fmt: skip
    with pytest.raises(VdnaError) as caught:
        Trust(tables._replace(own_scale=0 * tables.own_scale))
    assert caught.value.status is Status.NONFINITE
    with pytest.raises(ValueError, match=r"nearest has the shape \[2\], expected \[4\]"):
        trust.feed([0.1, 0.2])
    with pytest.raises(VdnaError):
        trust.feed([0.1, 0.2, 0.3, 3])
    with pytest.raises(VdnaError):
        Trust(tables, min_recall=2)
    with pytest.raises(VdnaError):
        trust.reconsider([0, 0, 0, 0])
    with pytest.raises(ValueError, match="last_layer has the shape"):
        StoredRun([[1, 2]], last_layer=[1, 2])
    with pytest.raises(ValueError, match="distances has the shape"):
        trust_tables(list(runs_of()), 2, distances=np.ones((3, 3)))


def test_what_a_map_knows_about_itself_is_written_and_read_back(tmp_path):
    for name in "ab":
        small_experience(name).write(tmp_path / f"{name}.vdna")
    experiences = libvdna.open_map(tmp_path)
    with pytest.raises(VdnaError, match="vdna calibrate --trust") as caught:
        libvdna.MapTrust.open(tmp_path, experiences)
    assert caught.value.status is Status.EMPTY
    runs = [StoredRun(e.embeddings, places=e.frame_place) for e in experiences]
    tables = trust_tables(runs, 0, centred=False)
    libvdna.MapTrust(tables, 0.5, False).write(tmp_path, experiences)

    read = libvdna.MapTrust.open(tmp_path, experiences)
    assert (read.tolerance, read.centred) == (0.5, False)
    for one, other in zip(read.tables, tables):
        np.testing.assert_array_equal(one, other)
    swapped = libvdna.MapTrust.open(tmp_path, experiences[::-1])
    np.testing.assert_array_equal(swapped.tables.cells[0, 1], tables.cells[1, 0])

    with pytest.raises(VdnaError, match="not from a file"):
        libvdna.MapTrust(tables, 0.5, False).write(tmp_path, [small_experience("a")] * 2)
    with pytest.raises(ValueError, match="frames"):
        libvdna.MapTrust(tables, 0.5, False).write(tmp_path, experiences[:1])
    with pytest.raises(VdnaError):
        libvdna.MapTrust.open(tmp_path, [])


def test_the_recall_of_a_pair_is_the_mean_of_its_cell(random):
    embeddings = random.normal(0, 1, (2, 30, 4)).astype(np.float32)
    runs = [StoredRun(one, places=np.arange(30)) for one in embeddings]
    cells = trust_tables(runs, 3).cells
    recall = TRUST_CELL.index("recall")
    assert trust_recall(runs[0], runs[1], 3) == pytest.approx(np.nanmean(cells[0, 1, recall]))
    assert trust_recall(runs[0], runs[0], 3) == 1
    assert math.isnan(trust_recall(StoredRun(embeddings[0]), runs[1], 3))
