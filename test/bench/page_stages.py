"""The table of docs' performance page that says where a frame's processor time goes."""

HEAD = """\
## Where a frame's processor time goes

Milliseconds for a JPEG of 640x480 beside ONNX Runtime alone in the same run (`./dev bench stages`). The
network's row is its process less the pictures' stages; nearest neighbours are those of all experiences.

"""


def part(stored):
    """The table; "" if it was not measured."""
    results = stored["groups"].get("stages", {}).get("results", [])
    if not results:
        return ""
    names = [key.removesuffix(", ms") for key in results[0]["more"] if key.endswith(", ms")]
    names.sort(key=lambda name: name != "network")
    heads = [result["name"].removeprefix("stages ") for result in results]
    rows = [("ONNX Runtime alone", [bare(result)["median"] for result in results]),
            *((name, [result["more"][f"{name}, ms"] for result in results]) for name in names),
            ("all of ours", [result["median"] for result in results]),
            ("over ONNX Runtime alone, percent",
             [result["more"]["over ONNX Runtime alone, percent"] for result in results])]
    lines = [f"| | {' | '.join(heads)} |", f"| --- |{' ---: |' * len(heads)}",
             *(f"| {name} | {' | '.join(f'{number:.3g}' for number in numbers)} |"
               for name, numbers in rows)]
    return HEAD + "\n".join(lines) + "\n\n"


def bare(result):
    return result["peers"]["ONNX Runtime alone"]
