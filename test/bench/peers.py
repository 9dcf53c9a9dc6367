"""The peers: third-party packages in a virtual environment, build/peers, made on request."""
import os
import subprocess
import sys
from pathlib import Path

PACKAGES = ("torch", "torchvision", "vdna", "faiss-cpu", "POT", "scipy")


def enter(build, make):
    """Restart the script in the peers' environment if it exists; `make` it first if asked."""
    folder = build / "peers"
    python = folder / "bin" / "python3"
    if Path(sys.prefix).resolve() == folder.resolve():
        return
    if make and not python.exists():
        subprocess.run(["/usr/bin/python3", "-m", "venv", folder], check=True)
        subprocess.run([folder / "bin" / "pip", "install", "--quiet", *PACKAGES], check=True)
    if python.exists():
        sys.stdout.flush()
        os.execv(python, [str(python), *sys.argv])


class Peers:
    """The installed packages, on one thread; None for each one missing."""

    def __init__(self):
        self.torch = imported("torch")
        self.faiss = imported("faiss")
        self.ot = imported("ot")
        self.scipy_stats = imported("scipy.stats")
        self.scipy_linalg = imported("scipy.linalg")
        self.package = imported("vdna.utils.stats")
        self.cv2 = imported("cv2")
        self.pillow = imported("PIL.Image")
        if self.torch:
            self.torch.set_num_threads(1)
        if self.faiss:
            self.faiss.omp_set_num_threads(1)


def imported(name):
    try:
        __import__(name)
    except ImportError:
        return None
    return sys.modules[name]
