"""Experience files: opening one checks every byte of it, saving one waits for the disk."""
import time

import numpy as np

from group_core import random_dna
from measure import compare

LIVE, MAP = 100, 1150  # frames


def run(context):
    """All of the group."""
    from libvdna import Experience, HistogramView
    for neurons, dim in [(16, 8)] if context.tiny else [(128, 128), (768, 768)]:
        random = np.random.default_rng(4)
        experience = Experience(
            name="bench", backbone="bench", model_sha256="0" * 64, preprocessing="none",
            taps=f"bench:{neurons}:1",
            histogram=HistogramView(np.tile(np.float32([0, 1]), (neurons, 1)),
                                    random_dna(neurons, MAP, 1)),
            embeddings=random.normal(size=(MAP, dim)).astype(np.float32),
            frame_utime=np.arange(MAP, dtype=np.int64), frame_grey=np.zeros(MAP, np.float32))
        path = context.scene.folder / "bench.vdna"
        experience.write(path)
        more = {"mib": path.stat().st_size / 2**20}
        name = f"experience of {neurons} neurons, {MAP} frames"
        data = path.read_bytes()
        yield (f"load {name}", "ms", 1e3,
               compare(lambda: Experience.open(path), {"reading the file": path.read_bytes},
                       context.seconds), more)

        def save_plainly():
            plain = path.with_suffix(".plain")
            plain.write_bytes(data)

        yield (f"save {name}", "ms", 1e3,
               compare(lambda: experience.write(path), {"writing the file, unsafely": save_plainly},
                       context.seconds, clock=time.perf_counter), more)
