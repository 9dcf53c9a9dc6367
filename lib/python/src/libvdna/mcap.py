"""LCM logs as MCAP files, which Foxglove and Rerun open; vdna-mcap is the program.

Needs the packages of the extra `libvdna[mcap]`. Camera messages become foxglove.CompressedImage or
foxglove.RawImage; all other types whose .lcm files are known become protobuf messages of their own
name and members. Where a message has a position there is another topic with it: CHANNEL/location
(foxglove.LocationFix) for degrees, CHANNEL/pose (foxglove.PoseInFrame) for metres of a local frame;
of localisations that are not VALID, CHANNEL/location_unsure and CHANNEL/pose_unsure.

log_time is when the event was logged, publish_time the utime of the message.
"""

from __future__ import annotations

import contextlib
import os
import pathlib
from collections import Counter
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union

from ._lcm_log import Event, EventLog
from ._lcm_types import DamagedMessage, Struct, TypeFileError, Types
from ._lcm_types import decode, fingerprint_of, text_of

try:
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
    from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
    from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
    from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
    from google.protobuf.message import Message
    from google.protobuf.timestamp_pb2 import Timestamp
    from mcap.writer import Writer
    from mcap_protobuf.schema import build_file_descriptor_set

    from ._lcm_pictures import CompressedPicture, picture_of
    from ._lcm_protobuf import ProtobufType
except ImportError as error:
    raise ImportError(
        f"{error}; for MCAP, libvdna needs: pip install mcap mcap-protobuf-support "
        "foxglove-schemas-protobuf (the extra libvdna[mcap])"
    ) from error

__all__ = ["Conversion", "TypeFileError", "convert"]

_NS_MAX = 2**63 - 1  # what readers compute with
_WGS84 = "wgs84"
_OWN_TYPES = pathlib.Path(__file__).with_name("lcmtypes")

# A further topic's ending and its message.
Derived = Tuple[str, Message]


@dataclass
class Conversion:
    """What convert() did."""

    topics: Dict[Tuple[str, str], int] = field(default_factory=dict)
    """Messages written, by topic and name of the schema."""
    left_out: List[str] = field(default_factory=list)
    """Sentences: what of the log is not in the file, and why."""


def convert(
    log: Union[str, "os.PathLike[str]"],
    out: Union[str, "os.PathLike[str]"],
    types: Sequence[Union[str, "os.PathLike[str]"]] = (),
) -> Conversion:
    """Write the messages of an LCM log to an MCAP file: chunks of zstd, with an index.

    types: .lcm files, or folders of such, with further types or other versions of ours
    out: replaced when all is written; left as it is after an error
    Raises TypeFileError, ValueError if log is no LCM log or holds nothing that can be converted, and
    OSError.
    """
    own = known = Types(_OWN_TYPES)
    for path in types:
        known = Types(pathlib.Path(path), known)
    events = EventLog(log)
    if os.path.exists(out) and os.path.samefile(log, out):
        raise ValueError(f"{out}: is the log itself; give another name for the MCAP file")
    with _replaced(pathlib.Path(out)) as part, open(part, "wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="libvdna vdna-mcap")
        converter = _Converter(writer, own, known)
        for event in events:
            converter.take(event)
        writer.finish()  # type: ignore[no-untyped-call]
        done = Conversion(converter.counts, [*_damages(events), *converter.left_out()])
        if not done.topics:
            reasons = "; ".join(done.left_out) or "it holds no events"
            raise ValueError(f"{log}: nothing that can be converted: {reasons}")
    return done


@contextlib.contextmanager
def _replaced(path: pathlib.Path) -> Iterator[pathlib.Path]:
    """A file beside `path` that takes its place in the end."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        yield part
        os.replace(part, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            part.unlink()


def _damages(events: EventLog) -> Iterator[str]:
    for damage in events.damages:
        yield f"damaged at byte {damage.offset}: {damage.size} bytes are no events"
    if events.end_bytes:
        yield f"its last {events.end_bytes} bytes are zeros or half an event"


class _Converter:
    """Writes one message after the other."""

    def __init__(self, writer: Writer, own: Types, types: Types) -> None:
        self._writer, self._own, self._types = writer, own, types
        self.counts: Dict[Tuple[str, str], int] = {}
        self._schemas: Dict[Tuple[str, bytes], int] = {}
        self._channels: Dict[Tuple[str, int], int] = {}
        self._protobuf: Dict[int, ProtobufType] = {}  # by id() of the struct
        self._foxglove: Dict[str, bytes] = {}  # schemas
        self._unknown: Counter[Tuple[str, Optional[int]]] = Counter()
        self._refused: Counter[Tuple[str, str]] = Counter()
        self._first_refusal: Dict[Tuple[str, str], str] = {}

    def take(self, event: Event) -> None:
        channel = text_of(event.channel)
        fingerprint = fingerprint_of(event.data)
        one = self._types.find(fingerprint) if fingerprint is not None else None
        if one is None or fingerprint is None:
            self._unknown[channel, fingerprint] += 1
            return
        try:
            self._write(channel, event, one, decode(one, event.data))
        except (DamagedMessage, TypeFileError) as refusal:
            kind = channel, one.full_name
            self._refused[kind] += 1
            self._first_refusal.setdefault(kind, f"event {event.number}: {refusal}")

    def left_out(self) -> Iterator[str]:
        for (channel, fingerprint), count in self._unknown.items():
            if fingerprint is None:
                yield f"{channel}: {count} messages of less than 8 bytes"
            else:
                yield (
                    f"{channel}: {count} messages of fingerprint {fingerprint:016x}, which is no "
                    "known type; give its .lcm file with --types"
                )
        for kind, count in self._refused.items():
            channel, name = kind
            yield f"{channel}: {count} messages of {name}, the first {self._first_refusal[kind]}"

    def _write(self, topic: str, event: Event, one: Struct, members: Dict[str, Any]) -> None:
        times = _times(event, members)
        # Another version of a type of ours may lack what is read here.
        name = one.full_name if self._own.named(one.full_name) is one else ""
        stamp = _timestamp(times[1])
        picture = _picture(topic, stamp, members) if name == "bot_core.image_t" else None
        if picture is not None:
            self._write_message(topic, picture, event, times)
            return
        protobuf = self._protobuf_type(one)
        data = protobuf.encode(members)
        self._write_bytes(topic, one.full_name, protobuf.schema, data, event, times)
        if name in _POSITIONS:
            for ending, message in _POSITIONS[name](topic, stamp, members):
                self._write_message(topic + ending, message, event, times)

    def _protobuf_type(self, one: Struct) -> ProtobufType:
        if id(one) not in self._protobuf:
            self._protobuf[id(one)] = ProtobufType(one)
        return self._protobuf[id(one)]

    def _write_message(
        self, topic: str, message: Message, event: Event, times: Tuple[int, int]
    ) -> None:
        name = message.DESCRIPTOR.full_name
        if name not in self._foxglove:
            self._foxglove[name] = build_file_descriptor_set(type(message)).SerializeToString()
        data = message.SerializeToString()
        self._write_bytes(topic, name, self._foxglove[name], data, event, times)

    def _write_bytes(
        self,
        topic: str,
        name: str,
        schema: bytes,
        data: bytes,
        event: Event,
        times: Tuple[int, int],
    ) -> None:
        log_time, publish_time = times
        self._writer.add_message(
            self._channel(topic, self._schema(name, schema)),
            log_time=log_time,
            publish_time=publish_time,
            sequence=event.number & 0xFFFFFFFF,
            data=data,
        )
        self.counts[topic, name] = self.counts.get((topic, name), 0) + 1

    def _schema(self, name: str, schema: bytes) -> int:
        key = name, schema
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(name, "protobuf", schema)
        return self._schemas[key]

    def _channel(self, topic: str, schema: int) -> int:
        key = topic, schema
        if key not in self._channels:
            self._channels[key] = self._writer.register_channel(topic, "protobuf", schema)
        return self._channels[key]


def _times(event: Event, members: Dict[str, Any]) -> Tuple[int, int]:
    """When it was logged and when it was published, in nanoseconds. MCAP has none before 1970; a
    utime that it cannot have is replaced by the time of logging."""
    log_time = min(max(event.time_us, 0) * 1000, _NS_MAX)
    utime = members.get("utime")
    has_utime = isinstance(utime, int) and 0 <= utime <= _NS_MAX // 1000
    return log_time, utime * 1000 if isinstance(utime, int) and has_utime else log_time


def _timestamp(time_ns: int) -> Timestamp:
    seconds, nanos = divmod(time_ns, 1000000000)
    return Timestamp(seconds=seconds, nanos=nanos)


def _picture(topic: str, stamp: Timestamp, image: Dict[str, Any]) -> Optional[Message]:
    """None if the picture is of a format that Foxglove does not have."""
    picture = picture_of(image)
    if picture is None:
        return None
    if isinstance(picture, CompressedPicture):
        return CompressedImage(
            timestamp=stamp, frame_id=topic, format=picture.format, data=picture.data
        )
    return RawImage(
        timestamp=stamp,
        frame_id=topic,
        width=picture.width,
        height=picture.height,
        encoding=picture.encoding,
        step=picture.step,
        data=picture.data,
    )


def _fix(
    topic: str, stamp: Timestamp, latitude: float, longitude: float, altitude: float
) -> Message:
    return LocationFix(
        timestamp=stamp,
        frame_id=topic,
        latitude=latitude,
        longitude=longitude,
        altitude=altitude,
    )


def _pose(
    frame: str, stamp: Timestamp, position: Sequence[float], quaternion_wxyz: Sequence[float]
) -> Message:
    made = PoseInFrame(timestamp=stamp, frame_id=frame)
    made.pose.position.x, made.pose.position.y, made.pose.position.z = position
    orientation = made.pose.orientation
    orientation.w, orientation.x, orientation.y, orientation.z = quaternion_wxyz
    return made


def _of_localisation(topic: str, stamp: Timestamp, members: Dict[str, Any]) -> List[Derived]:
    if not members["has_position"]:
        return []
    ending = "" if members["validity"] == 0 else "_unsure"
    position = members["position"]
    if members["position_frame"] == _WGS84:
        return [("/location" + ending, _fix(topic, stamp, *position))]
    return [("/pose" + ending, _pose(members["position_frame"], stamp, position, (1, 0, 0, 0)))]


def _of_gps(topic: str, stamp: Timestamp, members: Dict[str, Any]) -> List[Derived]:
    if members["gps_lock"] == 0:
        return []
    position = members["latitude"], members["longitude"], members["elev"]
    return [("/location", _fix(topic, stamp, *position))]


def _of_pose(_topic: str, stamp: Timestamp, members: Dict[str, Any]) -> List[Derived]:
    return [("/pose", _pose("local", stamp, members["pos"], members["orientation"]))]


_POSITIONS: Dict[str, Callable[[str, Timestamp, Dict[str, Any]], List[Derived]]] = {
    "vdna_msg.localisation_t": _of_localisation,
    "bot_core.gps_data_t": _of_gps,
    "bot_core.pose_t": _of_pose,
}
