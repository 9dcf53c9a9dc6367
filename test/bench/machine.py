"""The circumstances of a measurement: the machine, the state of the project, all versions, and the
load of the machine."""
import datetime
import importlib.metadata
import os
import platform
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PEERS = ("torch", "torchvision", "vdna", "faiss-cpu", "POT", "scipy")


def cpu_model():
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    found = re.search(r"^(?:model name|Model|Hardware)\s*:\s*(.+)$", text, re.M)
    return found[1] if found else platform.machine()


def describe():
    """The machine."""
    flags = re.search(r"^(?:flags|Features)\s*:\s*(.+)$",
                      Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    wide = [name for name in ("avx2", "avx512f", "avx512_vnni", "avx_vnni", "asimd", "asimddp")
            if flags and name in flags[1].split()]
    memory = re.search(r"MemTotal:\s+(\d+)", Path("/proc/meminfo").read_text(encoding="utf-8"))
    return {"cpu": cpu_model(), "cores": os.cpu_count(), "features": wide,
            "memory_mb": int(memory[1]) // 1024, "system": pretty_name()}


def pretty_name():
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.system()


def file_name():
    """A name for this kind of machine."""
    text = f"{cpu_model()}-{os.cpu_count()}-cores".lower()
    return re.sub(r"[^a-z0-9]+", "-", text).strip("-") + ".json"


def commit():
    """The commit, with a + if the tree differs from it; "" outside a repository."""
    def git(*arguments):
        return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True,
                              text=True).stdout.strip()
    changed = git("status", "--porcelain", "--untracked-files=no", "--", "lib", "apps")
    return git("rev-parse", "--short=12", "HEAD") + ("+" if changed else "")


def versions(vdna):
    """Versions of ours, Python, NumPy and the peers that are here."""
    found = {"vdna": vdna.__version__, "python": platform.python_version()}
    for name in ("numpy", *PEERS):
        try:
            key = "vdna (package)" if name == "vdna" else name
            found[key] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            pass
    return found


def load():
    """Mean number of processes that ran or waited, over the last minute."""
    return round(os.getloadavg()[0], 1)


def now():
    return datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")


def pin():
    """Keep this process and its children on two cores."""
    cores = sorted(os.sched_getaffinity(0))[:2]
    os.sched_setaffinity(0, cores)
    return cores
