"""Adding a short drive to maps of more and more experiences: `vdna build`, in processor time. Without
trust.safetensors it is to cost what it costs in a small map; that file needs a row and a column."""
import hashlib
import itertools
import resource
import shutil
import subprocess

import numpy as np

from measure import compare

FRAMES, BINS = 20, 100  # of each experience; few bins, so that the maps are no gigabytes
LABELS = {True: ", with trust", False: ""}


def run(context):
    """All of the group."""
    counts = (2, 3) if context.tiny else (2, 100, 600)
    maps = {count: map_of(context, count) for count in counts}
    for trust in (False, True):
        least = compare(adding(context, maps[2], trust), {}, context.seconds, clock=children)
        yield (f"add to a map of 2{LABELS[trust]}", "ms", 1e3, least, {})
        for count in counts[1:]:
            timed = compare(adding(context, maps[count], trust),
                            {"a map of 2": adding(context, maps[2], trust)}, context.seconds,
                            clock=children)
            [peer] = timed["peers"].values()
            each = (timed["median"] - peer["median"]) / (count - 2)
            yield (f"add to a map of {count}{LABELS[trust]}", "ms", 1e3, timed,
                   {"ms_per_experience": 1e3 * each})


def children():
    """Processor seconds of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def vdna(context, *arguments):
    subprocess.run([context.build / "bin" / "vdna", *map(str, arguments)], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def adding(context, folder, trust):
    """Replaces one experience of a map by another, time and again."""
    drives = itertools.cycle(context.scene.pictures(frames)[0].parent
                             for frames in (FRAMES, FRAMES + 1))

    def work():
        vdna(context, "build", "--force", "--name", "added", *([] if trust else ["--no-trust"]),
             folder, next(drives))
    return work


def map_of(context, count):
    """A map of `count` experiences that differ in their names, which knows itself."""
    manifest = context.scene.manifest("efficientnet_lite0")
    version = hashlib.sha256(manifest.read_bytes()).hexdigest()[:8]
    folder = context.scene.folder / "maps" / f"add-{version}-{count}"
    if not folder.exists():
        seed, part = (folder.with_suffix(end) for end in (".seed", ".part"))
        for path in (seed, part):
            shutil.rmtree(path, ignore_errors=True)
        part.mkdir(parents=True)
        vdna(context, "build", seed, "--backbone", manifest, "--bins", BINS, "--name", "seed",
             context.scene.pictures(FRAMES)[0].parent)
        write_renamed(seed / "seed.vdna", part, count)
        shutil.rmtree(seed)
        part.rename(folder)
    return folder


def write_renamed(path, folder, count):
    """Copies of an experience under other names, and what a map of them could know about itself."""
    from libvdna import Experience, MapTrust, TrustTables
    seed = Experience.open(path)
    copies = []
    for number in range(count):
        name = f"copy{number:03}"
        Experience(
            name=name, backbone=seed.backbone, model_sha256=seed.model_sha256,
            preprocessing=seed.preprocessing, precision=seed.precision, taps=seed.taps,
            histogram=seed.histogram, embeddings=seed.embeddings,
            embedding=seed.identity.embedding, last_layer=seed.last_layer,
            frame_utime=seed.frame_utime, frame_grey=seed.frame_grey,
            frame_position=seed.frame_position, position_frame=seed.position_frame,
        ).write(folder / f"{name}.vdna")
        copies.append(Experience.open(folder / f"{name}.vdna"))
    frames = np.full(count, seed.frames, np.uint32)
    MapTrust(TrustTables(frames, np.ones(count), np.ones(count), np.ones((count, count, 4, 7))), 5.0,
             True).write(folder, copies)
