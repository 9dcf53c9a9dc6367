"""The figures to reach, and whether a measurement reaches them."""


def speedup(peer):
    return lambda result: result["peers"].get(peer, {}).get("speedup")


def further(key):
    return lambda result: result["more"].get(key)


def median(result):
    return result["median"]


def overhead_percent(result):
    faster = speedup("ONNX Runtime alone")(result)
    return None if faster is None else 100 * (1 / faster - 1)


def package_speedup(result):
    found = [numbers["speedup"] for name, numbers in result["peers"].items()
             if name.startswith("vdna package")]
    return max(found, default=None)


def beyond_bare_memory(result):
    more = result["more"]
    return more["memory_mib"] - more["bare_memory_mib"] - more["map_mib"]


# group, result, what, number, "<=" or ">=", bound, unit
LESS_WORK = [  # for each answer
    *[("drive", f"decision efficientnet_lite0 {precision}", what, further(key), sign, bound, "%")
      for precision in ("fp32", "int8")
      for what, key, sign, bound in (
          ("time to the choice, of that with 100 frames", "time_percent", "<=", 35),
          ("same choice as with 100 frames", "same_choice_percent", ">=", 96),
          ("a choice as good as with 100 frames", "as_good_percent", ">=", 96))],
    ("start", "start efficientnet_lite0, K=8", "from exec to READY", median, "<=", 500, "ms"),
    ("start", "start efficientnet_lite0, K=8", "of that beside ONNX Runtime's session",
     further("beyond_ms"), "<=", 100, "ms"),
]
FIGURES = [
    *LESS_WORK,
    ("drive", "drive cosplace_224 fp32", "100 frames to the decision", median, "<=", 5, "s"),
    ("drive", "drive cosplace_224 int8", "100 frames to the decision", median, "<=", 2, "s"),
    ("drive", "drive mugs_vitb16 fp32", "100 frames to the decision", median, "<=", 11, "s"),
    ("drive", "drive mugs_vitb16 int8", "100 frames to the decision", median, "<=", 4.5, "s"),
    ("drive", "drive cosplace_224 fp32", "against the PyTorch package", package_speedup, ">=", 2,
     "x"),
    ("drive", "drive mugs_vitb16 fp32", "against the PyTorch package", package_speedup, ">=", 2,
     "x"),
    ("drive", "drive cosplace_224 int8", "against the PyTorch package", package_speedup, ">=", 5.5,
     "x"),
    ("drive", "drive mugs_vitb16 int8", "against the PyTorch package", package_speedup, ">=", 5.5,
     "x"),
    ("drive", "drive cosplace_224 fp32", "over ONNX Runtime alone", overhead_percent, "<=", 5, "%"),
    ("drive", "drive mugs_vitb16 fp32", "over ONNX Runtime alone", overhead_percent, "<=", 3, "%"),
    ("drive", "drive cosplace_224 int8", "over ONNX Runtime alone", overhead_percent, "<=", 12,
     "%"),
    ("frame", "frame raw 640x480", "over the inference", median, "<=", 1, "ms"),
    ("frame", "resize 640x480 to 224x224, area", "resize and normalise", median, "<=", 0.6, "ms"),
    ("frame", "JPEG 640x480 reduced", "decode and resize", median, "<=", 0.6, "ms"),
    ("frame", "JPEG 1920x1080 reduced", "against decoding in full", speedup("decoding in full"),
     ">=", 4, "x"),
    ("drive", "last frame mugs_vitb16, K=4", "beyond one inference",
     further("beyond_inference_ms"), "<=", 1, "ms"),
    ("drive", "last frame mugs_vitb16, K=100, 5 exact", "beyond one inference",
     further("beyond_inference_ms"), "<=", 5, "ms"),
    ("drive", "choosing again efficientnet_lite0, K=4", "over one choice, processor time",
     further("over_single_percent"), "<=", 10, "%"),
    *[("core", f"histogram {shape}", what, number, bound[0], bound[1], unit)
      for shape in ("128x1", "768x197", "1280x1")
      for what, number, bound, unit in (
          ("counting", median, ("<=", 1), "ns/activation"),
          ("against the package, batches of 64", speedup("vdna package, batches of 64"),
           (">=", 10), "x"),
          ("against the package, frame by frame", speedup("vdna package, frame by frame"),
           (">=", 50), "x"))],
    *[("core", f"EMD {neurons} neurons, K={count}", what, speedup(peer), ">=", least, "x")
      for neurons in (128, 768, 9984) for count in (4, 100)
      for what, peer, least in (
          ("against faiss L1", "faiss L1 of float CDFs", 1),
          ("against the package", "vdna package", 20))],
    ("core", "pairs of 64 and 64, 768 neurons", "against the mean", speedup("vdna_emd_mean"), ">=",
     4, "x"),
    ("core", "top 5 of 100, 768 neurons", "whole ranking", median, "<=", 5, "ms"),
    ("core", "top 5 of 1000, 128 neurons", "exact distances", further("exact_percent"), "<=", 4, "%"),
    *[("core", f"nearest {shape}", "against faiss IndexFlatL2", speedup("faiss IndexFlatL2"), ">=",
       1, "x") for shape in ("1150x128", "1150x768", "100000x768")],
    *[("localise", f"localise {shape}", "against faiss IndexFlatL2", speedup("faiss IndexFlatL2"),
       ">=", 0.77, "x") for shape in ("1150x1008", "100000x64")],
    *[("localise", f"localise 1150x{dim}", "of an inference", further("of_an_inference_percent"), "<=",
       1, "%") for dim in (64, 1008)],
    *[("core", f"Frechet 768, 100 and {frames} frames", what, number, sign, bound, unit)
      for frames in (100, 1150)
      for what, number, sign, bound, unit in (
          ("against scipy's sqrtm", speedup("scipy sqrtm"), ">=", 100, "x"),
          ("relative error", further("error"), "<=", 1e-12, ""))],
    ("files", "load experience of 768 neurons, 1150 frames", "load", median, "<=", 1, "ms"),
    ("files", "save experience of 768 neurons, 1150 frames", "save", median, "<=", 30, "ms"),
    ("add", "add to a map of 600", "against a map of 2", speedup("a map of 2"), ">=", 0.83, "x"),
    *[("drive", f"drive {name} fp32", "memory beyond ONNX Runtime and the map",
       beyond_bare_memory, "<=", 64, "MiB") for name in ("cosplace_224", "mugs_vitb16")],
    ("drive", "drive cosplace_224 int8", "memory", further("memory_mib"), "<=", 256, "MiB"),
    ("drive", "drive mugs_vitb16 int8", "memory", further("memory_mib"), "<=", 320, "MiB"),
    *[("stages", f"stages efficientnet_lite0 {precision}, {phase}", "over ONNX Runtime alone",
       overhead_percent, "<=", bound, "%")
      for precision, bound in (("fp32", 15), ("int8", 25)) for phase in ("warmup", "choice made")],
    *[("growth", f"time of {what}", "exponent", further("exponent"), "<=", bound, "")
      for what, bound in (("ranking, by experiences", 1.05), ("ranking, by neurons", 1.05),
                          ("counting 100 frames, by frames counted before", 0.05))],
]


def find(stored, group, name):
    """A result, or None."""
    results = stored["groups"].get(group, {}).get("results", [])
    return next((result for result in results if result["name"] == name), None)


def judged(stored):
    """[(result's name, what, sign, bound, number or None, unit, reached or None)]"""
    rows = []
    for group, name, what, number_of, sign, bound, unit in FIGURES:
        result = find(stored, group, name)
        number = number_of(result) if result else None
        reached = None if number is None else number <= bound if sign == "<=" else number >= bound
        rows.append((name, what, sign, bound, number, unit, reached))
    return rows


def verdict(sign, bound, number, reached):
    """The verdict in words; a miss says by how much."""
    if reached is None:
        return "not measured"
    if reached:
        return "reached"
    factor = number / bound if sign == "<=" else bound / max(number, 1e-300)
    return f"missed by {100 * (factor - 1):.0f} %" if factor < 2 else f"missed {factor:.1f} x"


def print_all(stored):
    """The table of measured figures on the terminal."""
    print()
    for name, what, sign, bound, number, unit, reached in judged(stored):
        if number is not None:
            print(f"{name:<46} {what:<38} {sign} {bound:<6g} {number:>9.3g} {unit:<14} "
                  f"{verdict(sign, bound, number, reached)}")
