"""The inputs of a drive, made once in build/bench and reused: pictures, networks, maps."""
import hashlib
import shutil
import subprocess
from pathlib import Path

import numpy as np

from bare import configured

ROOT = Path(__file__).resolve().parents[2]
MAP_FRAMES = 1150
CHANGE = 0.8  # of the deviation over a drive
CALIBRATION = 40  # pictures for int8
CONDITIONS = ("spring", "summer", "autumn", "winter", "overcast", "rain", "dusk", "night")

# name -> arguments of networks.py (None: it comes with the project), input height and width
NETWORKS = {
    "efficientnet_lite0": (None, 224, 224),
    "mobilenet_v2": (None, 224, 224),
    "cosplace_224": (("cosplace", "cosplace_resnet101_128"), 224, 224),
    "mugs_vitb16": (("vit", "mugs_vitb16"), 224, 224),
    "cosplace_480x640": (("cosplace", "cosplace_resnet101_128"), 480, 640),
}


class Scene:
    """A folder with everything."""

    def __init__(self, build):
        self._build, self.folder = build, build / "bench"
        self.folder.mkdir(exist_ok=True)

    def _vdna(self, *arguments):
        subprocess.run([self._build / "bin" / "vdna", *map(str, arguments)], check=True,
                       stdout=subprocess.DEVNULL)

    def pictures(self, count, size="640x480"):
        """Paths of JPEG pictures, each small enough for one datagram."""
        folder = self.folder / f"pictures-{count}-{size}"
        if not folder.exists():
            part = folder.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            self._vdna("simulate", part, "--size", size, "--quality", 85,
                       "--frames", count)
            part.rename(folder)
        return sorted(folder.glob("*.jpg"))

    def manifest(self, name):
        """The manifest of a network, made if need be."""
        made_of, height, width = NETWORKS[name]
        if not made_of:
            return Path(configured(self._build, "VDNA_DEPS"), "models") / f"{name}.toml"
        path = self.folder / "networks" / f"{name}.toml"
        if not path.exists():
            print(f"making {name} with random weights ...", flush=True)
            subprocess.run(["/usr/bin/python3", ROOT / "test" / "bench" / "networks.py",
                            path.parent, name, *made_of, str(height), str(width)], check=True)
        return path

    def int8_manifest(self, name):
        """The same network quantised."""
        path = self.folder / "networks" / f"{name}_int8.toml"
        if not path.exists():
            print(f"quantising {name} ...", flush=True)
            path.parent.mkdir(exist_ok=True)
            subprocess.run(["/usr/bin/python3", ROOT / "models" / "quantise.py",
                            self.manifest(name), "--out", path,
                            "--pictures", self.pictures(CALIBRATION)[0].parent,
                            "--vdna", self._build / "bin" / "vdna"], check=True)
        return path

    def map(self, manifest, count):
        """A map of drives along the route of the pictures, of MAP_FRAMES frames each, which look ever
        less like it."""
        version = hashlib.sha256(manifest.read_bytes()).hexdigest()[:8]
        folder = self.folder / "maps" / f"{manifest.stem}-{version}-{count}-looks"
        if not folder.exists():
            seed, part = (folder.with_suffix(end) for end in (".seed", ".part"))
            for path in (seed, part):
                shutil.rmtree(path, ignore_errors=True)
            self._vdna("build", seed, "--backbone", manifest, self.pictures(20)[0].parent)
            part.mkdir(parents=True)
            write_copies(next(seed.glob("*.vdna")), part, count)
            shutil.rmtree(seed)
            part.rename(folder)
        return folder

    def world(self, seed, frames, size="640x480"):
        """The recordings of one route, each in another condition and on another day: the worlds of
        docs/concepts/localisation.md in larger pictures, each small enough for one datagram."""
        folder = self.folder / "worlds" / f"{seed}-{frames}-{size}"
        if not folder.exists():
            part = folder.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir(parents=True)
            for number, condition in enumerate(CONDITIONS, start=1):
                self._vdna("simulate", part / condition, "--condition", condition, "--seed", seed,
                           "--frames", frames, "--step", 0.7, "--size", size,
                           "--quality", 60, "--variation", 0.6, "--drive", 100 * seed + number)
            part.rename(folder)
        return [folder / condition for condition in CONDITIONS]

    def world_map(self, world, manifest):
        """The map of all recordings of a world."""
        folder = self._map_folder(f"world-{world[0].parent.name}", manifest)
        if not folder.exists():
            part = folder.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            self._vdna("build", part, "--backbone", manifest, *world)
            part.rename(folder)
        return folder

    def part_of_map(self, whole, names):
        """A map of some of a map's experiences."""
        folder = whole.with_name("-".join([whole.name, *names]))
        if not folder.exists():
            part = folder.with_suffix(".part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir()
            for name in names:
                shutil.copy(whole / f"{name}.vdna", part)
            self._vdna("calibrate", "--trust", part)
            part.rename(folder)
        return folder

    def _map_folder(self, name, manifest):
        version = hashlib.sha256(manifest.read_bytes()).hexdigest()[:8]
        return self.folder / "maps" / f"{name}-{manifest.stem}-{version}"


def drive_along(frames, random, count=MAP_FRAMES):
    """`count` embeddings of a drive past the places of `frames`, each changed at random: the
    nearest is three quarters as far away as most, as in another season."""
    at = np.linspace(0, len(frames) - 1, count)
    before = np.minimum(at.astype(int), len(frames) - 2)
    share = (at - before)[:, None]
    places = (1 - share) * frames[before] + share * frames[before + 1]
    change = CHANGE * random.normal(size=places.shape) * frames.std(axis=0)
    return (places + change).astype(np.float32)


def moved(counts, bins):
    """Counts [bins][neurons], those of each neuron moved by so many bins, round the ends."""
    rows = (np.arange(len(counts))[:, None] - bins) % len(counts)
    return np.ascontiguousarray(np.take_along_axis(counts, rows, axis=0))


def write_copies(path, folder, count):
    """Drives like the one in `path`. The counts of a neuron are moved, the farther the later the
    copy."""
    from group_core import random_dna
    from libvdna import Experience, HistogramView
    seed = Experience.open(path)
    random = np.random.default_rng(2)
    masses = seed.histogram.mass // seed.frames  # samples of a frame
    whole, rest = divmod(MAP_FRAMES, seed.frames)
    base = seed.histogram.counts * np.uint32(whole)
    base += random_dna(seed.histogram.neurons, rest, 0) * masses.astype(np.uint32)
    for number in range(count):
        counts = moved(base, random.normal(0, 10 + 2 * number, base.shape[1]).astype(int))
        embeddings = drive_along(np.asarray(seed.embeddings), random)
        last_layer = None
        if seed.last_layer is not None:
            last_layer = drive_along(np.asarray(seed.last_layer), random)
        Experience(
            name=f"copy{number}", backbone=seed.backbone, model_sha256=seed.model_sha256,
            preprocessing=seed.preprocessing, precision=seed.precision, taps=seed.taps,
            histogram=HistogramView(seed.histogram.range, counts), embeddings=embeddings,
            embedding=seed.identity.embedding, last_layer=last_layer,
            frame_utime=np.arange(MAP_FRAMES, dtype=np.int64),
            frame_grey=np.zeros(MAP_FRAMES, np.float32),
        ).write(folder / f"copy{number:03}.vdna")
