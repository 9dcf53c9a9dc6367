"""docs/reference/performance.md and its plots, from the measurements."""
import page_stages
from figures import judged, verdict
from plot import bars, lines

INTRODUCTION = """\
# Performance

Written by `./dev bench --write-page` from what `./dev bench` measured on {cpu}, {cores} cores
({features}), {memory_mb} MB, {system}.
Other machines take other times; ratios differ less.

"""

RESULTS = """\
## Results

{reached} of {count} figures are reached. Seconds and milliseconds are those of this machine: where ONNX
Runtime alone already takes as long as a figure allows, no daemon can reach it here, and "Everything
measured" has what it takes. The figures of memory are in [memory.md](../internals/memory.md), what was
missed is [at the end](#what-was-missed).

| what | | figure | reached | |
| --- | --- | ---: | ---: | --- |
{rows}

"""

METHOD = """\
## How it was measured

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

MISSED = """\
## What was missed

{rows}
"""

ARM = """\
## On 64-bit ARM

Instructions of the C99 core, counted under qemu and compiled for what all processors of a kind have
(`-march=armv8-a`, `-march=x86-64`). No ARM machine was at hand, so there are no times.

| what | thousand instructions on ARM | on x86-64 | ratio |
| --- | ---: | ---: | ---: |
{rows}

"""

ALL = """\
## Everything measured

`x` is how many times as fast as the peer ours is, and of sizes how many times as small; of bytes
merely read it is the share of the memory's speed.

| what | ours | peer | | x |
| --- | ---: | --- | ---: | ---: |
{rows}

"""

STAGES = """\
## A frame's way through the daemon

Medians in milliseconds, as the status message has them ({frames}). `select` is counting in the
histogram or finding the nearest frame; `rank` takes its place for the frame that completes the
warmup. Processor time is that of all threads for a frame; it suffers less than the others when the
machine is shared; the second number is that of ONNX Runtime alone.

| drive | {head} | processor ms | |
| --- | {rule} | ---: | ---: |
{rows}

"""

GROWTH = """\
## Growth

The exponent b of a * size^b, fitted by least squares on logarithms: 1 is in proportion, 0 is not
at all.

| what | sizes | takes | exponent |
| --- | --- | --- | ---: |
{rows}

![Time of ranking by experiences, neurons and bins](performance-growth.svg)

"""

STAGE_NAMES = ("queue", "decode", "resize", "inference", "select", "rank", "publish", "total")


def write(stored, folder):
    """The page, and the plots for which there are measurements."""
    text = introduction(stored) + results_part(stored)
    plot = throughput_plot(stored)
    if plot:
        (folder / "performance-throughput.svg").write_text(plot, encoding="utf-8")
        text += "![Throughput beside peers](performance-throughput.svg)\n\n"
    text += stages_part(stored) + growth_part(stored, folder) + arm_part(stored)
    text += page_stages.part(stored)
    text += all_part(stored) + method_part(stored) + missed_part(stored)
    (folder / "performance.md").write_text(text.rstrip() + "\n", encoding="utf-8")


def number(value):
    """Three significant digits, with an exponent only if a person would write one."""
    if value is None:
        return ""
    if value != 0 and abs(value) < 1e-3:
        return f"{value:.1e}"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def results_of(stored, group):
    """The results of a group; nothing if it did not run."""
    return stored["groups"].get(group, {}).get("results", [])


def drives_of(stored):
    """The whole drives, one of each network and precision."""
    return [result for result in results_of(stored, "drive")
            if result["name"].startswith("drive ")]


def growth_rows(results):
    """Rows of a table: subject, sizes, costs, exponent."""
    rows = []
    for result in results:
        (least, first), *_, (most, last) = result["more"]["points"]
        rows.append(f"| {result['name']} | {least:,} to {most:,} | {number(first)} to "
                    f"{number(last)} {result['unit']} | {result['more']['exponent']:.2f} |")
    return "\n".join(rows)


def introduction(stored):
    machine = {**stored["machine"], "features": ", ".join(stored["machine"]["features"])}
    return INTRODUCTION.format(**machine)


def method_part(stored):
    rows, versions = [], {}
    for name, group in stored["groups"].items():
        versions.update(group["versions"])
        rows.append(f"| {name} | {group['date'][:16].replace('T', ' ')} | {group['commit']} "
                    f"| {group['load_begin']}, {group['load_end']} "
                    f"| {'quick' if group['quick'] else 'in full'} |")
    return METHOD.format(groups="\n".join(rows), versions=", ".join(
        f"{key} {value}" for key, value in versions.items()))


def figures_of(stored):
    """All that are judged here."""
    return [figure for figure in judged(stored) if figure[5] != "MiB"]


def bound_text(sign, bound, unit):
    return f"at {'most' if sign == '<=' else 'least'} {bound:g} {unit}".rstrip()


def results_part(stored):
    figures = figures_of(stored)
    rows = [f"| {name} | {what} | {bound_text(sign, bound, unit)} | {number(value)} "
            f"| {verdict(sign, bound, value, reached)} |"
            for name, what, sign, bound, value, unit, reached in figures]
    return RESULTS.format(rows="\n".join(rows), count=len(figures),
                          reached=sum(figure[-1] is True for figure in figures))


def missed_part(stored):
    missed, open_ones = [], []
    for name, what, sign, bound, value, unit, reached in figures_of(stored):
        if reached is None:
            open_ones.append(f"{name} ({what})")
        elif not reached:
            missed.append(f"- **{name}**, {what}: {number(value)} {unit}, expected "
                          f"{bound_text(sign, bound, unit)}: "
                          f"{verdict(sign, bound, value, reached)}")
    rows = missed or ["Nothing that was measured."]
    if open_ones:
        rows.append(f"\nNot measured: {', '.join(open_ones)}.")
    return MISSED.format(rows="\n".join(rows))


def arm_part(stored):
    rows = []
    for result in results_of(stored, "arm"):
        more = result["more"]
        rows.append(f"| {result['name']} | {number(result['median'])} "
                    f"| {number(more['x86_64_thousands'])} | {more['of_x86_64']:.2f} |")
    return ARM.format(rows="\n".join(rows)) if rows else ""


def all_part(stored):
    rows = []
    for name, group in stored["groups"].items():
        for result in group["results"]:
            if "points" in result["more"] or name == "arm":
                continue
            ours = f"{number(result['median'])} {result['unit']}"
            peers = list(result["peers"].items()) or [("", None)]
            for index, (peer, theirs) in enumerate(peers):
                start = f"| {result['name']} | {ours}" if index == 0 else "| | "
                rows.append(f"{start} | {peer} | {number(theirs and theirs['median'])} "
                            f"| {number(theirs and theirs['speedup'])} |")
    return ALL.format(rows="\n".join(rows))


def stages_part(stored):
    drives = drives_of(stored)
    if not drives:
        return ""
    names = [name for name in STAGE_NAMES
             if any(name in result["more"]["stages_ms"] for result in drives)]
    rows = []
    for result in drives:
        more = result["more"]
        cells = [number(more["stages_ms"].get(name)) for name in names]
        cells += [number(more[key]) for key in ("processor_ms", "bare_processor_ms")]
        rows.append(f"| {result['name'].removeprefix('drive ')} | {' | '.join(cells)} |")
    first = drives[0]["more"]
    frames = f"JPEG of 640x480, {number(first['bytes'])} bytes, {first['candidates']} candidates"
    return STAGES.format(head=" | ".join(names), rule=" | ".join(["---:"] * len(names)),
                         rows="\n".join(rows), frames=frames)


def throughput_plot(stored):
    """Frames in a second, ours beside peers; None without a drive."""
    groups = []
    for result in drives_of(stored):
        rows = [("vdna_selectord", 100 / result["median"], True)]
        rows += [(peer, 100 / theirs["median"], False) for peer, theirs in result["peers"].items()]
        groups.append((result["name"].removeprefix("drive "), rows))
    if not groups:
        return None
    cpu = stored["machine"]["cpu"]
    return bars(f"JPEG pictures of 640x480 in a second, two cores of {cpu}", groups, "/s")


def growth_part(stored, folder):
    results = results_of(stored, "growth")
    if not results:
        return ""
    curves = [(result["name"].rpartition("by ")[2], result["more"]["points"])
              for result in results if result["name"].startswith("time of ranking")]
    (folder / "performance-growth.svg").write_text(
        lines("Time of a ranking as one size grows", "size", "microseconds", curves, True),
        encoding="utf-8")
    return GROWTH.format(rows=growth_rows(results))
