"""LCM logs become MCAP files that others read: PyPI's mcap decodes them here, and Rerun if it is there.

Messages are encoded by what lcm-gen writes, not by us.
"""

import importlib
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("mcap_protobuf", reason="no mcap-protobuf-support")
pytest.importorskip("foxglove_schemas_protobuf", reason="no foxglove-schemas-protobuf")

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_protobuf.decoder import DecoderFactory

import libvdna
from libvdna import _vdna_mcap
from libvdna._lcm_types import Types, decode, fingerprint
from libvdna.mcap import TypeFileError, convert

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "test" / "support"))
from tiny_network import write_tiny_network  # noqa: E402

LCMTYPES = ROOT / "lcmtypes"
JPEG = b"\xff\xd8\xff\xe0 as good as one"
HOSTILE = ["", "../../etc/passwd", "<b>&amp;", "a\nb\0c", "\u202eevil", "{}%s\\", "x" * 5000]
UTIME = 1700000000123456


@pytest.fixture(scope="session")
def generated(tmp_path_factory):
    """The packages vdna_msg and bot_core that lcm-gen writes."""
    if not shutil.which("lcm-gen"):
        pytest.skip("no lcm-gen")
    folder = tmp_path_factory.mktemp("generated")
    files = sorted(LCMTYPES.glob("*.lcm"))
    for file in files:
        subprocess.run(["lcm-gen", "-p", "--ppath", folder, file], check=True)
    sys.path.insert(0, str(folder))
    yield {name: importlib.import_module(name) for name in ("vdna_msg", "bot_core")}
    sys.path.remove(str(folder))


def log_bytes(events):
    """(channel, message), ten a second."""
    parts = []
    for number, (channel, message) in enumerate(events):
        head = struct.pack(
            ">4sqqII", b"\xed\xa1\xda\x01", number, UTIME + number * 100000, len(channel), len(message)
        )
        parts.append(head + channel + message)
    return b"".join(parts)


def write_log(folder, events):
    path = folder / "drive.lcm"
    path.write_bytes(log_bytes(events))
    return path


def read_back(path):
    """(topic, schema, message record, decoded message) in the order of log time."""
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert all(chunk.compression == "zstd" for chunk in reader.get_summary().chunk_indexes)
        return [
            (channel.topic, schema.name, record, message)
            for schema, channel, record, message in reader.iter_decoded_messages()
        ]


def converted(folder, events, types=()):
    out = folder / "out.mcap"
    done = convert(write_log(folder, events), out, types)
    return done, read_back(out)


def image(generated, data, fourcc, width=0, height=0, stride=0, utime=UTIME):
    made = generated["bot_core"].image_t()
    made.utime, made.width, made.height, made.row_stride = utime, width, height, stride
    (made.pixelformat,) = struct.unpack("<i", fourcc)
    made.size, made.data = len(data), data
    return made.encode()


def localisation(generated, frame, position, validity=0):
    made = generated["vdna_msg"].localisation_t()
    made.utime, made.validity, made.has_position = UTIME, validity, frame != ""
    made.position_frame, made.position = frame, position
    return made.encode()


def fill(message, dice):
    """Give every member a value, the awkward ones too."""
    lengths = {dimensions[0] for dimensions in message.__dimensions__ if dimensions}
    for name, kind, dimensions in zip(
        message.__slots__, message.__typenames__, message.__dimensions__
    ):
        if name in lengths:
            setattr(message, name, dice.choice([0, 1, 7]))
            continue
        if dimensions is None:
            setattr(message, name, value_of(kind, dice))
            continue
        (count,) = dimensions
        count = getattr(message, count) if isinstance(count, str) else count
        values = [value_of(kind, dice) for _ in range(count)]
        setattr(message, name, bytes(values) if kind == "byte" else values)
    return message


def value_of(kind, dice):
    if kind == "boolean":
        return dice.random() < 0.5
    if kind == "byte":
        return dice.randrange(256)
    if kind in ("int32_t", "int64_t"):
        bits = 31 if kind == "int32_t" else 63
        return dice.choice([0, 1, -1, 2**bits - 1, -(2**bits), dice.randrange(10**6)])
    if kind == "double":
        return dice.choice([0.0, -0.0, math.nan, math.inf, -math.inf, 5e-324, dice.random()])
    if kind == "string":
        return dice.choice(HOSTILE)
    package, struct_name = kind.split(".")
    return fill(getattr(importlib.import_module(package), struct_name)(), dice)


def fresh(generated, kind):
    package, name = kind.split(".")
    return getattr(generated[package], name)()


def assert_same(ours, theirs):
    """A decoded protobuf message has each member of what lcm-gen decodes."""
    for name in theirs.__slots__:
        value, expected = getattr(ours, name), getattr(theirs, name)
        if hasattr(expected, "__slots__"):
            assert ours.HasField(name)
            assert_same(value, expected)
        elif isinstance(expected, (list, tuple)):
            assert len(value) == len(expected), name
            for one, other in zip(value, expected):
                assert_same_value(one, other, name)
        else:
            assert_same_value(value, expected, name)


def assert_same_value(value, expected, name):
    if hasattr(expected, "__slots__"):
        assert_same(value, expected)
    elif isinstance(expected, float):
        assert struct.pack("<d", value) == struct.pack("<d", expected), name
    else:
        assert value == expected, name


@pytest.mark.parametrize("folder", [LCMTYPES, pathlib.Path(libvdna.__file__).parent / "lcmtypes"])
def test_our_types_have_the_pinned_fingerprints(folder):
    types = Types(folder)
    pinned = [line.split() for line in (LCMTYPES / "fingerprints.txt").read_text().splitlines()]
    assert len(pinned) == 8
    for name, digits in pinned:
        assert types.find(int(digits, 16)).full_name == name


@pytest.mark.parametrize(
    "kind",
    [
        *("ranking_t", "localisation_t", "status_t", "command_t", "command_result_t"),
        *("gps_data_t", "pose_t", "image_t"),
    ],
)
def test_every_member_of_a_message_comes_back_equal(generated, tmp_path, kind):
    dice = random.Random(3)
    package = "bot_core" if kind in ("gps_data_t", "pose_t", "image_t") else "vdna_msg"
    made = [fill(fresh(generated, f"{package}.{kind}"), dice) for _ in range(50)]
    for message in made:
        if kind == "image_t":
            message.pixelformat = 0x31324142  # BA12, which Foxglove has not: the message stays
    done, messages = converted(tmp_path, [(b"C", one.encode()) for one in made])
    assert done.left_out == []
    messages = [row for row in messages if row[0] == "C"]
    assert [row[1] for row in messages] == [f"{package}.{kind}"] * 50
    for (_, _, _, ours), theirs in zip(messages, made):
        assert_same(ours, type(theirs).decode(theirs.encode()))


def test_log_time_is_the_event_s_and_publish_time_the_message_s(generated, tmp_path):
    command = generated["vdna_msg"].command_t()
    command.utime = UTIME - 7
    before_1970 = generated["vdna_msg"].command_t()
    before_1970.utime = -1
    _, messages = converted(tmp_path, [(b"C", command.encode()), (b"C", before_1970.encode())])
    (_, _, first, _), (_, _, second, _) = messages
    assert (first.log_time, first.publish_time) == (UTIME * 1000, (UTIME - 7) * 1000)
    assert second.log_time == second.publish_time == (UTIME + 100000) * 1000


def test_a_compressed_picture_stays_as_it_is(generated, tmp_path):
    _, messages = converted(tmp_path, [(b"CAMERA", image(generated, JPEG, b"MJPG"))])
    ((topic, schema, _, picture),) = messages
    assert (topic, schema) == ("CAMERA", "foxglove.CompressedImage")
    assert (picture.format, picture.data) == ("jpeg", JPEG)
    assert picture.timestamp.ToMicroseconds() == UTIME


@pytest.mark.parametrize(
    "fourcc, encoding, pixel, out_pixel",
    [
        (b"GREY", "mono8", 1, 1),
        (b"RGB3", "rgb8", 3, 3),
        (b"BGR3", "bgr8", 3, 3),
        (b"RGB4", "rgb8", 4, 3),
        (b"BGR4", "bgr8", 4, 3),
        (b"YUYV", "yuyv", 2, 2),
        (b"UYVY", "uyvy", 2, 2),
        (b"Y16 ", "mono16", 2, 2),
    ],
)
def test_a_raw_picture_keeps_its_pixels(generated, tmp_path, fourcc, encoding, pixel, out_pixel):
    stride = 4 * pixel + 5
    data = bytes(range(stride * 2))
    _, messages = converted(tmp_path, [(b"CAMERA", image(generated, data, fourcc, 4, 2, stride))])
    ((_, schema, _, picture),) = messages
    assert (schema, picture.encoding) == ("foxglove.RawImage", encoding)
    assert (picture.width, picture.height) == (4, 2)
    for y in range(2):
        for x in range(4):
            at = y * picture.step + x * out_pixel
            found = picture.data[at : at + out_pixel]
            begin = y * stride + x * pixel
            assert found == data[begin : begin + pixel][:out_pixel]


@pytest.mark.parametrize("fourcc", [b"I420", b"YU12", b"NV12"])
def test_planes_become_colours(generated, tmp_path, fourcc):
    # Pure red of BT.601: Y 81, U 90, V 240. The left half of the picture; the right one is grey.
    luma = bytes([81, 81, 126, 126]) * 2
    u, v = bytes([90, 128]), bytes([240, 128])
    chroma = bytes([90, 240, 128, 128]) if fourcc == b"NV12" else u + v
    _, messages = converted(tmp_path, [(b"CAMERA", image(generated, luma + chroma, fourcc, 4, 2))])
    picture = messages[0][3]
    assert (picture.encoding, picture.step, len(picture.data)) == ("rgb8", 12, 24)
    for at, expected in ((0, (254, 0, 0)), (6, (128, 128, 128))):
        assert all(abs(a - b) <= 2 for a, b in zip(picture.data[at : at + 3], expected))


@pytest.mark.parametrize(
    "width, height, stride, size", [(4, 2, 0, 7), (-4, 2, 0, 8), (4, 0, 0, 8), (4, 2, 3, 8)]
)
def test_a_picture_that_lacks_bytes_is_left_out(generated, tmp_path, width, height, stride, size):
    whole = image(generated, bytes(8), b"GREY", 4, 2)
    lacking = image(generated, bytes(size), b"GREY", width, height, stride)
    done, messages = converted(tmp_path, [(b"CAMERA", whole), (b"CAMERA", lacking)])
    assert len(messages) == 1
    (sentence,) = done.left_out
    assert "CAMERA: 1 messages of bot_core.image_t, the first event 1: a picture" in sentence


def test_degrees_become_a_location(generated, tmp_path):
    _, messages = converted(
        tmp_path, [(b"L", localisation(generated, "wgs84", (51.75, -1.25, 70.5)))]
    )
    topics = {topic: (schema, message) for topic, schema, _, message in messages}
    assert set(topics) == {"L", "L/location"}
    schema, fix = topics["L/location"]
    assert schema == "foxglove.LocationFix"
    assert (fix.latitude, fix.longitude, fix.altitude) == (51.75, -1.25, 70.5)
    assert fix.timestamp.ToMicroseconds() == UTIME


@pytest.mark.parametrize(
    "frame, validity, topic",
    [
        ("wgs84", 3, "L/location_unsure"),
        ("hall", 0, "L/pose"),
        ("hall", 5, "L/pose_unsure"),
        ("", 0, None),
    ],
)
def test_a_place_that_may_be_wrong_is_on_a_topic_of_its_own(
    generated, tmp_path, frame, validity, topic
):
    _, messages = converted(
        tmp_path, [(b"L", localisation(generated, frame, (1.5, 2.5, 3.5), validity))]
    )
    assert {row[0] for row in messages} == {"L", topic} - {None}
    poses = [row[3] for row in messages if row[1] == "foxglove.PoseInFrame"]
    for pose in poses:
        assert pose.frame_id == frame
        assert (pose.pose.position.x, pose.pose.position.y, pose.pose.position.z) == (1.5, 2.5, 3.5)
        assert pose.pose.orientation.w == 1


def test_a_receiver_without_a_fix_has_no_location(generated, tmp_path):
    fixes = [generated["bot_core"].gps_data_t() for _ in range(2)]
    fixes[1].gps_lock, fixes[1].latitude, fixes[1].longitude, fixes[1].elev = 1, 51.5, -1.5, 60
    _, messages = converted(tmp_path, [(b"GPS", fix.encode()) for fix in fixes])
    (location,) = [row[3] for row in messages if row[0] == "GPS/location"]
    assert (location.latitude, location.longitude, location.altitude) == (51.5, -1.5, 60)


def test_a_pose_keeps_its_orientation(generated, tmp_path):
    made = generated["bot_core"].pose_t()
    made.pos, made.orientation = (1, 2, 3), (0.5, 0.1, 0.2, 0.3)
    _, messages = converted(tmp_path, [(b"POSE", made.encode())])
    (pose,) = [row[3].pose for row in messages if row[0] == "POSE/pose"]
    turned = pose.orientation
    assert (turned.w, turned.x, turned.y, turned.z) == (0.5, 0.1, 0.2, 0.3)


TREE = """
package robots.arm; /* of another
project */
struct leaf_t { int8_t class, Clear[2]; }
struct tree_t {
    const int32_t N = 0x2, M = 3;
    const double PI = 3.14;
    double grid[N][M];   // a table
    int16_t n;
    float DESCRIPTOR[n];
    byte raw[n];
    boolean SerializeToString[2];
    string message[n];
    leaf_t optional;
    robots.arm.tree_t children[n];
    byte one;
}
"""


def tree(type_fingerprint, n, children=b""):
    """A tree_t whose lists have n elements."""
    texts = b"".join(struct.pack(">i", 3) + b"%d\xff\0" % (i % 10) for i in range(n))
    members = struct.pack(f">6dh{n}f", *range(6), n, *(i / 2 for i in range(n)))
    members += bytes(range(n)) + b"\1\0" + texts + struct.pack("3b", -1, -2, 3) + children + b"\x07"
    return (struct.pack(">Q", type_fingerprint) if type_fingerprint else b"") + members


def test_any_type_can_be_given(tmp_path):
    (tmp_path / "tree.lcm").write_text(TREE)
    of_tree = fingerprint(Types(tmp_path).named("robots.arm.tree_t"))
    message = tree(of_tree, 2, tree(0, 0) + tree(0, 1, tree(0, 0)))
    done, messages = converted(tmp_path, [(b"T", message)], [tmp_path / "tree.lcm"])
    assert done.left_out == []
    ((_, schema, _, made),) = messages
    assert schema == "robots.arm.tree_t"
    assert list(made.grid) == [0, 1, 2, 3, 4, 5]
    assert (made.n, list(made.DESCRIPTOR), made.raw, made.one) == (2, [0, 0.5], b"\0\1", 7)
    assert list(getattr(made, "SerializeToString")) == [True, False]
    assert list(made.message) == ["0\\xff", "1\\xff"]
    assert (getattr(made.optional, "class"), list(made.optional.Clear)) == (-1, [-2, 3])
    assert [child.n for child in made.children] == [0, 1]
    assert made.children[1].children[0].one == 7


def test_a_type_has_lcm_gen_s_fingerprint(tmp_path):
    if not shutil.which("lcm-gen"):
        pytest.skip("no lcm-gen")
    (tmp_path / "tree.lcm").write_text(TREE.replace("class", "klass"))
    subprocess.run(["lcm-gen", "-p", "--ppath", tmp_path, tmp_path / "tree.lcm"], check=True)
    code = "import robots.arm as a; print(a.tree_t._get_hash_recursive([]), a.leaf_t._get_hash_recursive([]))"
    printed = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True, text=True
    ).stdout
    types = Types(tmp_path)
    ours = [fingerprint(types.named(f"robots.arm.{name}")) for name in ("tree_t", "leaf_t")]
    assert [int(number) for number in printed.split()] == ours


@pytest.mark.parametrize(
    "text, expected",
    [
        ("struct a_t { int32_t x }", "a.lcm:1: found '}', expected ',' or ';'"),
        ("struct a_t {\n int32_t x[m];\n}", "a.lcm:2: found 'm', expected a number, or an integer"),
        ("struct a_t { b_t x; }", "a_t.x has type b_t, which is in no file given"),
        ("enum a_t { A, B }", "enum is not understood"),
        ("struct a_t { int32_t x; int32_t x; }", "a second member x"),
        ("struct a_t { int32_t x;", "found 'the end of the file'"),
        ("struct a_t { int32_t x; } struct a_t { int32_t y; }", "struct a_t is in"),
        ("package !", "found '!', expected a statement"),
    ],
)
def test_a_file_that_is_not_understood_is_refused_with_its_place(tmp_path, text, expected):
    (tmp_path / "a.lcm").write_text(text)
    with pytest.raises(TypeFileError) as refusal:
        Types(tmp_path / "a.lcm")
    assert expected in str(refusal.value)


def test_messages_of_another_version_need_its_file(generated, tmp_path):
    old = tmp_path / "old"
    old.mkdir()
    (old / "localisation.lcm").write_text("package vdna_msg; struct localisation_t { int64_t utime; }")
    of_old = fingerprint(Types(old).named("vdna_msg.localisation_t"))
    events = [
        (b"L", struct.pack(">Qq", of_old, 5)),
        (b"L", localisation(generated, "hall", (0, 0, 0))),
    ]
    done, messages = converted(tmp_path, events)
    assert [row[0] for row in messages] == ["L", "L/pose"]
    assert f"L: 1 messages of fingerprint {of_old:016x}" in done.left_out[0]
    done, messages = converted(tmp_path, events, [old])
    assert done.left_out == []
    assert [row[1] for row in messages if row[0] == "L"] == ["vdna_msg.localisation_t"] * 2


def test_damage_is_counted_and_named(generated, tmp_path):
    one = localisation(generated, "", (0, 0, 0))
    log = tmp_path / "damaged.lcm"
    event = log_bytes([(b"L", one)])
    log.write_bytes(event + b"garbage" + event + log_bytes([(b"L", one[:-1])]) + event[:40])
    done = convert(log, tmp_path / "out.mcap")
    assert done.topics == {("L", "vdna_msg.localisation_t"): 2}
    assert done.left_out == [
        f"damaged at byte {len(event)}: 7 bytes are no events",
        "its last 40 bytes are zeros or half an event",
        "L: 1 messages of vdna_msg.localisation_t, the first event 0: has 7 bytes where 8 are expected",
    ]


def test_no_damage_ends_in_a_crash(generated, tmp_path):
    dice = random.Random(11)
    whole = log_bytes(
        [(b"R", fill(fresh(generated, "vdna_msg.ranking_t"), dice).encode()) for _ in range(2)]
        + [(b"CAMERA", image(generated, bytes(8), b"GREY", 4, 2))]
        + [(b"L", localisation(generated, "wgs84", (1, 2, 3)))]
    )
    path, out = tmp_path / "damaged.lcm", tmp_path / "out.mcap"
    for _ in range(300):
        bytes_ = bytearray(whole[: dice.randrange(5, len(whole) + 1)])
        for _ in range(dice.randrange(1, 6)):
            bytes_[dice.randrange(4, len(bytes_))] = dice.randrange(256)
        path.write_bytes(bytes_)
        try:
            convert(path, out)
        except ValueError as refusal:
            assert "nothing that can be converted" in str(refusal)


def test_a_count_keeps_nobody_busy(tmp_path):
    (tmp_path / "a.lcm").write_text(
        "struct empty_t { } struct a_t { int32_t n; empty_t nothing[n]; }"
        " struct b_t { int32_t n; string words[n]; }"
    )
    types = Types(tmp_path)
    for name in ("a_t", "b_t"):
        message = struct.pack(">Qi", fingerprint(types.named(name)), 2**31 - 1)
        with pytest.raises(ValueError, match="claims 2147483647 elements"):
            decode(types.named(name), message)


def test_structs_in_one_another_end_somewhere(tmp_path):
    (tmp_path / "a.lcm").write_text("struct a_t { int8_t n; a_t inner[n]; }")
    one = Types(tmp_path).named("a_t")
    assert decode(one, bytes(8) + b"\1" * 63 + b"\0")["n"] == 1
    with pytest.raises(ValueError, match="nested more than 64 deep"):
        decode(one, bytes(8) + b"\1" * 5000 + b"\0")


def test_the_program_tells_what_it_wrote(generated, tmp_path, capsys):
    log = write_log(
        tmp_path, [(b"L\x1b[2J", localisation(generated, "", (0, 0, 0))), (b"X", b"12345678")]
    )
    out = tmp_path / "out.mcap"
    assert _vdna_mcap.main([str(log), str(out)]) == 3
    printed = capsys.readouterr()
    assert printed.out == "L\\x1b[2J: 1 vdna_msg.localisation_t\n"
    assert f"vdna-mcap: {log}: X: 1 messages of fingerprint 3132333435363738" in printed.err
    assert len(read_back(out)) == 1


@pytest.mark.parametrize(
    "content, expected",
    [
        (b"", "not an LCM log"),
        (b"\x89MCAP0\r\n", "not an LCM log"),
        (log_bytes([(b"X", b"1234")]), "nothing that can be converted: X: 1 messages of less than 8"),
    ],
)
def test_what_cannot_be_converted_leaves_the_file_as_it_was(tmp_path, capsys, content, expected):
    log, out = tmp_path / "drive.lcm", tmp_path / "out.mcap"
    log.write_bytes(content)
    out.write_bytes(b"before")
    assert _vdna_mcap.main([str(log), str(out)]) == 1
    assert expected in capsys.readouterr().err
    assert out.read_bytes() == b"before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["drive.lcm", "out.mcap"]


def test_a_log_is_not_replaced_by_itself(generated, tmp_path, capsys):
    log = write_log(tmp_path, [(b"L", localisation(generated, "", (0, 0, 0)))])
    before = log.read_bytes()
    assert _vdna_mcap.main([str(log), str(log)]) == 1
    assert "is the log itself" in capsys.readouterr().err
    assert log.read_bytes() == before


def rewritten(path, compression):
    """The messages of an MCAP file in another one, in small chunks."""
    out = path.with_name(f"{compression.name.lower()}.mcap")
    with open(path, "rb") as file, open(out, "wb") as new:
        writer = Writer(new, chunk_size=4000, compression=compression)
        writer.start()
        channels = {}
        for schema, channel, message in make_reader(file).iter_messages():
            if channel.id not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, number
                )
            times = message.log_time, message.data, message.publish_time
            writer.add_message(channels[channel.id], *times)
        writer.finish()
    return out


def test_vdna_builds_the_same_experience_from_the_file_as_from_the_log(generated, tmp_path):
    program = os.environ.get("VDNA")
    if program is None:
        pytest.skip("VDNA, the program vdna, is not set")
    manifest = write_tiny_network(
        tmp_path, ("map", "neurons_samples"), ("tokens", "samples_neurons")
    )

    def vdna(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)

    vdna("simulate", tmp_path / "summer", "--frames", 8, "--size", "64x48")
    events = []
    for number, jpeg in enumerate(sorted((tmp_path / "summer").glob("*.jpg"))):
        utime = UTIME + number * 100000
        fix = generated["bot_core"].gps_data_t()
        fix.utime, fix.gps_lock, fix.elev = utime, 1, 70
        fix.latitude, fix.longitude = 51.75 + number * 1e-5, -1.25
        events.append((b"CAMERA", image(generated, jpeg.read_bytes(), b"MJPG", utime=utime)))
        events.append((b"GPS", fix.encode()))
    log = write_log(tmp_path, events)
    convert(log, tmp_path / "zstd.mcap")
    sources = {log: "GPS", tmp_path / "zstd.mcap": "GPS/location"}
    for compression in (CompressionType.LZ4, CompressionType.NONE):
        sources[rewritten(tmp_path / "zstd.mcap", compression)] = "GPS/location"

    built = []
    for source, positions in sources.items():
        folder = tmp_path / f"map-{source.name}"
        vdna("build", folder, source, "--backbone", manifest, "--pose-channel", positions)
        (experience,) = libvdna.open_map(folder)
        built.append(experience)
    for experience in built[1:]:
        np.testing.assert_array_equal(experience.frame_utime, built[0].frame_utime)
        np.testing.assert_array_equal(experience.embeddings, built[0].embeddings)
        np.testing.assert_array_equal(experience.frame_position, built[0].frame_position)
        np.testing.assert_array_equal(experience.histogram.counts, built[0].histogram.counts)
    assert list(built[0].frame_utime) == [UTIME + number * 100000 for number in range(8)]


def test_rerun_shows_pictures_typed_columns_and_locations(generated, tmp_path):
    chunk = pytest.importorskip("rerun.chunk", reason="no rerun-sdk")
    events = [
        (b"CAMERA", image(generated, JPEG, b"MJPG")),
        (b"L", localisation(generated, "wgs84", (51.75, -1.25, 70))),
    ]
    converted(tmp_path, events)
    columns = {}
    for one in chunk.McapReader(tmp_path / "out.mcap").stream():
        batch = one.to_record_batch()
        columns.update({(one.entity_path, name): batch.column(name) for name in batch.schema.names})
    assert columns["/CAMERA", "EncodedImage:blob"].to_pylist() == [[list(JPEG)]]
    assert columns["/L/location", "GeoPoints:positions"].to_pylist() == [[[51.75, -1.25]]]
    answer = columns["/L", "vdna_msg.localisation_t:message"]
    assert answer.to_pylist()[0][0]["position"] == [51.75, -1.25, 70]
    assert str(answer.type.value_type.field("confidence").type) == "double"
