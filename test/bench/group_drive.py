"""End to end: pictures go to the real daemon over real LCM, beside ONNX Runtime alone in another
process and the reference package in this one; and the daemon's memory meanwhile."""
import statistics

from bare import Bare, peak_bytes, resident_bytes
from decision import decision
from drive import Answers, Drive, reset_message
from measure import calmest, ran
from package import Package
from scene import NETWORKS
from selectord import Camera, Selectord, Watch

BLOCK = 5  # frames that the daemon answers before its peer gets its turn
LEAD = 10  # frames of a warmup by which the place filters find the place before they answer
STAGES = ("queue", "decode", "resize", "inference", "select", "rank", "publish", "total")


def run(context):
    """All of the group."""
    names = ["efficientnet_lite0"] if context.tiny else list(NETWORKS)
    for precision, of in (("fp32", context.scene.manifest), ("int8", context.scene.int8_manifest)):
        if precision == "fp32" or not context.tiny:
            yield decision(context, names[0], of(names[0]), precision)
    for name in names:
        yield drive(context, name, context.scene.manifest(name), "fp32")
        # Quantising for the largest pictures takes longer than everything else.
        if not context.tiny and not (context.quick and name == "cosplace_480x640"):
            yield drive(context, name, context.scene.int8_manifest(name), "int8")
    for count, exact in [(2, 1)] if context.tiny else [(4, 0), (100, 0), (100, 5)]:
        yield last_frame(context, names[0] if context.tiny else "mugs_vitb16", count, exact)
    yield choosing_again(context, "efficientnet_lite0", 2 if context.tiny else 4)
    yield long_run(context, names[0])


def drive(context, name, manifest, precision):
    """Frames from the first message to the decision."""
    frames = 10 if context.tiny else 20 if context.quick else 100
    candidates = 2 if context.tiny else 8
    files = context.scene.pictures(frames)
    pictures = [file.read_bytes() for file in files]
    options = ("--map", context.scene.map(manifest, candidates), "--backbone", manifest,
               "--warmup-frames", frames)
    package, blocks = package_of(context, name, files), []
    with Answers() as answers, Camera() as camera, Selectord(*options) as daemon, \
            Bare(context.build, manifest) as bare:
        course = Drive(camera, answers, daemon)
        bare.run(2)
        processes = daemon.pids, [bare.pid]
        ran_before = [sum(map(ran, pids)) for pids in processes]
        for first in range(0, frames, BLOCK):
            for utime in range(first, min(first + BLOCK, frames)):
                course.ask(utime, pictures[utime])
            blocks.append((course.asked[first:], bare.run(BLOCK), package and package.seconds()))
        processor_ms = [1e3 * (sum(map(ran, pids)) - before) / frames
                        for pids, before in zip(processes, ran_before)]
        with Watch() as watch:
            status = watch.wait_for("status", lambda said: said["processed"] == frames)
        more = {"bytes": statistics.median(map(len, pictures)), "candidates": candidates,
                "memory_mib": sum(map(peak_bytes, daemon.pids)) / 2**20,
                "bare_memory_mib": peak_bytes(bare.pid) / 2**20,
                "map_mib": sum(file.stat().st_size for file in options[1].iterdir()) / 2**20,
                "processor_ms": processor_ms[0], "bare_processor_ms": processor_ms[1],
                "last_frame_to_ranking_ms": 1e3 * course.asked[-1][1],
                "stages_ms": {stage: status[stage]["p50_us"] / 1e3 for stage in STAGES}}
    timed = summary(blocks, package and package.name)
    return f"drive {name} {precision}", "s/100 frames", 100, timed, more


def summary(blocks, package=None):
    """The result of compare(), for one frame. blocks: [(the drive's result, that of bare_onnx,
    seconds of the package or None)]; package: its name"""
    peers = ["ONNX Runtime alone", *([package] if package else [])]
    per_block = [(statistics.median(frame[0] for frame in asked),
                  statistics.median(inference[0] for inference in bare), theirs,
                  max(statistics.median(frame[2] for frame in asked), bare[0][1]))
                 for asked, bare, theirs in blocks]
    used = calmest(per_block, lambda block: block[-1])
    mine = [block[0] for block in used]
    return {
        "median": statistics.median(mine), "least": min(mine), "most": max(mine),
        "rounds": len(mine), "waited": statistics.median(block[-1] for block in used),
        "peers": {name: {"median": statistics.median(block[i] for block in used),
                         "speedup": statistics.median(block[i] / block[0] for block in used)}
                  for i, name in enumerate(peers, start=1)},
    }


def package_of(context, name, files):
    """The reference package with this network at its best batch size, made once; None if it is not
    installed."""
    if not context.peers.package or (name == "efficientnet_lite0" and
                                     not context.peers.efficientnet):
        return None
    if name not in context.packages:
        context.packages[name] = Package(context.peers.torch, name, NETWORKS[name][1:], files,
                                         (1, 8) if context.quick else (1, 8, 32))
    return context.packages[name]


def last_frame(context, name, count, exact):
    """From the last frame of a warmup to the ranking: a short warmup, repeated.
    exact: places of the ranking that have a distance, not a bound; 0 = all"""
    manifest, rounds = context.scene.manifest(name), 4 if context.tiny else 10
    pictures = [file.read_bytes() for file in context.scene.pictures(10)]
    settings = context.scene.folder / f"exact-{exact}.toml"
    settings.write_text(f"[camera]\nhealth = false\n[select]\nexact_distances = {exact}\n",
                        encoding="ascii")  # the pictures come again
    options = ("--map", context.scene.map(manifest, count), "--backbone", manifest,
               "--warmup-frames", LEAD, "-c", settings)
    blocks = []
    with Answers() as answers, Camera() as camera, Camera("VDNA_COMMAND") as operator, \
            Selectord(*options) as daemon, Bare(context.build, manifest) as bare:
        course = Drive(camera, answers, daemon)
        for first in range(0, rounds * LEAD, LEAD):
            operator.send(reset_message())
            for utime in range(first, first + LEAD):
                course.ask(utime, pictures[utime % len(pictures)])
            _, ranked, wait = course.asked[-1]
            blocks.append(([(ranked, ranked, wait)], bare.run(1), None))
        with Watch() as watch:
            status = watch.wait_for("status", lambda said: said["processed"] == rounds * LEAD)
    # By the daemon's own clock, stage by stage: two inferences differ by more than the effect
    # sought here.
    stages_ms = {stage: status[stage]["p50_us"] / 1e3
                 for stage in ("queue", "decode", "resize", "rank", "publish")}
    what = f", {exact} exact" if exact else ""
    return (f"last frame {name}, K={count}{what}", "ms", 1e3, summary(blocks[2:]),
            {"beyond_inference_ms": sum(stages_ms.values()), "rank_ms": stages_ms["rank"]})


def choosing_again(context, name, count):
    """Processor time of a frame after the choice, with and without reconsidering it."""
    manifest = context.scene.manifest(name)
    frames = 5 if context.tiny else 50 if context.quick else 100
    pictures = [file.read_bytes() for file in context.scene.pictures(10 if context.tiny else 20)]
    folder = context.scene.map(manifest, count)
    spent = {"true": [], "false": []}
    for reselect in ["true", "false"] * (2 if context.tiny else 5):
        settings = context.scene.folder / f"reselect-{reselect}.toml"
        settings.write_text(f"[camera]\nhealth = false\n[select]\nreselect = {reselect}\n",
                            encoding="ascii")  # the pictures come again
        options = ("--map", folder, "--backbone", manifest, "--warmup-frames", 2, "-c", settings)
        with Answers() as answers, Camera() as camera, Selectord(*options) as daemon:
            course = Drive(camera, answers, daemon)
            for utime in range(5):  # the choice, and whatever the first frames take
                course.ask(utime, pictures[utime])
            before = sum(map(ran, daemon.pids))
            for utime in range(5, 5 + frames):
                course.ask(utime, pictures[utime % len(pictures)])
            spent[reselect].append((sum(map(ran, daemon.pids)) - before) / frames)
    again, single = (statistics.median(spent[reselect]) for reselect in ("true", "false"))
    timed = {"median": again, "least": min(spent["true"]), "most": max(spent["true"]),
             "rounds": len(spent["true"]), "peers": {}, "waited": 0}
    return (f"choosing again {name}, K={count}", "ms/frame", 1e3, timed,
            {"single_ms": 1e3 * single, "over_single_percent": 100 * (again / single - 1)})


def long_run(context, name):
    """The daemon's memory over a long run of frames."""
    manifest = context.scene.manifest(name)
    frames = 40 if context.tiny else 1000 if context.quick else 10000
    pictures = [file.read_bytes() for file in context.scene.pictures(10 if context.tiny else 20)]
    options = ("--map", context.scene.map(manifest, 2), "--backbone", manifest,
               "--warmup-frames", 10)
    points = []
    with Answers() as answers, Camera() as camera, Selectord(*options) as daemon:
        course = Drive(camera, answers, daemon)
        for utime in range(frames):
            if utime % (frames // 40) == 0:
                points.append((utime, sum(map(resident_bytes, daemon.pids)) / 2**20))
            course.ask(utime, pictures[utime % len(pictures)])
        points.append((frames, sum(map(resident_bytes, daemon.pids)) / 2**20))
    took = sorted(frame[0] for frame in course.asked)
    median = statistics.median(took)
    timed = {"median": median, "least": took[0], "most": took[-1], "rounds": frames, "peers": {},
             "waited": statistics.median(frame[2] for frame in course.asked)}
    return f"long run {name}", "ms/frame", 1e3, timed, {"memory_mib_by_frame": points}
