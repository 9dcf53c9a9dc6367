"""The events of an LCM log, damaged or not: the same rules as lib/transport/log_file.h has.

Where bytes are no event, reading goes on at the next magic number. Half an event at the end, which
a killed logger leaves, and zeros at the end, which a power cut leaves, are the end.
"""

from __future__ import annotations

import mmap
import os
import re
import struct
from dataclasses import dataclass
from typing import Iterator, List, Optional, Union

_MAGIC = b"\xed\xa1\xda\x01"
_HEADER = struct.Struct(">4sqqII")
_CHANNEL_MAX = 1000  # bytes
_DATA_MAX = 2**31 - 1  # bytes
_HOLE = 16  # zeros at the end of an event that runs into a hole
_NOT_ZERO = re.compile(rb"[^\0]")


@dataclass(frozen=True)
class Event:
    number: int
    """Those of a log follow one another."""
    time_us: int
    """When it was logged, microseconds since 1970."""
    channel: bytes
    data: bytes


@dataclass(frozen=True)
class Damage:
    """Bytes of the log that are no event."""

    offset: int
    size: int


class EventLog:
    """An LCM log: iterate over it once. What was passed over is in `damages` and `end_bytes`."""

    def __init__(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Raises ValueError if the file is no LCM log, OSError if it cannot be read."""
        self.damages: List[Damage] = []
        self.end_bytes = 0
        """Of half an event or of zeros at the end."""
        with open(path, "rb") as file:
            if not file.read(len(_MAGIC)) == _MAGIC:
                raise ValueError(
                    f"{path}: not an LCM log, expected one as lcm-logger writes it"
                )
            self._bytes = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._size = len(self._bytes)

    def __iter__(self) -> Iterator[Event]:
        at = damage_at = 0
        while at < self._size:
            end = self._end_of_event(at)
            if end is not None and end <= self._size and self._is_whole(at, end):
                self._note_damage(damage_at, at)
                yield self._event(at, end)
                at = damage_at = end
                continue
            next_magic = self._find_magic(at + 1)
            if next_magic == self._size and self._is_the_end(at, end):
                self._note_damage(damage_at, at)
                self.end_bytes = self._size - at
                return
            at = next_magic
        self._note_damage(damage_at, at)

    def _note_damage(self, begin: int, end: int) -> None:
        if end > begin:
            self.damages.append(Damage(begin, end - begin))

    def _find_magic(self, at: int) -> int:
        found = self._bytes.find(_MAGIC, at)
        return self._size if found < 0 else found

    def _is_zero(self, begin: int, end: int) -> bool:
        return _NOT_ZERO.search(self._bytes, begin, end) is None

    def _begins_with_magic(self, at: int) -> bool:
        rest = self._bytes[at : at + len(_MAGIC)]
        return _MAGIC.startswith(rest)

    def _end_of_event(self, at: int) -> Optional[int]:
        """Where an event ends whose header is here; None if none is."""
        if self._size - at < _HEADER.size:
            return None
        magic, _, _, channel_size, data_size = _HEADER.unpack_from(self._bytes, at)
        if magic != _MAGIC or not 1 <= channel_size <= _CHANNEL_MAX or data_size > _DATA_MAX:
            return None
        return int(at + _HEADER.size + channel_size + data_size)

    def _is_whole(self, at: int, end: int) -> bool:
        """Whether an event that fits into the file is all there: a damaged or cut one has the next
        event within its length, or runs into a hole of zeros."""
        if end == self._size or self._begins_with_magic(end):
            return True
        if self._is_zero(end, self._size):
            return True
        data_size = _HEADER.unpack_from(self._bytes, at)[4]
        in_hole = data_size >= _HOLE and self._is_zero(end - _HOLE, end + 1)
        return self._find_magic(at + 1) >= end and not in_hole

    def _is_the_end(self, at: int, end: Optional[int]) -> bool:
        """Whether half an event or zeros are all that follows."""
        if self._is_zero(at, self._size):
            return True
        if not self._begins_with_magic(at):
            return False
        return self._size - at < _HEADER.size or (end is not None and end > self._size)

    def _event(self, at: int, end: int) -> Event:
        _, number, time_us, channel_size, _ = _HEADER.unpack_from(self._bytes, at)
        data_at = at + _HEADER.size + channel_size
        channel = self._bytes[at + _HEADER.size : data_at]
        return Event(number, time_us, channel, self._bytes[data_at:end])
