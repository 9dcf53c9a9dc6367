"""What makes two Visual DNAs comparable."""

import gc

import numpy as np
import pytest
from conftest import SHA256, small_experience

from libvdna import Experience, Identity, Status, TapShape, VdnaError
from libvdna import clean_name, format_taps, parse_taps

FIELDS = {
    "backbone": "tiny-net_1.0",
    "model_sha256": SHA256,
    "preprocessing": 'rgb 8x8 "area" mean=0 std=1 \\',
    "taps": "mid:2:4,top:1:1",
}
RANGE = np.array([[-1, 1], [0, 6], [-2.5, 2.5]], np.float32)
COMPARABLE = "33eb312321a71d537313127f48a50950d6620be9c61d9d81abd40b07496209eb"


def test_its_text_and_hash_are_those_of_the_specification():
    identity = Identity(**FIELDS, dim=5, bins=4, range=RANGE)
    assert identity.text.splitlines() == [
        "vdna-comparable 1",
        SHA256,
        FIELDS["preprocessing"],
        FIELDS["taps"],
        "5",
        "4",
    ]
    assert identity.comparable == COMPARABLE
    assert (identity.neurons, identity.dim, identity.bins) == (3, 5, 4)
    assert (identity.backbone, identity.precision) == ("tiny-net_1.0", "fp32")
    np.testing.assert_array_equal(identity.range, RANGE)


def test_what_is_not_known_yet_is_none_and_not_compared():
    network = Identity(**FIELDS, dim=5)
    assert (network.dim, network.bins, network.range, network.comparable) == (5, None, None, None)
    network.check_comparable(small_experience().identity)
    other = Identity(**{**FIELDS, "backbone": "renamed"})
    assert other.dim is None
    network.check_comparable(other)


def test_a_network_compares_with_what_is_kept_of_its_embeddings():
    projection = np.eye(5, 7, dtype=np.float32)
    kept = Identity(**FIELDS, dim=5, bins=4, range=RANGE, projection=projection)
    assert kept.projection.ctypes.data == projection.ctypes.data  # not copied
    Identity(**FIELDS, dim=7).check_comparable(kept)
    with pytest.raises(VdnaError, match="^dim is 5 in one and 7 in the other$"):
        Identity(**FIELDS, dim=5).check_comparable(kept)
    with pytest.raises(ValueError, match="projection has the shape"):
        Identity(**FIELDS, dim=4, projection=projection)
    with pytest.raises(VdnaError, match="makes 0 of 7 numbers"):
        Identity(**FIELDS, projection=projection)


def test_a_comparison_names_the_field_and_both_values():
    int8 = Identity(**{**FIELDS, "model_sha256": SHA256[::-1]}, precision="int8")
    with pytest.raises(VdnaError, match="^precision is fp32 in one and int8 in the other$") as found:
        Identity(**FIELDS).check_comparable(int8)
    assert found.value.status is Status.MISMATCH
    with pytest.raises(VdnaError, match="^dim is 5 in one and 6 in the other$"):
        Identity(**FIELDS, dim=5).check_comparable(Identity(**FIELDS, dim=6))
    with pytest.raises(TypeError):
        int8.check_comparable(small_experience())


def test_a_field_that_breaks_its_rule_is_refused():
    for change, reason in (
        ({"backbone": "tiny/net"}, "backbone has a character"),
        ({"model_sha256": "none"}, "model_sha256 is not 64"),
        ({"taps": "mid:2"}, "expected NAME:NEURONS:SAMPLES"),
        ({"taps": ""}, "taps is empty"),
        ({"bins": 1}, "bins is 1, expected 2 to 65536"),
        ({"range": RANGE[:, ::-1]}, "the range of neuron 0"),
    ):
        with pytest.raises(VdnaError, match=reason):
            Identity(**{**FIELDS, **change})
    for change in ({"taps": "t" * 2048}, {"dim": 0}, {"range": RANGE[:2]}):
        with pytest.raises(ValueError):
            Identity(**{**FIELDS, **change})


def test_the_identity_of_a_file_keeps_it_open(tmp_path):
    small_experience().write(tmp_path / "winter.vdna")
    identity = Experience.open(tmp_path / "winter.vdna").identity
    gc.collect()
    assert identity.comparable == COMPARABLE
    range = identity.range
    del identity
    gc.collect()
    np.testing.assert_array_equal(range, RANGE)


def test_taps_are_read_and_written():
    taps = [TapShape("mid", 2, 4), TapShape("block:11:out", 768, 197)]
    assert format_taps(taps) == "mid:2:4,block:11:out:768:197"
    assert parse_taps(format_taps(taps)) == taps
    assert parse_taps("") == [] and format_taps([]) == ""
    for bad in ("mid", "mid:2:4,", "mid:0:4", "mid:2:4 "):
        with pytest.raises(VdnaError) as caught:
            parse_taps(bad)
        assert caught.value.status is Status.FORMAT
    with pytest.raises(VdnaError):
        format_taps([TapShape("a,b", 1, 1)])
    with pytest.raises(ValueError):
        format_taps([TapShape("a", 0, 1)])


def test_a_name_is_cleaned_of_what_it_may_not_have():
    assert clean_name("été 2026/north.mp4") == "__t___2026_north.mp4"  # each byte
    assert clean_name("winter_1.0-b") == "winter_1.0-b"
