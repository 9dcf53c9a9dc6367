"""docs/performance.md and its plots, from what was measured."""
from figures import find, judged, verdict
from plot import bars, lines

INTRODUCTION = """\
# Performance

Written by `./dev bench --write-page` from what `./dev bench` measured on {cpu}, {cores} cores
({features}), {memory_mb} MB, {system}.

Ours and a peer run in turn. A figure is the median of the rounds, a ratio the median of the ratios
of neighbouring rounds; of all rounds, the half that waited least for a processor counts. All is
pinned to two cores. What computes on one thread, as all peers but the networks do here, is in
processor time. Weights are random where none may be fetched, which changes no speed.

| group | measured | commit | load | how long |
| --- | --- | --- | --- | --- |
{groups}

Load is the mean number of processes that ran or waited, in the minute before the group and in the
last minute of it. Above 2, the measurement shared the cores with other work.

Versions: {versions}.

"""

FIGURES = """\
## Figures to reach

Seconds and milliseconds are those of this machine. Where ONNX Runtime alone already takes as long as
a figure allows, no daemon can reach it here; "Everything measured" has what it takes.

| what | | figure | reached | |
| --- | --- | ---: | ---: | --- |
{rows}

"""

ALL = """\
## Everything measured

`x` is how many times as fast as the peer ours is; of bytes merely read it is the share of the
memory's speed.

| what | ours | peer | | x |
| --- | ---: | --- | ---: | ---: |
{rows}

"""

STAGES = """\
## A frame's way through the daemon

Medians in milliseconds, as the status message has them ({frames}). `select` is counting in the
histogram or finding the nearest frame; `rank` takes its place for the frame that completes the
warmup. Processor time is that of all threads for a frame; it suffers less than the others when the
machine is shared. Memory is the process's peak, with all pages of the map that it looked at. In
both, the second number is that of ONNX Runtime alone.

| drive | {head} | processor ms | | MiB | |
| --- | {rule} | ---: | ---: | ---: | ---: |
{rows}

"""

GROWTH = """\
## Growth

The exponent b of a * size^b, fitted by least squares on logarithms: 1 is in proportion, 0 is not
at all.

| what | sizes | exponent |
| --- | --- | ---: |
{rows}

![Time of ranking by experiences, neurons and bins](performance-growth.svg)

"""

LONG_RUN = """\
## Memory over a long run

![Memory of the daemon over its frames](performance-memory.svg)
"""

STAGE_NAMES = ("queue", "decode", "resize", "inference", "select", "rank", "publish", "total")


def write(stored, folder):
    """The page, and the plots that the measurements are there for."""
    if not stored["groups"]:
        raise SystemExit("nothing was measured yet; run ./dev bench first")
    text = introduction(stored) + figures_part(stored)
    plot = throughput_plot(stored)
    if plot:
        (folder / "performance-throughput.svg").write_text(plot, encoding="utf-8")
        text += "![Throughput beside peers](performance-throughput.svg)\n\n"
    text += stages_part(stored) + growth_part(stored, folder) + long_run_part(stored, folder)
    text += all_part(stored)
    (folder / "performance.md").write_text(text.rstrip() + "\n", encoding="utf-8")


def number(value):
    """Three digits that count, without an exponent where a person would not write one."""
    if value is None:
        return ""
    if value != 0 and abs(value) < 1e-3:
        return f"{value:.1e}"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def introduction(stored):
    rows, versions = [], {}
    for name, group in stored["groups"].items():
        versions.update(group["versions"])
        rows.append(f"| {name} | {group['date'][:16].replace('T', ' ')} | {group['commit']} "
                    f"| {group['load_begin']}, {group['load_end']} "
                    f"| {'quick' if group['quick'] else 'in full'} |")
    machine = {**stored["machine"], "features": ", ".join(stored["machine"]["features"])}
    return INTRODUCTION.format(
        **machine, groups="\n".join(rows),
        versions=", ".join(f"{key} {value}" for key, value in versions.items()))


def figures_part(stored):
    words = {"<=": "at most", ">=": "at least"}
    rows = [f"| {name} | {what} | {words[sign]} {bound:g} {unit} | {number(value)} "
            f"| {verdict(sign, bound, value, reached)} |"
            for name, what, sign, bound, value, unit, reached in judged(stored)]
    return FIGURES.format(rows="\n".join(rows))


def all_part(stored):
    rows = []
    for group in stored["groups"].values():
        for result in group["results"]:
            if "points" in result["more"]:
                continue
            ours = f"{number(result['median'])} {result['unit']}"
            peers = list(result["peers"].items()) or [("", None)]
            for index, (peer, theirs) in enumerate(peers):
                start = f"| {result['name']} | {ours}" if index == 0 else "| | "
                rows.append(f"{start} | {peer} | {number(theirs and theirs['median'])} "
                            f"| {number(theirs and theirs['speedup'])} |")
    return ALL.format(rows="\n".join(rows))


def stages_part(stored):
    drives = [result for result in stored["groups"].get("drive", {}).get("results", [])
              if "memory_mib" in result["more"]]
    if not drives:
        return ""
    names = [name for name in STAGE_NAMES
             if any(name in result["more"]["stages_ms"] for result in drives)]
    rows = []
    for result in drives:
        more = result["more"]
        cells = [number(more["stages_ms"].get(name)) for name in names]
        cells += [number(more[key]) for key in ("processor_ms", "bare_processor_ms", "memory_mib",
                                                "bare_memory_mib")]
        rows.append(f"| {result['name'].removeprefix('drive ')} | {' | '.join(cells)} |")
    first = drives[0]["more"]
    frames = f"JPEG of 640x480, {number(first['bytes'])} bytes, {first['candidates']} candidates"
    return STAGES.format(head=" | ".join(names), rule=" | ".join(["---:"] * len(names)),
                         rows="\n".join(rows), frames=frames)


def throughput_plot(stored):
    """Frames in a second, ours beside peers; None without a drive."""
    groups = []
    for result in stored["groups"].get("drive", {}).get("results", []):
        if not result["name"].startswith("drive "):
            continue
        rows = [("vdna_selectord", 100 / result["median"], True)]
        rows += [(peer, 100 / theirs["median"], False) for peer, theirs in result["peers"].items()]
        groups.append((result["name"].removeprefix("drive "), rows))
    if not groups:
        return None
    cpu = stored["machine"]["cpu"]
    return bars(f"JPEG pictures of 640x480 in a second, two cores of {cpu}", groups, "/s")


def growth_part(stored, folder):
    results = stored["groups"].get("growth", {}).get("results", [])
    if not results:
        return ""
    rows = [f"| {result['name']} | {result['more']['points'][0][0]:,} to "
            f"{result['more']['points'][-1][0]:,} | {result['more']['exponent']:.2f} |"
            for result in results]
    curves = [(result["name"].rpartition("by ")[2], result["more"]["points"])
              for result in results if result["name"].startswith("time of ranking")]
    (folder / "performance-growth.svg").write_text(
        lines("Time of a ranking as one size grows", "size", "microseconds", curves, True),
        encoding="utf-8")
    return GROWTH.format(rows="\n".join(rows))


def long_run_part(stored, folder):
    result = find(stored, "drive", "long run efficientnet_lite0")
    if not result:
        return ""
    (folder / "performance-memory.svg").write_text(
        lines("Memory of vdna_selectord, EfficientNet-Lite0", "frames", "MiB",
              [("resident", result["more"]["memory_mib_by_frame"])], False), encoding="utf-8")
    return LONG_RUN + "\n"
