"""Where a frame's processor time goes: the daemon's two processes beside ONNX Runtime alone, taking
turns, while a warmup lasts and after it."""
import statistics
from time import process_time

import numpy as np

from bare import Bare
from drive import Answers, Drive
from measure import ran, seconds_of
from selectord import Camera, Selectord, Watch

NETWORK = "efficientnet_lite0"
CANDIDATES = 8
LEAD = 4  # frames before the first that is measured
BLOCK = 4  # frames before the peer gets its turn
ALONE = ("decode", "resize", "select", "publish")  # stages of one thread: their time is processor time


def run(context):
    """All of the group."""
    for precision in ["fp32"] if context.tiny else ["fp32", "int8"]:
        for phase in "warmup", "choice made":
            yield stages(context, precision, phase)


def stages(context, precision, phase):
    """Processor time of a frame by stage."""
    frames = 8 if context.tiny else 40 if context.quick else 96
    scene, is_int8 = context.scene, precision == "int8"
    manifest = scene.int8_manifest(NETWORK) if is_int8 else scene.manifest(NETWORK)
    pictures = [file.read_bytes() for file in scene.pictures(20 if context.tiny else 100)]
    options = ("--map", scene.map(manifest, 2 if context.tiny else CANDIDATES),
               "--backbone", manifest, "--warmup-frames", 1000 if phase == "warmup" else 2)
    blocks = []
    with Answers() as answers, Camera() as camera, Selectord(*options) as daemon, \
            Bare(context.build, manifest) as bare:
        course, processes = Drive(camera, answers, daemon), [*daemon.pids, bare.pid]
        for utime in range(LEAD):
            course.ask(utime, pictures[utime])
        bare.run(2)
        for first in range(LEAD, LEAD + frames, BLOCK):
            before = list(map(ran, processes))
            for utime in range(first, first + BLOCK):
                course.ask(utime, pictures[utime])
            bare.run(BLOCK)
            blocks.append([(ran(process) - begin) / BLOCK
                           for process, begin in zip(processes, before)])
        with Watch() as watch:
            status = watch.wait_for("status", lambda said: said["processed"] == LEAD + frames)
    return summary(f"stages {NETWORK} {precision}, {phase}", blocks,
                   {stage: status[stage]["p50_us"] / 1e6 for stage in ALONE}, parts(context))


def parts(context):
    """Seconds of what the stages have within them, measured in this process."""
    from libvdna import Histogram
    from libvdna.activations import Taps
    from group_core import BINS, activations
    frame, ranges, frames = activations(1280, 1)
    table, taps = Histogram(ranges, BINS), Taps([frame])
    noise = np.random.default_rng(3).integers(0, 256, (480, 640, 3), np.uint8).tobytes()
    works = {"counting": (lambda: context.library.hist_add(table, taps, frames), frames),
             "health": (lambda: context.library.health(noise, 640, 480), 1)}
    return {name: statistics.median(seconds_of(work, 5, process_time)[0] for _ in range(9)) / count
            for name, (work, count) in works.items()}


def summary(name, blocks, alone, within):
    """The result of the group. blocks: [(seconds of daemon, its network's process, bare)]"""
    daemon, network, bare = (statistics.median(block[i] for block in blocks) for i in range(3))
    totals = [block[0] + block[1] for block in blocks]
    total = statistics.median(totals)
    rest = daemon - alone["select"] - alone["publish"]
    seconds = {
        "receive, check and hand over": rest,
        "decode": alone["decode"] - within["health"],
        "frame health": within["health"],
        "resize and normalise": alone["resize"],
        "network": network - alone["decode"] - alone["resize"],
        "counting": within["counting"],
        "nearest neighbours": alone["select"] - within["counting"],
        "publish": alone["publish"],
    }
    more = {f"{stage}, ms": 1e3 * value for stage, value in seconds.items()}
    ratio = statistics.median((block[0] + block[1]) / block[2] for block in blocks)
    more["over ONNX Runtime alone, percent"] = 100 * (ratio - 1)
    peers = {"ONNX Runtime alone": {"median": bare, "speedup": 1 / ratio}}
    return name, "ms/frame", 1e3, {"median": total, "least": min(totals), "most": max(totals),
                                   "rounds": len(blocks), "waited": 0, "peers": peers}, more
