"""Experience files and maps."""

import gc
import pickle

import numpy as np
import pytest
from conftest import SHA256, small_experience

import libvdna
from libvdna import PLACE_NONE, Experience, Status, VdnaError, emd_mean, open_map

ARRAYS = ["embeddings", "frame_utime", "frame_grey", "frame_place", "frame_position"]
TEXTS = ["name", "backbone", "model_sha256", "preprocessing", "precision", "taps"]


def is_mapped(path):
    with open("/proc/self/maps") as maps:
        return str(path) in maps.read()


def test_what_is_written_is_read_again(tmp_path):
    written = small_experience()
    assert written.comparable is None
    written.write(tmp_path / "winter.vdna")
    read = Experience.open(tmp_path / "winter.vdna")
    for name in TEXTS:
        assert getattr(read, name) == getattr(written, name), name
    for name in ARRAYS:
        expected = getattr(written, name)
        np.testing.assert_array_equal(getattr(read, name), expected, name)
        assert getattr(read, name).dtype == expected.dtype, name
    for name in ("range", "counts", "mass"):
        np.testing.assert_array_equal(
            getattr(read.histogram, name), getattr(written.histogram, name), name
        )
    assert (read.frames, read.dim) == (2, 5)
    # As docs/reference/SPEC-map.md has it for this very experience.
    assert read.comparable == "33eb312321a71d537313127f48a50950d6620be9c61d9d81abd40b07496209eb"
    assert emd_mean(read.histogram, written.histogram) == 0


def test_a_second_embedding_comes_back_within_half_a_step(tmp_path):
    last_layer = np.array([[1, -127, 0.4], [0, 0, 0]], np.float32)
    small_experience(embedding="mid grid=1x5 last=top centred", last_layer=last_layer).write(
        tmp_path / "winter.vdna"
    )
    read = Experience.open(tmp_path / "winter.vdna")
    assert read.identity.embedding == "mid grid=1x5 last=top centred"
    assert read.identity.is_centred
    np.testing.assert_array_equal(read.last_layer, [[1, -127, 0], [0, 0, 0]])
    assert read.last_layer.dtype == np.float32
    with pytest.raises(VdnaError, match="one whole output in one"):
        small_experience().check_comparable(read)
    plain = small_experience()
    assert (plain.identity.embedding, plain.identity.is_centred, plain.last_layer) == ("", False, None)


def test_thumbnails_and_a_source_come_back(tmp_path):
    pictured = small_experience(source="winter.mp4", thumbnails=[None, b"three"])
    pictured.write(tmp_path / "winter.vdna")
    for experience in (pictured, Experience.open(tmp_path / "winter.vdna")):
        assert experience.source == "winter.mp4"
        assert [experience.thumbnail(i) for i in range(2)] == [None, b"three"]
        with pytest.raises(IndexError, match="frame 2, expected 0 to 1"):
            experience.thumbnail(2)
        pictured.check_comparable(experience)
    plain = small_experience(thumbnails=[b"", None])
    assert (plain.source, plain.thumbnail(0)) == ("", None)
    with pytest.raises(ValueError, match="1 thumbnails, expected 2"):
        small_experience(thumbnails=[b"one"])
    with pytest.raises(VdnaError, match="at most 4096 more"):
        small_experience(thumbnails=[b"one", bytes(4097)]).write(tmp_path / "large.vdna")


def test_a_projection_comes_back_and_projects_live_frames(tmp_path):
    projection = np.eye(5, 7, 1, np.float32)
    small_experience(projection=projection).write(tmp_path / "winter.vdna")
    read = Experience.open(tmp_path / "winter.vdna")
    np.testing.assert_array_equal(read.identity.projection, projection)
    assert read.identity.text.splitlines()[0] == "vdna-comparable 3"
    np.testing.assert_array_equal(read.identity.project(range(7)), [1, 2, 3, 4, 5])
    with pytest.raises(ValueError, match=r"embedding has the shape \[5\], expected \[7\]"):
        read.identity.project(range(5))
    with pytest.raises(VdnaError, match="projection is none in one and of 7 numbers to 5"):
        small_experience(embeddings=np.zeros((2, 7))).check_comparable(read)

    plain = small_experience()
    assert plain.identity.projection is None
    np.testing.assert_array_equal(plain.identity.project(range(5)), range(5))
    with pytest.raises(ValueError, match="projection has the shape"):
        small_experience(projection=np.eye(4, 7))


def test_labels_may_be_left_out(tmp_path):
    small_experience(frame_place=None, frame_position=None).write(tmp_path / "winter.vdna")
    read = Experience.open(tmp_path / "winter.vdna")
    assert read.frame_place is None and read.frame_position is None
    assert (read.position_frame, read.order) == ("", "")


@pytest.mark.parametrize(
    "position, said, frame",
    [
        ([[0, 0, 0], [1, 2, 3]], "", "local"),
        ([[6378137, 0, 0], [np.nan] * 3], "", "wgs84"),
        ([[0, 0, 0], [1, 2, 3]], "hall-3", "hall-3"),
    ],
)
def test_positions_have_a_frame_and_may_be_missing(position, said, frame, tmp_path):
    place = np.array([PLACE_NONE, 18])
    small_experience(
        frame_place=place, frame_position=np.array(position), position_frame=said, order="utime"
    ).write(tmp_path / "winter.vdna")
    read = Experience.open(tmp_path / "winter.vdna")
    assert (read.position_frame, read.order) == (frame, "utime")
    np.testing.assert_array_equal(read.frame_place, place)
    np.testing.assert_array_equal(read.frame_position, np.array(position))


def test_arrays_are_the_file_itself_and_keep_it_mapped(tmp_path):
    path = tmp_path / "winter.vdna"
    small_experience().write(path)
    experience = Experience.open(path)
    begin = experience._file.file_bytes
    end = begin + experience._file.file_size
    for name in ARRAYS:
        assert begin <= getattr(experience, name).ctypes.data < end, name
        with pytest.raises(ValueError):
            getattr(experience, name)[0] = 0
    histogram, place = experience.histogram, experience.frame_place[1:]
    assert begin <= histogram.counts.ctypes.data < end

    del experience
    gc.collect()
    assert is_mapped(path) and histogram.mass.tolist() == [8, 8, 2]
    del histogram
    gc.collect()
    assert is_mapped(path) and place.tolist() == [18]
    del place
    gc.collect()
    assert not is_mapped(path)


def test_an_experience_to_write_keeps_its_arrays_alive(tmp_path):
    experience = small_experience(embeddings=np.full((2, 200_000), 3, np.float32))
    gc.collect()
    others = [np.zeros((2, 200_000), np.float32) for _ in range(4)]
    experience.write(tmp_path / "winter.vdna")
    assert (Experience.open(tmp_path / "winter.vdna").embeddings == 3).all() and others


def test_a_damaged_file_is_refused(tmp_path):
    path = tmp_path / "winter.vdna"
    small_experience().write(path)
    content = bytearray(path.read_bytes())
    content[-10] ^= 1
    path.write_bytes(content)
    with pytest.raises(VdnaError, match="CRC") as caught:
        Experience.open(path)
    assert caught.value.status is Status.CHECKSUM
    path.write_bytes(b"")
    with pytest.raises(VdnaError) as caught:
        Experience.open(path)
    assert caught.value.status is Status.FORMAT
    assert not is_mapped(path)


@pytest.mark.parametrize(
    "changes, status",
    [
        ({"name": "a name"}, Status.ARG),
        ({"model_sha256": "12"}, Status.ARG),
        ({"preprocessing": "\u010d"}, Status.ARG),
        ({"taps": "mid:2:4"}, Status.MISMATCH),
        ({"frame_grey": [0, 256]}, Status.ARG),
        ({"embeddings": [[np.nan], [0]]}, Status.NONFINITE),
        ({"embeddings": np.empty((2, 0))}, Status.ARG),
        ({"embedding": "mid\tgrid=1x5"}, Status.ARG),
    ],
)
def test_what_breaks_the_rules_is_not_written(changes, status, tmp_path):
    with pytest.raises(VdnaError, match="not written") as caught:
        small_experience(**changes).write(tmp_path / "winter.vdna")
    assert caught.value.status is status
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "changes",
    [
        {"name": "n" * 64},
        {"name": "nul\0"},
        {"taps": "t" * 2048},
        {"embeddings": [1, 2]},
        {"frame_utime": [1]},
        {"frame_grey": [1, 2, 3]},
        {"frame_place": [1]},
        {"frame_position": [[1, 2], [3, 4]]},
        {"position_frame": "f" * 64},
        {"order": "o" * 32},
    ],
)
def test_lengths_that_c_would_trust_are_checked(changes):
    with pytest.raises(ValueError):
        small_experience(**changes)


def test_wrong_types_are_refused(tmp_path):
    for changes in (
        {"frame_utime": [1.5, 2.5]},
        {"histogram": None},
        {"embeddings": "text"},
        {"name": 1},
    ):
        with pytest.raises(TypeError):
            small_experience(**changes)
    with pytest.raises(TypeError):
        small_experience().check_comparable("text")
    with pytest.raises(TypeError):
        Experience.open(1)
    with pytest.raises(ValueError):
        Experience.open("nul\0")
    with pytest.raises(VdnaError):
        small_experience().write(tmp_path / "no" / "winter.vdna")


def test_what_does_not_compare_is_named():
    small_experience().check_comparable(small_experience("summer"))
    other = small_experience("summer", model_sha256=SHA256[::-1])
    with pytest.raises(VdnaError, match="model_sha256") as caught:
        small_experience().check_comparable(other)
    assert caught.value.status is Status.MISMATCH


def test_a_precision_does_not_compare_with_another():
    quantised = small_experience("summer", precision="int8", model_sha256=SHA256[::-1])
    with pytest.raises(VdnaError, match="int8") as caught:
        small_experience().check_comparable(quantised)
    assert caught.value.status is Status.MISMATCH


def test_a_map_is_a_directory_of_experiences(tmp_path):
    for name in ("winter", "autumn", "summer"):
        small_experience(name).write(tmp_path / f"{name}.vdna")
    (tmp_path / "notes.txt").write_text("not an experience")
    experiences = open_map(tmp_path)
    assert [e.name for e in experiences] == ["autumn", "summer", "winter"]
    embeddings = experiences[1].embeddings
    del experiences
    gc.collect()
    assert embeddings[0, 0] == 1
    mapped = [is_mapped(tmp_path / f"{name}.vdna") for name in ("autumn", "summer", "winter")]
    assert mapped == [False, True, False]


def test_a_map_that_is_none_is_refused(tmp_path):
    with pytest.raises(VdnaError) as caught:
        open_map(tmp_path)
    assert caught.value.status is Status.EMPTY
    with pytest.raises(VdnaError) as caught:
        open_map(tmp_path / "nowhere")
    assert caught.value.status is Status.IO
    small_experience().write(tmp_path / "a.vdna")
    small_experience().write(tmp_path / "b.vdna")
    with pytest.raises(VdnaError, match="both named winter"):
        open_map(tmp_path)
    assert not is_mapped(tmp_path)


@pytest.mark.parametrize("shift", range(9))
def test_the_bytes_of_a_file_are_an_experience_wherever_they_begin(tmp_path, shift):
    written = small_experience()
    written.write(tmp_path / "winter.vdna")
    data = (tmp_path / "winter.vdna").read_bytes()
    read = Experience.from_bytes(memoryview(bytes(shift) + data)[shift:])
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(read, name), getattr(written, name), name)
    assert emd_mean(read.histogram, written.histogram) == 0
    read.check_comparable(written)
    with pytest.raises(VdnaError, match="experience in memory: ") as refused:
        Experience.from_bytes(data[:-1] + bytes([data[-1] ^ 1]))
    assert refused.value.status == Status.CHECKSUM


def test_an_array_of_an_experience_in_memory_keeps_its_bytes(tmp_path):
    small_experience().write(tmp_path / "winter.vdna")
    counts = Experience.from_bytes(bytearray((tmp_path / "winter.vdna").read_bytes())).histogram.counts
    gc.collect()
    np.testing.assert_array_equal(counts, small_experience().histogram.counts)


def test_a_pickled_experience_is_that_of_the_same_bytes(tmp_path):
    one = small_experience()
    one.write(tmp_path / "winter.vdna")
    vdna = (tmp_path / "winter.vdna").read_bytes()
    for given in (one, libvdna.Experience.open(tmp_path / "winter.vdna"), libvdna.Experience.from_bytes(vdna)):
        assert given.to_bytes() == vdna
        again = pickle.loads(pickle.dumps(given))
        assert again.to_bytes() == vdna and again.name == "winter"


def test_an_experience_counted_otherwise_keeps_all_else(tmp_path):
    one = small_experience()
    one.write(tmp_path / "old.vdna")
    old = libvdna.Experience.open(tmp_path / "old.vdna")
    counts = np.array(one.histogram.counts[::-1])
    range = one.histogram.range * np.float32(2)
    for given in (one, old):
        new = given.with_histogram(libvdna.HistogramView(range, counts))
        assert new.to_bytes() == small_experience(
            histogram=libvdna.HistogramView(range, counts)
        ).to_bytes()
        assert np.array_equal(new.histogram.counts, counts)
    assert np.array_equal(old.histogram.counts, one.histogram.counts)
    assert new.identity.comparable != old.comparable
