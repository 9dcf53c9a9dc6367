"""ONNX Runtime alone, in a process of its own (bare_onnx.c)."""
import os
import re
import subprocess
import tomllib
from pathlib import Path

from ends_with_us import ENDS_WITH_US
from measure import waited


def peak_bytes(process):
    """The peak memory of a process."""
    text = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    return int(re.search(r"VmHWM:\s+(\d+) kB", text)[1]) * 1024


def resident_bytes(process):
    """The memory of a process."""
    text = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    return int(re.search(r"VmRSS:\s+(\d+) kB", text)[1]) * 1024


# glibc's own threshold moves, and with it the peak of the very same run; this is its initial value,
# which the daemon also sets.
STEADY = {"MALLOC_MMAP_THRESHOLD_": str(128 << 10)}


class Bare:
    """A session with the model of a manifest, on two threads."""

    def __init__(self, build, manifest, threads=2):
        settings = tomllib.loads(Path(manifest).read_text(encoding="utf-8"))
        outputs = [settings["embedding"]["output"], *(tap["output"] for tap in settings["taps"])]
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, build / "test" / "bench" / "bare_onnx", runtime_of(build),
             Path(manifest).parent / settings["model"], str(threads), *dict.fromkeys(outputs)],
            env={**os.environ, **STEADY}, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    @property
    def pid(self):
        return self._process.pid

    def run(self, count):
        """[(seconds of an inference, share of the time that it waited for a processor)]"""
        before = waited(self.pid)
        self._process.stdin.write(f"{count}\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("bare_onnx has ended")
        took = [float(text) for text in line.split()]
        share = (waited(self.pid) - before) / sum(took)
        return [(seconds, share) for seconds in took]


def configured(build, name):
    """The value that a build was configured with; "" if there is none."""
    found = re.search(rf"^{name}:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M)
    return found[1] if found else ""


def runtime_of(build):
    """The libonnxruntime.so that the programs of this build load."""
    return configured(build, "ONNXRUNTIME_LIBRARY")
