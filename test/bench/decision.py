"""From the first picture to the published choice, with and without waiting for the whole warmup:
drives through rendered worlds past the real daemon, whose maps have three other conditions."""
import json
import statistics

import numpy as np

from drive import Answers, Drive
from selectord import Camera, Selectord

PAPER_FRAMES = 100  # of its warmup
MAP = (0, 1, 3)  # conditions of a map, counted from one of them
TOLERANCE = 5  # metres
AS_GOOD = 1  # percent of the frames, by which another choice may be worse


def decision(context, name, manifest, precision):
    """Choices that settle, beside those after the paper's warmup."""
    frames = 20 if context.tiny else PAPER_FRAMES
    drives = [drive(context, manifest, frames, *which) for which in drives_of(context, manifest)]
    early = [settled["seconds"] for settled, _ in drives]

    def mean(value):
        return statistics.fmean(value(*drive) for drive in drives)

    timed = {"median": statistics.median(early), "least": min(early), "most": max(early),
             "rounds": len(drives), "waited": 0,
             "peers": {f"all {frames} frames": {
                 "median": statistics.median(whole["seconds"] for _, whole in drives),
                 "speedup": statistics.median(whole["seconds"] / settled["seconds"]
                                              for settled, whole in drives)}}}
    more = {"drives": len(drives),
            "frames": statistics.median(settled["frames"] for settled, _ in drives),
            "frames_percent": mean(lambda settled, _: 100 * settled["frames"] / frames),
            "time_percent": mean(lambda settled, whole:
                                 100 * settled["seconds"] / whole["seconds"]),
            "same_choice_percent": mean(lambda settled, whole:
                                        100 * (settled["choice"] == whole["choice"])),
            "as_good_percent": mean(lambda settled, whole:
                                    100 * (settled["recall"] >= whole["recall"] - AS_GOOD)),
            "recall": mean(lambda settled, _: settled["recall"]),
            "recall_of_whole": mean(lambda _, whole: whole["recall"])}
    return f"decision {name} {precision}", "s", 1, timed, more


def drives_of(context, manifest):
    """(map of a whole world, that of three conditions, a recording in another), in some worlds"""
    scene = context.scene
    for seed in (41,) if context.tiny else (41, 42) if context.quick else (41, 42, 43, 44):
        world = scene.world(seed, 30, "160x120") if context.tiny else scene.world(seed, 240)
        whole = scene.world_map(world, manifest)
        for first in (0,) if context.tiny else range(0, len(world), 2 if context.quick else 1):
            kept = [world[(first + step) % len(world)] for step in MAP]
            part = scene.part_of_map(whole, [path.name for path in kept])
            for live in [path for path in world if path not in kept][:1 if context.tiny else None]:
                yield whole, part, live


def drive(context, manifest, frames, whole, part, live):
    """The choice as soon as it has settled, and after all frames of the warmup."""
    pictures = [file.read_bytes() for file in sorted(live.glob("*.jpg"))]
    both = [choose(context, manifest, part, pictures, frames, stop_early)
            for stop_early in (True, False)]
    for chosen in both:
        chosen["recall"] = recall(whole, live.name, chosen["choice"], frames)
    return both


def choose(context, manifest, folder, pictures, warmup, stop_early):
    """Drive until the choice: a picture that is of no use, a dark one say, does not count."""
    settings, log = context.scene.folder / "decision.toml", context.scene.folder / "decision.json"
    settings.write_text(f"[select]\nstop_early = {str(stop_early).lower()}\n", encoding="ascii")
    log.unlink(missing_ok=True)
    with Answers() as answers, Camera() as camera, \
            Selectord("--map", folder, "--backbone", manifest, "--warmup-frames", warmup,
                      "-c", settings, "--answers", log) as daemon:
        course = Drive(camera, answers, daemon)
        for utime, picture in enumerate(pictures):
            course.ask(utime, picture)
            if course.asked[-1][1]:
                break
    *before, (_, ranked, _) = course.asked
    said = map(json.loads, log.read_text(encoding="utf-8").splitlines())
    ranking = next(message for message in said if message["type"] == "ranking")
    return {"frames": len(course.asked), "seconds": sum(frame[0] for frame in before) + ranked,
            "choice": ranking["ranking"][0]["experience"]}


def recall(folder, live, chosen, warmup):
    """Percent of the frames after the warmup whose nearest frame is the same place."""
    from libvdna import Experience
    of_live, of_map = (Experience.open(folder / f"{name}.vdna") for name in (live, chosen))
    a, b = (experience.embeddings - experience.embeddings.mean(axis=0)
            for experience in (of_live, of_map))
    b /= np.linalg.norm(b, axis=1, keepdims=True)
    nearest = np.argmax(a[warmup:] @ b.T, axis=1)
    apart = of_live.frame_position[warmup:] - of_map.frame_position[nearest]
    return 100 * np.mean(np.linalg.norm(apart[:, :2], axis=1) <= TOLERANCE)
