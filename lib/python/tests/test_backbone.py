"""Networks: the same numbers as `vdna`, for arrays and JPEG files; errors say what is missing."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import libvdna
from libvdna import _library

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "test" / "support"))
from tiny_network import SHA256, write_tiny_network  # noqa: E402

# 2x2 pixels of red, green, blue; the network takes them as they are.
PICTURE = np.array([[[10, 20, 30], [11, 21, 31]], [[12, 22, 32], [13, 23, 33]]], np.uint8)

PACKAGE = pathlib.Path(libvdna.__file__).parent
HAS_BACKBONE = (PACKAGE / "libvdna_backbone.so").exists()
needs_backbone = pytest.mark.skipif(
    not HAS_BACKBONE, reason="this wheel was built without networks"
)


@pytest.fixture
def manifest(tmp_path):
    return write_tiny_network(
        tmp_path, ("map", "neurons_samples"), ("tokens", "samples_neurons")
    )


@pytest.fixture
def tiny(manifest):
    """The network of test/support/make_tiny_network.py, where there is an ONNX Runtime."""
    try:
        backbone = libvdna.Backbone(manifest)
    except libvdna.VdnaError as error:
        if "ONNX Runtime cannot be loaded" in str(error):
            pytest.skip(str(error))
        raise
    with backbone:
        yield backbone


@needs_backbone
def test_taps_are_samples_of_neurons_whatever_their_layout_in_the_network(tiny):
    frame = tiny.run(PICTURE)
    assert [tap.name for tap in frame.taps] == ["map", "tokens"]
    for tap in frame.taps:
        assert tap.values.dtype == np.float32
        np.testing.assert_array_equal(tap.values, PICTURE.reshape(4, 3))
        assert tap.values.flags.c_contiguous
    np.testing.assert_array_equal(frame.embedding, [11.5, 21.5, 31.5])
    assert frame.last_layer is None
    assert frame.grey == pytest.approx(0.299 * 11.5 + 0.587 * 21.5 + 0.114 * 31.5, abs=1e-3)


@needs_backbone
def test_a_grey_picture_and_one_with_padded_rows_are_arrays_too(tiny):
    grey = np.array([[1, 2], [3, 4]], np.uint8)
    np.testing.assert_array_equal(tiny.run(grey).embedding, [2.5, 2.5, 2.5])
    wide = np.zeros((2, 5, 3), np.uint8)
    wide[:, 1:3] = PICTURE
    np.testing.assert_array_equal(tiny.run(wide[:, 1:3]).embedding, [11.5, 21.5, 31.5])


@needs_backbone
def test_a_grid_is_the_embedding_and_the_last_layer_comes_beside_it(manifest):
    text = manifest.read_text()
    assert text.count('output = "mean"') == 1
    grid = 'output = "map"\ngrid = [1, 2]\ncentre = true\nlast_layer = "mean"'
    manifest.write_text(text.replace('output = "mean"', grid))
    try:
        backbone = libvdna.Backbone(manifest)
    except libvdna.VdnaError as error:
        if "ONNX Runtime cannot be loaded" in str(error):
            pytest.skip(str(error))
        raise
    with backbone:
        assert backbone.info.identity.embedding == "map grid=1x2 last=mean centred"
        frame = backbone.run(PICTURE)
    np.testing.assert_array_equal(frame.embedding, [11, 12, 21, 22, 31, 32])
    np.testing.assert_array_equal(frame.last_layer, [11.5, 21.5, 31.5])


@needs_backbone
def test_a_frame_outlives_the_next_one_and_the_network(tiny):
    first = tiny.run(PICTURE)
    tiny.run(np.zeros_like(PICTURE))
    tiny.close()
    np.testing.assert_array_equal(first.taps[0].values, PICTURE.reshape(4, 3))
    np.testing.assert_array_equal(first.embedding, [11.5, 21.5, 31.5])


@needs_backbone
def test_the_network_describes_itself(tiny):
    identity = tiny.info.identity
    assert (identity.backbone, identity.precision) == ("tiny", "fp32")
    assert (identity.taps, identity.neurons, identity.dim) == ("map:3:4,tokens:3:4", 6, 3)
    assert identity.preprocessing == "2x2 RGB mean=0,0,0 std=1,1,1 resize=stretch/area l2=0"
    assert identity.model_sha256 == SHA256
    assert (identity.bins, identity.range) == (None, None)
    assert tiny.info.input_size == (2, 2)
    assert tiny.info.runtime.startswith("onnxruntime 1.")


@needs_backbone
def test_a_closed_or_cancelled_network_says_so(tiny):
    tiny.cancel()
    with pytest.raises(libvdna.VdnaError, match="cancelled") as caught:
        tiny.run(PICTURE)
    assert caught.value.status is libvdna.Status.RUNTIME
    tiny.close()
    tiny.close()
    tiny.cancel()
    with pytest.raises(ValueError, match="is closed"):
        tiny.run(PICTURE)


@needs_backbone
@pytest.mark.parametrize(
    "picture, error",
    [
        (PICTURE.astype(np.float32), TypeError),
        (np.zeros((2, 2, 4), np.uint8), ValueError),
        (np.zeros(12, np.uint8), ValueError),
        (np.zeros((0, 2), np.uint8), ValueError),
        (np.zeros((1, 16385), np.uint8), ValueError),
        (b"no picture", libvdna.VdnaError),
        (b"", libvdna.VdnaError),
        (b"\xff\xd8\xff\xe0", libvdna.VdnaError),
    ],
)
def test_what_is_no_picture_is_refused_and_leaves_the_network_as_it_was(tiny, picture, error):
    with pytest.raises(error):
        tiny.run(picture)
    np.testing.assert_array_equal(tiny.run(PICTURE).embedding, [11.5, 21.5, 31.5])


@needs_backbone
def test_pictures_larger_than_the_limit_are_refused(manifest, tiny):
    with libvdna.Backbone(manifest, max_pixels=3, threads=1) as small:
        with pytest.raises(libvdna.VdnaError) as caught:
            small.run(PICTURE)
    assert caught.value.status is libvdna.Status.UNSUPPORTED


@needs_backbone
def test_arguments_are_checked(manifest):
    with pytest.raises(ValueError, match="threads"):
        libvdna.Backbone(manifest, threads=0)
    with pytest.raises(ValueError, match="max_pixels"):
        libvdna.Backbone(manifest, max_pixels=2**27)
    with pytest.raises(ValueError, match="NUL"):
        libvdna.Backbone("a\0b")


@needs_backbone
def test_a_network_that_is_missing_is_named_with_where_it_was_looked_for(monkeypatch, tmp_path):
    monkeypatch.setenv("VDNA_MODELS", str(tmp_path))
    with pytest.raises(libvdna.VdnaError) as caught:
        libvdna.Backbone("no_such_network")
    assert caught.value.status is libvdna.Status.IO
    assert f"no backbone is called 'no_such_network'; looked in {tmp_path}" in str(caught.value)


@needs_backbone
def test_a_runtime_that_is_missing_says_how_to_get_one(manifest):
    with pytest.raises(libvdna.VdnaError, match="pip install onnxruntime") as caught:
        libvdna.Backbone(manifest, runtime="/nowhere/libonnxruntime.so")
    assert caught.value.status is libvdna.Status.RUNTIME
    assert "/nowhere/libonnxruntime.so" in str(caught.value)


@needs_backbone
def test_the_runtime_within_the_package_onnxruntime_is_found(manifest, monkeypatch, tmp_path):
    capi = tmp_path / "site" / "onnxruntime" / "capi"
    capi.mkdir(parents=True)
    (capi.parent / "__init__.py").write_text("raise AssertionError('it is not imported')")
    (capi / "libonnxruntime.so.1.99.0").write_text("no library")
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    monkeypatch.delenv("VDNA_ONNXRUNTIME", raising=False)
    with pytest.raises(libvdna.VdnaError, match=r"capi/libonnxruntime\.so\.1\.99\.0"):
        libvdna.Backbone(manifest)


@needs_backbone
def upside_down(jpeg):
    """The JPEG with EXIF that says so."""
    block = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0"
    segment = b"Exif\0\0" + block
    return jpeg[:2] + b"\xff\xe1" + (len(segment) + 2).to_bytes(2, "big") + segment + jpeg[2:]


def test_pictures_give_what_vdna_makes_of_them(manifest, tiny, tmp_path):
    program = os.environ.get("VDNA")
    if program is None:
        pytest.skip("VDNA, the program vdna, is not set")

    def vdna(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)

    drive = tmp_path / "summer"
    vdna("simulate", drive, "--frames", 4, "--size", "64x48")
    vdna("build", tmp_path / "map", drive, "--backbone", manifest)
    experience = libvdna.Experience.open(tmp_path / "map" / "summer.vdna")
    tiny.info.identity.check_comparable(experience.identity)

    histogram = libvdna.Histogram(experience.histogram.range)
    jpegs = sorted(drive.glob("*.jpg"))
    assert len(jpegs) == 4
    for jpeg, embedding, grey in zip(jpegs, experience.embeddings, experience.frame_grey):
        frame = tiny.run(jpeg.read_bytes())
        np.testing.assert_array_equal(frame.embedding, embedding)
        assert frame.grey == grey
        histogram.add(*(tap.values for tap in frame.taps))
    np.testing.assert_array_equal(histogram.counts, experience.histogram.counts)
    turned = tiny.run(upside_down(jpegs[-1].read_bytes()))
    np.testing.assert_array_equal(turned.taps[0].values, frame.taps[0].values[::-1])


@needs_backbone
def test_a_picture_with_a_mask_or_of_another_depth_is_refused(tiny):
    masked = np.ma.masked_array(np.zeros((4, 4), np.uint8), mask=np.eye(4))
    with pytest.raises(TypeError, match="masked array.*filled"):
        tiny.run(masked)
    with pytest.raises(TypeError, match="uint16, expected uint8; scale it"):
        tiny.run(np.zeros((4, 4), np.uint16))


@needs_backbone
def test_a_plugin_is_a_network():
    plugin = os.environ.get("VDNA_GREY_LEVELS")
    if plugin is None:
        pytest.skip("VDNA_GREY_LEVELS, the plug-in grey_levels.so, is not set")
    picture = np.array([[0, 255]], np.uint8)
    with libvdna.Backbone(plugin) as backbone:
        frame = backbone.run(picture)
        assert backbone.info.input_size is None
    assert [(tap.name, tap.values.shape) for tap in frame.taps] == [("levels", (1, 16))]
    assert (frame.embedding[0], frame.embedding[-1]) == (0.5, 0.5)
    with pytest.raises(libvdna.VdnaError, match="a path with a '/'"):
        libvdna.Backbone("grey_levels.so")


@pytest.fixture
def other_package(monkeypatch, tmp_path):
    """The folder of a package whose libraries are not loaded yet."""
    monkeypatch.setattr(_library, "_path_of", lambda name: str(tmp_path / name))
    _library.backbone_lib.cache_clear()
    yield tmp_path
    _library.backbone_lib.cache_clear()


def test_a_wheel_without_networks_says_so(other_package):
    with pytest.raises(libvdna.VdnaError, match="this wheel was built without") as caught:
        libvdna.Backbone("efficientnet_lite0")
    assert caught.value.status is libvdna.Status.UNSUPPORTED


def test_a_library_that_cannot_be_loaded_says_why(other_package):
    (other_package / "libvdna_backbone.so").write_text("no library")
    with pytest.raises(libvdna.VdnaError, match="libvdna_backbone.so: cannot be loaded: ") as caught:
        libvdna.Backbone("efficientnet_lite0")
    assert caught.value.status is libvdna.Status.UNSUPPORTED
