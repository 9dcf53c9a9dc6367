"""One picture through lib/backbone, in this process: what comes on top of the inference."""
import statistics
import time

import numpy as np

from measure import compare

RGB3 = int.from_bytes(b"RGB3", "little")
WIDTH, HEIGHT = 640, 480


def run(context):
    """All of the group."""
    if not context.library.has_backbone:
        return
    runs = 10 if context.tiny else 100 if context.quick else 400
    jpeg = context.scene.pictures(3)[0].read_bytes()
    raw = np.random.default_rng(3).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
    raw = np.sort(raw, axis=1).tobytes()
    backbone = context.library.open_backbone(context.scene.manifest("efficientnet_lite0"), 2)
    for name, arguments in (("JPEG", (jpeg,)), ("raw", (raw, WIDTH, HEIGHT, RGB3))):
        took = []
        for _ in range(runs):
            begin = time.perf_counter()
            stages = backbone.run(*arguments)
            took.append((1e6 * (time.perf_counter() - begin), *stages))
        yield f"frame {name} 640x480", "ms", 1e3, beyond_inference(took), medians(took)
    backbone.close()
    if context.peers.package:
        yield resize(context, statistics.median(frame[2] for frame in took))


def beyond_inference(took):
    beyond = [(whole - inference) / 1e6 for whole, _, _, inference in took]
    return {"median": statistics.median(beyond), "least": min(beyond), "most": max(beyond),
            "rounds": len(beyond), "waited": 0, "peers": {}}


def medians(took):
    """Stages in milliseconds."""
    return {f"{stage}_ms": statistics.median(frame[i] for frame in took) / 1e3
            for i, stage in ((1, "decode"), (2, "resize"), (3, "inference"))}


def resize(context, ours_us):
    """Resizing and normalising as the reference package does, beside ours."""
    from vdna.utils.im import ResizeDataset
    picture = np.random.default_rng(3).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
    dataset = ResizeDataset(images=[picture], size=(224, 224), norm_mean=[0.5] * 3,
                            norm_std=[0.5] * 3)
    timed = compare(lambda: dataset[0], {}, context.seconds)
    peer = {"median": timed["median"], "speedup": timed["median"] * 1e6 / ours_us}
    return ("resize 640x480 to 224x224", "ms", 1e3,
            {**timed, "median": ours_us / 1e6, "least": ours_us / 1e6, "most": ours_us / 1e6,
             "peers": {"vdna package (Pillow bicubic)": peer}}, {})
