"""One picture through lib/backbone, in this process: the time on top of the inference, what of it
frame health takes, and what decoding a JPEG no larger than needed saves."""
import io
import re
import statistics
import time

import numpy as np

from measure import LEAST_ROUNDS, calmest, compare, seconds_of, waited

RGB3 = int.from_bytes(b"RGB3", "little")
NETWORK = "efficientnet_lite0"
SIDE = 224  # of its input


def run(context):
    """All of the group."""
    if not context.library.has_backbone:
        return
    jpeg = context.scene.pictures(3)[0].read_bytes()
    manifest = context.scene.manifest(NETWORK)
    yield whole(context, manifest, "JPEG 640x480", (jpeg,))
    yield whole(context, manifest, "raw 640x480", (noise(640, 480).tobytes(), 640, 480, RGB3))
    for width, height in (640, 480), (1920, 1080):
        yield reduced(context, width, height)
    for width, height in (224, 224), (640, 480):
        yield health(context, width, height)
    for width, height in [(640, 480)] if context.quick else [(640, 480), (1280, 720)]:
        for rule in ("area", "linear", "pillow_bicubic"):
            yield resize(context, resizing_by(context, manifest, rule), rule, width, height)


def noise(width, height):
    return np.random.default_rng(3).integers(0, 256, (height, width, 3), np.uint8)


def rounds_of(context):
    return LEAST_ROUNDS if context.tiny else 60 if context.quick else 300


def whole(context, manifest, name, picture):
    """A picture's way to activations, without the network."""
    backbone = context.library.open_backbone(manifest, 2)
    took = []
    for _ in range(rounds_of(context)):
        before, begin = waited(), time.perf_counter()
        decode, resize_us, inference = backbone.run(*picture)
        seconds = time.perf_counter() - begin
        took.append((seconds - inference / 1e6, decode / 1e3, resize_us / 1e3, inference / 1e3,
                     (waited() - before) / seconds))
    backbone.close()
    used = calmest(took, lambda frame: frame[4])
    stages = {f"{stage}_ms": statistics.median(frame[i] for frame in used)
              for i, stage in ((1, "decode"), (2, "resize"), (3, "inference"))}
    return f"frame {name}", "ms", 1e3, summary([frame[:1] for frame in used], used, []), stages


def reduced(context, width, height):
    """Decoding a JPEG no larger than needed and resizing it, beside decoding it in full."""
    jpeg = context.scene.pictures(3, f"{width}x{height}")[0].read_bytes()
    ours, full = (context.library.preparation(SIDE, how) for how in (True, False))
    peers = {"decoding in full": lambda: full(jpeg), **reducers(context, jpeg)}
    timed = compare(lambda: ours(jpeg), peers, context.seconds)
    return f"JPEG {width}x{height} reduced", "ms", 1e3, timed, {}


def reducers(context, jpeg):
    """Other libraries that do so."""
    works = {}
    if context.peers.pillow:
        image = context.peers.pillow

        def drafted():
            picture = image.open(io.BytesIO(jpeg))
            picture.draft("RGB", (SIDE, SIDE))
            return picture.resize((SIDE, SIDE), image.Resampling.BOX)
        works["Pillow's draft and resize"] = drafted
    if context.peers.cv2:
        cv2, data = context.peers.cv2, np.frombuffer(jpeg, np.uint8)
        cv2.setNumThreads(1)
        shorter = min(cv2.imdecode(data, cv2.IMREAD_COLOR).shape[:2])
        flag = cv2.IMREAD_REDUCED_COLOR_4 if shorter >= 4 * SIDE else cv2.IMREAD_REDUCED_COLOR_2
        works["OpenCV's IMREAD_REDUCED and resize"] = lambda: cv2.resize(
            cv2.imdecode(data, flag), (SIDE, SIDE), interpolation=cv2.INTER_AREA)
    return works


def health(context, width, height):
    """Measuring and judging a decoded picture, beside decoding one of its size."""
    library, rgb = context.library, noise(width, height).tobytes()
    decode = library.decoder()
    jpeg = context.scene.pictures(3, f"{width}x{height}")[0].read_bytes()
    timed = compare(lambda: library.health(rgb, width, height),
                    {"decoding a JPEG": lambda: decode(jpeg)}, context.seconds)
    return f"health {width}x{height}", "us", 1e6, timed, {}


def resizing_by(context, manifest, rule):
    """The manifest with another interpolation, which its known numbers would refuse."""
    text = manifest.read_text(encoding="utf-8").partition("\n[golden]")[0]
    text = re.sub(r'^interpolation = "\w+"', f'interpolation = "{rule}"', text, flags=re.M)
    text = re.sub(r'^model = "', f'model = "{manifest.parent}/', text, flags=re.M)
    path = context.scene.folder / f"{rule}.toml"
    path.write_text(text, encoding="utf-8")
    return path


def resize(context, manifest, rule, width, height):
    """Resizing and normalising, which the library times itself, beside peers."""
    pixels = noise(width, height)
    raw, peers = pixels.tobytes(), resizers(context, pixels, rule)
    backbone = context.library.open_backbone(manifest, 1)
    rounds = []
    for _ in range(rounds_of(context)):
        before, begin = waited(), time.perf_counter()
        mine = backbone.run(raw, width, height, RGB3)[1] / 1e6
        wait = (waited() - before) / (time.perf_counter() - begin)
        rounds.append((mine, *(seconds_of(work, 1, time.process_time)[0]
                               for work in peers.values()), wait))
    backbone.close()
    used = calmest(rounds, lambda numbers: numbers[-1])
    return (f"resize {width}x{height} to {SIDE}x{SIDE}, {rule}", "ms", 1e3,
            summary([numbers[:-1] for numbers in used], used, peers), {})


def resizers(context, pixels, rule):
    """Other libraries with the same result."""
    works = {}
    if context.peers.cv2:
        cv2 = context.peers.cv2
        cv2.setNumThreads(1)
        how = {"area": cv2.INTER_AREA, "linear": cv2.INTER_LINEAR}.get(rule, cv2.INTER_CUBIC)
        works["OpenCV's resize alone"] = lambda: cv2.resize(pixels, (SIDE, SIDE), interpolation=how)
    if context.peers.package and rule == "pillow_bicubic":
        from vdna.utils.im import ResizeDataset
        dataset = ResizeDataset(images=[pixels], size=(SIDE, SIDE), norm_mean=[0.5] * 3,
                                norm_std=[0.5] * 3)
        works["vdna package"] = lambda: dataset[0]
    return works


def summary(rounds, used, peers):
    """The result of compare(). rounds: [(ours, each peer)]; used: the same, with the wait at the
    end"""
    mine = [numbers[0] for numbers in rounds]
    return {
        "median": statistics.median(mine), "least": min(mine), "most": max(mine),
        "rounds": len(mine), "waited": statistics.median(numbers[-1] for numbers in used),
        "peers": {name: {"median": statistics.median(numbers[1 + i] for numbers in rounds),
                         "speedup": statistics.median(numbers[1 + i] / numbers[0]
                                                      for numbers in rounds)}
                  for i, name in enumerate(peers)},
    }
