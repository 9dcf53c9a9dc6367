"""docs/internals/memory.md and its plots, from the measurements."""
from figures import beyond_bare_memory, judged, verdict
from page_performance import drives_of, growth_rows, number, results_of
from plot import lines

INTRODUCTION = """\
# Memory

What `vdna_selectord` takes on a robot. Written by `./dev bench --write-page` from what `./dev bench`
measured; [performance.md](../reference/performance.md) says when, on which machine and with which versions.
[onboard.md](../operating/onboard.md#memory) says of what parts this memory is and how to limit it,
[memory-core.md](memory-core.md) what the C99 library takes by itself.

"""

DRIVES = """\
## Beside ONNX Runtime alone

In MiB, each at its peak: the daemon in a drive with a map of {candidates} experiences, and another
process that has the network in ONNX Runtime and nothing else. The daemon's peak includes the whole
map, all of which is read when it is opened; its pages are those of files, which the system may take
back. Beyond both are program and libraries, selector, pictures and messages.

| network | daemon | ONNX Runtime | map | beyond both | figure | |
| --- | ---: | ---: | ---: | ---: | --- | --- |
{rows}

"""

GROWTH = """\
## Growth

The selector has the live histogram and what ranking needs, and the daemon holds it; the map is
mapped. One size differs at a time from {experiences} experiences of {frames:,} frames with {neurons} neurons,
{bins:,} bins and embeddings of {dim} dimensions. Most of an experience is counts and embeddings, so the
map grows less than in proportion with what enlarges only one of them. The exponent is that of
[performance.md](../reference/performance.md#growth).

| what | sizes | takes | exponent |
| --- | --- | --- | ---: |
{rows}

![Memory of the selector and the map by experiences](memory-growth.svg)

"""

LONG_RUN = """\
## Over a long run

Resident size of the daemon with {network}: {first:.1f} MiB before the first frame, {second:.1f}
after {frames_second:,} frames, {last:.1f} after {frames_last:,}; the most was {most:.1f}.

![Memory of the daemon over its frames](memory-long-run.svg)
"""


def write(stored, folder):
    """The page, and the plots for which there are measurements."""
    text = INTRODUCTION + drives_part(stored)
    text += growth_part(stored, folder) + long_run_part(stored, folder)
    (folder / "memory.md").write_text(text.rstrip() + "\n", encoding="utf-8")


def drives_part(stored):
    drives = drives_of(stored)
    if not drives:
        return ""
    judgements = {name: f"{what} at most {bound:g} | {verdict(sign, bound, value, reached)}"
                  for name, what, sign, bound, value, unit, reached in judged(stored)
                  if unit == "MiB"}
    rows = []
    for drive in drives:
        more = drive["more"]
        cells = [more["memory_mib"], more["bare_memory_mib"], more["map_mib"],
                 beyond_bare_memory(drive)]
        rows.append(f"| {drive['name'].removeprefix('drive ')} | {' | '.join(map(number, cells))} "
                    f"| {judgements.get(drive['name'], ' | ')} |")
    return DRIVES.format(candidates=drives[0]["more"]["candidates"], rows="\n".join(rows))


def growth_part(stored, folder):
    results = results_of(stored, "sizes")
    if not results:
        return ""
    by_experiences = [(result["name"].removeprefix("memory of ").partition(",")[0],
                       result["more"]["points"])
                      for result in results if result["name"].endswith("by experiences")]
    (folder / "memory-growth.svg").write_text(
        lines("Memory by experiences", "experiences", "MiB", by_experiences, True),
        encoding="utf-8")
    return GROWTH.format(rows=growth_rows(results), **results[0]["more"]["usual"])


def long_run_part(stored, folder):
    run = next((result for result in results_of(stored, "drive")
                if result["name"].startswith("long run ")), None)
    if not run:
        return ""
    network, points = run["name"].removeprefix("long run "), run["more"]["memory_mib_by_frame"]
    (folder / "memory-long-run.svg").write_text(
        lines(f"Memory of vdna_selectord, {network}", "frames", "MiB", [("resident", points)],
              False), encoding="utf-8")
    (_, first), (frames_second, second), *_, (frames_last, last) = points
    return LONG_RUN.format(network=network, first=first, second=second, last=last,
                           most=max(size for _, size in points), frames_second=frames_second,
                           frames_last=frames_last)
