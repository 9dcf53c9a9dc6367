"""Collections: experience files of a fleet under one URI; docs/reference/collection.md has the layout."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import shutil
import socket
import struct
import tempfile
import uuid
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

import fsspec  # type: ignore[import-untyped,unused-ignore]
import zstandard

from .._library import VdnaError
from ..experience import Experience

EXTENSION = ".vdna.zst"
#: Of zstd, as `zstd -3` has it: the next levels take much longer and gain little.
LEVEL = 3
#: The skippable frame of zstd that has the labels: every decoder passes over it.
_LABELS_MAGIC = 0x184D2A5D
#: What folders of a task begin with, among the machine's temporary files.
WORKSPACE = "vdna-fleet."
_ASIDE = re.compile(r"\.aside-(?P<host>.*)-(?P<pid>\d+)-[0-9a-f]{32}$")


class Labels(NamedTuple):
    """What people say of a traversal; "" = not said."""

    route: str = ""
    condition: str = ""


class DamagedObject(Exception):
    """An object is not what the layout says; str() names it and says why."""


def pack(vdna: bytes, labels: Labels) -> bytes:
    """The object of an experience file. The same input gives the same bytes."""
    text = json.dumps(labels._asdict(), sort_keys=True).encode()
    compressed = zstandard.ZstdCompressor(level=LEVEL, write_checksum=True).compress(vdna)
    return struct.pack("<II", _LABELS_MAGIC, len(text)) + text + compressed


def unpack(data: bytes) -> Tuple[bytes, Labels]:
    """The experience file and the labels in an object.

    ValueError, zstandard.ZstdError: it is damaged
    """
    labels, begin = Labels(), 0
    if len(data) >= 8:
        magic, size = struct.unpack_from("<II", data)
        if magic == _LABELS_MAGIC:
            begin = 8 + size
            labels = Labels(**json.loads(data[8:begin]))
    frame = zstandard.get_frame_parameters(data[begin:])
    if frame.content_size > 1 << 40:
        raise ValueError("its frame does not say how large its content is")
    return zstandard.ZstdDecompressor().decompress(data[begin:]), labels


class Stored(NamedTuple):
    """An object that was read."""

    experience: Experience
    labels: Labels
    vdna: bytes
    """The experience file."""
    object_size: int
    """Bytes of the object."""

    @property
    def sha256(self) -> str:
        """Of the experience file; it takes longer than reading the object."""
        return hashlib.sha256(self.vdna).hexdigest()


class Collection:
    """A folder, local or in an object store. Nothing in it is ever changed in place.

    bytes_read counts what this object has read of it.
    """

    def __init__(self, uri: str) -> None:
        """
        uri: a local path, or any URI of fsspec, such as s3://bucket/fleet
        """
        self._fs, root = fsspec.core.url_to_fs(uri)
        self._root = root.rstrip("/")
        self._is_local = "file" in (
            (self._fs.protocol,) if isinstance(self._fs.protocol, str) else self._fs.protocol
        )
        #: Of a local folder the absolute path, as workers may have another working directory.
        self.uri = self._root if self._is_local else uri
        self.bytes_read = 0

    def __repr__(self) -> str:
        return f"<Collection {self.uri}>"

    def path(self, key: str) -> str:
        """Where the file system has `key`, a path relative to the collection."""
        return f"{self._root}/{key}"

    def exists(self, key: str) -> bool:
        return bool(self._fs.exists(self.path(key)))

    def get(self, key: str) -> bytes:
        """All bytes of a file."""
        data: bytes = self._fs.cat_file(self.path(key))
        self.bytes_read += len(data)
        return data

    def open(self, key: str) -> Any:
        """A file to read from, any part of it."""
        return self._fs.open(self.path(key), "rb")

    def put(self, key: str, data: bytes) -> None:
        """Write a file whole or not at all.

        A local file is written aside, under a name that no one else has, and renamed; object stores
        show an object only when it is complete.
        """
        with self.writing(key) as file:
            file.write(data)

    @contextlib.contextmanager
    def writing(self, key: str) -> Iterator[Any]:
        """A file to write, which is there, whole, if the block ends without an exception."""
        if self._is_local:
            with writing_local(self.path(key)) as file:
                yield file
            return
        file = self._fs.open(self.path(key), "wb", autocommit=False)
        try:
            yield file
            file.close()
        except BaseException:
            file.discard()
            raise
        file.commit()

    def remove(self, key: str) -> None:
        if self.exists(key):
            self._fs.rm_file(self.path(key))

    def remove_folder(self, key: str) -> None:
        if self.exists(key):
            self._fs.rm(self.path(key), recursive=True)

    def files(self, folder: str) -> Dict[str, int]:
        """Names and sizes of the files of a folder, sorted; none if it does not exist."""
        if not self.exists(folder):
            return {}
        self._fs.invalidate_cache(self.path(folder))
        entries = self._fs.ls(self.path(folder), detail=True)
        named = {one["name"].rsplit("/", 1)[-1]: one["size"] for one in entries if one["type"] == "file"}
        return {name: named[name] for name in sorted(named) if not _ASIDE.search(name)}

    def comparables(self) -> List[str]:
        """The values of Experience.comparable that objects have."""
        if not self.exists("objects"):
            return []
        self._fs.invalidate_cache(self.path("objects"))
        entries = self._fs.ls(self.path("objects"), detail=True)
        return sorted(one["name"].rsplit("/", 1)[-1] for one in entries if one["type"] == "directory")

    def sweep(self) -> None:
        """Remove what processes of this machine have left aside that live no more."""
        if not self._is_local:
            return
        for folder, _, names in os.walk(self._root):
            for name in names:
                if _is_abandoned(name):
                    os.unlink(os.path.join(folder, name))
        for name in os.listdir(tempfile.gettempdir()):
            if name.startswith(WORKSPACE) and _is_abandoned(name):
                shutil.rmtree(os.path.join(tempfile.gettempdir(), name), ignore_errors=True)

    @staticmethod
    def object_key(comparable: str, name: str) -> str:
        return f"objects/{comparable}/{name}{EXTENSION}"

    def names(self, comparable: str) -> Dict[str, int]:
        """Names of experiences and bytes of their objects, sorted."""
        files = self.files(f"objects/{comparable}")
        return {
            name[: -len(EXTENSION)]: size for name, size in files.items() if name.endswith(EXTENSION)
        }

    def add(self, vdna: bytes, labels: Labels) -> Tuple[str, bool]:
        """Add an experience file: its key, and whether it was not there yet.

        VdnaError: it is not valid
        """
        experience = Experience.from_bytes(vdna)
        key = self.object_key(str(experience.comparable), experience.name)
        if self.exists(key):
            return key, False
        self.put(key, pack(vdna, labels))
        return key, True

    def load(self, comparable: str, name: str) -> Stored:
        """Read an object and check every byte of it.

        DamagedObject: it is not there, or not what its key says
        """
        key = self.object_key(comparable, name)
        where = f"{self.uri}/{key}"
        try:
            data = self.get(key)
            vdna, labels = unpack(data)
            experience = Experience.from_bytes(vdna)
        except FileNotFoundError:
            raise DamagedObject(f"{where}: is not there") from None
        except (ValueError, TypeError, VdnaError, zstandard.ZstdError) as failure:
            raise DamagedObject(
                f"{where}: damaged: {failure}; remove it, and build {name} again"
            ) from None
        if (experience.comparable, experience.name) != (comparable, name):
            raise DamagedObject(
                f"{where}: holds {experience.name} of comparable {experience.comparable},"
                " expected what its path says; move it there"
            )
        return Stored(experience, labels, vdna, len(data))

    def only_comparable(self, given: Optional[str] = None) -> str:
        """The one comparable of the collection, or the one that `given` begins.

        ValueError: none, or several
        """
        found = [one for one in self.comparables() if one.startswith(given or "")]
        if len(found) != 1:
            listed = ", ".join(one[:12] for one in found) or "none"
            raise ValueError(
                f"{self.uri}: {listed} comparable, expected one: "
                + ("choose by --comparable" if found else "add experiences by vdna-fleet build")
            )
        return found[0]


@contextlib.contextmanager
def writing_local(path: str) -> Iterator[Any]:
    """The same for a local file: written aside, under a name that no one else has, and renamed."""
    os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
    aside = f"{path}.{aside_name()}"
    try:
        with open(aside, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(aside)
        raise


def aside_name() -> str:
    """The end of a name that no one else has; Collection.sweep() knows from it who made it."""
    return f"aside-{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex}"


def _is_abandoned(name: str) -> bool:
    aside = _ASIDE.search(name)
    return bool(aside and aside["host"] == socket.gethostname() and not _lives(int(aside["pid"])))


def _lives(pid: int) -> bool:
    """Not if only its exit status is left, which nobody fetches in a container without an init."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    with contextlib.suppress(OSError):
        with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    return True


def batches(items: List[Any], size: int) -> Iterator[List[Any]]:
    """The items, `size` at a time."""
    for begin in range(0, len(items), size):
        yield items[begin : begin + size]
