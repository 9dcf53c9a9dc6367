"""VDNAs of the reference package. tests/reference/ was made by it; see make_reference.py."""

import dataclasses
import json
import pathlib
import shutil

import numpy as np
import pytest
from conftest import small_experience

from libvdna import FeatureMap, Histogram, HistogramView, ReferenceVdna, emd, emd_mean

GOLDEN = pathlib.Path(__file__).parent / "reference"
EXPECTED = json.loads((GOLDEN / "expected.json").read_text())
SUMMER = GOLDEN / "summer-histogram-20"
WINTER = GOLDEN / "winter-histogram-20"


def range_of(neurons):
    return np.array([EXPECTED["range"]] * neurons, np.float32)


def arrays_of(path):
    with np.load(path) as archive:
        return {name: archive[name] for name in archive.files}


@pytest.fixture
def copy(tmp_path):
    """A VDNA of the package, to be damaged."""
    for ending in (".json", ".npz"):
        shutil.copy(SUMMER.with_suffix(ending), tmp_path)
    return tmp_path / SUMMER.name


def change(path, **metadata):
    path = path.with_suffix(".json")
    path.write_text(json.dumps({**json.loads(path.read_text()), **metadata}))


def test_a_vdna_of_the_package_is_read():
    vdna = ReferenceVdna.load(SUMMER)
    assert vdna.layers == {"stem": 3, "block/0": 5} and list(vdna.layers) == ["stem", "block/0"]
    assert (vdna.num_images, vdna.feature_extractor_name) == (6, "table")
    assert (vdna.histogram.neurons, vdna.histogram.bins) == (8, 20)
    arrays = arrays_of(SUMMER.with_suffix(".npz"))
    np.testing.assert_array_equal(vdna.histogram.counts[:, :3].T, arrays["stem"])
    np.testing.assert_array_equal(vdna.histogram.counts[:, 3:].T, arrays["block/0"])
    np.testing.assert_array_equal(vdna.histogram.mass, [24] * 3 + [6] * 5)
    np.testing.assert_array_equal(vdna.histogram.range, [[-1, 1]] * 8)
    for ending in (".json", ".npz"):
        again = ReferenceVdna.load(str(SUMMER) + ending)
        np.testing.assert_array_equal(again.histogram.counts, vdna.histogram.counts)


@pytest.mark.parametrize("path", [SUMMER, WINTER])
def test_our_histogram_of_the_same_activations_is_the_same(path):
    ours = Histogram(range_of(8), 20)
    layers = EXPECTED["activations"][path.name.split("-")[0]]
    for stem, block in zip(layers["stem"], layers["block/0"]):
        ours.add(FeatureMap(stem), FeatureMap(block))
    theirs = ReferenceVdna.load(path, range=range_of(8)).histogram
    np.testing.assert_array_equal(ours.counts, theirs.counts)
    assert emd_mean(ours, theirs) == 0


def test_distances_are_those_of_the_package():
    summer, winter = ReferenceVdna.load(SUMMER).histogram, ReferenceVdna.load(WINTER).histogram
    expected = sum(EXPECTED["emd_bins"].values(), [])
    np.testing.assert_allclose(emd(summer, winter), expected, rtol=1e-12)
    np.testing.assert_allclose(emd_mean(summer, winter), EXPECTED["emd_mean_bins"], rtol=1e-12)


def test_what_was_read_is_written_as_the_package_wrote_it(tmp_path):
    ReferenceVdna.load(SUMMER).save(tmp_path / "summer")
    assert (tmp_path / "summer.json").read_text() == SUMMER.with_suffix(".json").read_text()
    ours = arrays_of(tmp_path / "summer.npz")
    theirs = arrays_of(SUMMER.with_suffix(".npz"))
    assert list(ours) == list(theirs)
    for layer, counts in theirs.items():
        np.testing.assert_array_equal(ours[layer], counts)
        assert ours[layer].dtype == counts.dtype


def test_an_experience_goes_there_and_back_without_loss(tmp_path):
    experience = small_experience()
    vdna = ReferenceVdna.from_experience(experience)
    assert vdna.layers == {"mid": 2, "top": 1} and vdna.num_images == 2
    vdna.save(tmp_path / "winter")
    again = ReferenceVdna.load(tmp_path / "winter")
    assert (again.layers, again.num_images) == (vdna.layers, vdna.num_images)
    assert again.feature_extractor_name == "tiny-net_1.0"
    assert emd_mean(again.histogram, experience.histogram) == 0
    for name in ("range", "counts", "mass"):
        np.testing.assert_array_equal(
            getattr(again.histogram, name), getattr(experience.histogram, name)
        )


def test_an_odd_range_survives_to_the_last_bit(tmp_path, random):
    range = np.sort(random.normal(size=(3, 2)).astype(np.float32), axis=1)
    histogram = HistogramView(range, np.ones((2, 3), int))
    ReferenceVdna({"a": 3}, histogram, 2, "x").save(tmp_path / "odd")
    assert ReferenceVdna.load(tmp_path / "odd").histogram.range.tobytes() == range.tobytes()


def test_a_new_histogram_may_take_the_place_of_one_that_was_read(tmp_path):
    histogram = HistogramView([[-1, 1]] * 8, np.ones((30, 8), int))
    vdna = dataclasses.replace(ReferenceVdna.load(SUMMER), histogram=histogram)
    vdna.save(tmp_path / "new")
    assert json.loads((tmp_path / "new.json").read_text())["name"] == "histogram-30"
    assert ReferenceVdna.load(tmp_path / "new").histogram.bins == 30


def test_gaussians_are_refused():
    with pytest.raises(ValueError, match="its type is 'gaussian', only a 'histogram' has counts"):
        ReferenceVdna.load(GOLDEN / "summer-gaussian")


@pytest.mark.parametrize(
    "metadata, reason",
    [
        ({"neurons_list": {"stem": 3}}, r"expected \['stem'\]"),
        ({"neurons_list": {"stem": 4, "block/0": 5}}, r"stem has the shape \[3, 20\]"),
        ({"neurons_list": [3, 5]}, "layers"),
        ({"distribution": {"hist_nb_bins": 21}}, r"expected \[3\]\[21\]"),
        ({"distribution": {}}, "there is no 'hist_nb_bins'"),
        ({"extraction_settings": {}}, "there is no 'hist_range'"),
        ({"num_images": "six"}, "num_images is 'six'"),
        ({"libvdna_range": [[1, 0]] * 8}, "vdna_range_check"),
        ({"libvdna_range": [[0, 1]]}, r"expected \[bins\]\[1\]"),
    ],
)
def test_metadata_that_does_not_fit_is_refused(copy, metadata, reason):
    change(copy, **metadata)
    with pytest.raises(ValueError, match=reason):
        ReferenceVdna.load(copy)


def test_files_that_are_damaged_are_refused(copy):
    npz = copy.with_suffix(".npz")
    content = npz.read_bytes()
    for damaged in (b"", b"text", content[:200], content[:100] + b"x" * 50 + content[150:]):
        npz.write_bytes(damaged)
        with pytest.raises(ValueError, match="summer-histogram-20.json: not a VDNA"):
            ReferenceVdna.load(copy)
    np.savez(npz, **{"stem": np.full((3, 20), -1), "block/0": np.ones((5, 20), int)})
    with pytest.raises(ValueError, match="smallest number of counts is -1"):
        ReferenceVdna.load(copy)
    copy.with_suffix(".json").write_text("[1")
    with pytest.raises(ValueError, match="not a VDNA"):
        ReferenceVdna.load(copy)
    npz.unlink()
    with pytest.raises(OSError):
        ReferenceVdna.load(copy.with_name("nowhere"))


def test_what_the_package_cannot_hold_is_not_written(tmp_path):
    histogram = HistogramView([[0, 1]], [[2**31], [0]])
    with pytest.raises(ValueError, match="int32"):
        ReferenceVdna({"a": 1}, histogram, 1, "x").save(tmp_path / "large")
    histogram = HistogramView([[0, 1]] * 2, [[1, 1], [0, 0]])
    with pytest.raises(ValueError, match="the layers have 1 neurons, the histogram 2"):
        ReferenceVdna({"a": 1}, histogram, 1, "x").save(tmp_path / "one")
    assert list(tmp_path.iterdir()) == []


def test_the_package_reads_what_we_write(tmp_path):
    package = pytest.importorskip("vdna", reason="the reference package is not installed")
    read = package.load_vdna_from_files
    ReferenceVdna.load(SUMMER).save(tmp_path / "summer")
    ReferenceVdna.load(WINTER, range=range_of(8)).save(tmp_path / "winter")
    distance = package.EMD(read(tmp_path / "summer"), read(tmp_path / "winter"))
    assert float(distance) == EXPECTED["emd_mean_bins"]
    assert float(package.EMD(read(tmp_path / "summer"), read(SUMMER))) == 0

    ReferenceVdna.from_experience(small_experience()).save(tmp_path / "ours")
    ours = read(tmp_path / "ours")
    assert ours.neurons_list == {"mid": 2, "top": 1} and ours.num_images == 2
    np.testing.assert_array_equal(
        ours.get_all_neurons_dists().numpy().T, small_experience().histogram.counts
    )
