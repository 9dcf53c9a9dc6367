"""Allocations of a running program by caller: reads the counts of allocations.c.

VDNA_ALLOCATION_COUNTER is the library to preload into a program.
"""
import glob
import os
import struct

OBJECTS, NAME = 512, 120


class Allocations:
    """The counts of a program that is started with `environment`, and of those that it starts."""

    def __init__(self, path):
        for old in glob.glob(f"{path}.*"):
            os.unlink(old)
        self._path = path
        self.environment = {"LD_PRELOAD": os.environ["VDNA_ALLOCATION_COUNTER"],
                            "VDNA_ALLOCATIONS": path}

    def read(self, pid=None):
        """Bytes allocated and not freed, and calls by the name of the object that asked, in one
        process, or in the only one."""
        path, = glob.glob(f"{self._path}.{pid or '*'}")
        with open(path, "rb") as file:
            data = file.read()
        live_bytes, = struct.unpack_from("<q", data)
        calls = {}
        for name, count in struct.iter_unpack(f"<{NAME}sQ", data[8:8 + OBJECTS * (NAME + 8)]):
            if count:
                name = name.split(b"\0")[0].decode()
                calls[name] = calls.get(name, 0) + count
        return live_bytes, calls
