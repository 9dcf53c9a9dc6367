#!/usr/bin/env python3
"""Draw docs/answer.png, the picture of the README, from what ./dev demo left in build/demo.

The live drive against the map of summer, winter and night: what the camera sees, how the experiences
rank, and where the drive is in the chosen one. Needs the programs in build/bin and chromium.
"""
import base64
import html
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DEMO = ROOT / "build/demo"
WARMUP = 40
FRAME = 60  # of the pictures shown
SIZE = (1200, 452)

STYLE = """
body { margin: 0; background: #fff; color: #1b1f24; font: 17px/1.35 'DejaVu Sans', sans-serif }
main { display: grid; grid-template-columns: 320px 1fr 390px; gap: 30px; padding: 22px 26px }
h2 { font-size: 19px; margin: 0 0 10px }
img { display: block; width: 100%; border-radius: 6px }
p { margin: 10px 0 0 }
.row { display: grid; grid-template-columns: 112px 1fr; gap: 14px; align-items: center; padding: 8px;
       margin-bottom: 9px; border: 3px solid transparent; border-radius: 8px }
.chosen { border-color: #0b7a3b; background: #eef8f1 }
.bar { height: 11px; border-radius: 3px; background: #8893a0 }
.chosen .bar { background: #0b7a3b }
.matrix { overflow: hidden }
.matrix img { width: 156%; border-radius: 0 }
small { font-size: 14px; color: #4a535d }
"""


def report_of(*command):
    """The --json report of a command of vdna."""
    return json.loads(subprocess.run([ROOT / "build/bin/vdna", *command, "--json"], check=True,
                                     stdout=subprocess.PIPE).stdout)


def image(path):
    kind = {".png": "png", ".svg": "svg+xml"}.get(path.suffix, "jpeg")
    return f'<img alt="" src="data:image/{kind};base64,{base64.b64encode(path.read_bytes()).decode()}">'


def picture_of(drive):
    return sorted(path for path in (DEMO / drive).iterdir() if path.suffix in (".jpg", ".png"))[FRAME]


def row(entry, is_chosen, farthest):
    name = entry["experience"]
    low, high = (100 * entry["predicted_" + end] for end in ("low", "high"))
    return (f'<div class="row{" chosen" if is_chosen else ""}">{image(picture_of(name))}<div>'
            f'<b>{html.escape(name)}</b>{" &#10003; chosen" if is_chosen else ""}'
            f'<div class="bar" style="width: {100 * entry["distance_bins"] / farthest:.0f}%"></div>'
            f'<small>{entry["distance_bins"]:.1f} bins away<br>'
            f'expects {100 * entry["predicted_recall"]:.0f} % ({low:.0f} to {high:.0f}) of frames right'
            '</small></div></div>')


def page(matrix):
    ranking = report_of("rank", DEMO / "live", DEMO / "map", "--warmup", str(WARMUP))
    chosen = ranking["ranking"][0]["experience"]
    places = report_of("localise", DEMO / "live", DEMO / "map", "--in", chosen, "--skip", str(WARMUP),
                       "--tolerance", "2.5", "--matrix", matrix)
    farthest = max(entry["distance_bins"] for entry in ranking["ranking"])
    rows = "".join(row(entry, entry["experience"] == chosen, farthest) for entry in ranking["ranking"])
    candidate = places["candidates"][0]
    return (f"<meta charset=utf-8><style>{STYLE}</style><main>"
            f"<section><h2>Now</h2>{image(picture_of('live'))}"
            f"<p>a spring day that the map has never seen</p></section>"
            f"<section><h2>Which recording looks like now?</h2>{rows}</section>"
            f"<section><h2>Where am I in it?</h2><div class=matrix>{image(matrix)}</div>"
            f"<p>the green line is right for {candidate['recall_percent']:.0f}&nbsp;% of "
            f"{candidate['judged']} frames</p></section></main>")


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "answer.html").write_text(page(folder / "matrix.svg"))
        subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                        f"--window-size={SIZE[0]},{SIZE[1]}", f"--screenshot={ROOT / 'docs/answer.png'}",
                        (folder / "answer.html").as_uri()], check=True, stderr=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
