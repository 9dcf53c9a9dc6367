"""Growth of the memory of a selector and of its map with the experiences and their sizes. Machines
differ only in their page size, to which a map is rounded."""
import ctypes

import numpy as np

from group_core import random_dna
from group_growth import grown

USUAL = {"experiences": 4, "neurons": 128, "bins": 1000, "frames": 1000, "dim": 128}


def run(context):
    """All of the group."""
    path = context.scene.folder / "sizes.vdna"
    for size, values in (("experiences", (4, 8, 16, 32, 64, 128)),
                         ("neurons", (128, 256, 512, 1024, 2048)),
                         ("bins", (250, 500, 1000, 2000, 4000)),
                         ("frames", (1000, 2000, 4000, 8000, 16000))):
        values = values[:2] if context.tiny else values
        taken = [sizes(path, **{**USUAL, size: value}) for value in values]
        for what, held in zip(("the selector", "the map"), zip(*taken)):
            yield grown(f"memory of {what}, by {size}", "MiB", 1 / 2**20, zip(values, held),
                        {"usual": USUAL})


def sizes(path, experiences, neurons, bins, frames, dim):
    """Bytes of a selector, and mapped bytes of its map."""
    from libvdna import Experience
    write(path, neurons, bins, frames, dim)
    opened = [Experience.open(path) for _ in range(experiences)]
    return selector_bytes(opened), mapped_bytes(path)


def write(path, neurons, bins, frames, dim):
    """An experience with random counts."""
    from libvdna import Experience, HistogramView
    Experience(
        name="sizes", backbone="sizes", model_sha256="0" * 64, preprocessing="none",
        taps=f"sizes:{neurons}:1",
        histogram=HistogramView(np.tile(np.float32([0, 1]), (neurons, 1)),
                                random_dna(neurons, frames, 1, bins)),
        embeddings=np.zeros((frames, dim), np.float32),
        frame_utime=np.arange(frames, dtype=np.int64), frame_grey=np.zeros(frames, np.float32),
    ).write(path)


def selector_bytes(experiences):
    """The library's statement of the memory of a selector among them."""
    from libvdna._library import SelectCandidate, SelectConfig, lib
    candidates = (SelectCandidate * len(experiences))()
    for experience, candidate in zip(experiences, candidates):
        candidate.dna = experience.histogram._view
        candidate.embeddings = experience.embeddings.ctypes.data
        candidate.frames = len(experience.embeddings)
    config = SelectConfig()
    lib.vdna_select_config_init_sized(config, ctypes.sizeof(config))
    config.candidates, config.candidate_count = candidates, len(candidates)
    config.dim, config.warmup_frames = experiences[0].dim, 1
    return lib.vdna_select_mem_size(config)


def mapped_bytes(path):
    """Bytes of a file mapped into this process, all mappings together."""
    with open("/proc/self/maps", encoding="utf-8") as maps:
        ranges = [line.split()[0].split("-") for line in maps if line.rstrip().endswith(f" {path}")]
    return sum(int(end, 16) - int(begin, 16) for begin, end in ranges)
