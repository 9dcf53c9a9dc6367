"""No false alarm of frame health: every picture of rendered drives in all conditions, and of the real
ones that $VDNA_SHARED has, is usable. Prints how near each set comes to the limits of vdna/health.h.

    test_health.py [--all]   more seeds and sizes

The real pictures may not be published; where they are missing, the rendered ones are judged alone.
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CONDITIONS = ["spring", "summer", "autumn", "winter", "overcast", "rain", "dusk", "night"]
DRIVES = [(7, "64x48", 20), (11, "160x120", 20), (41, "320x240", 10)]  # seed, size, frames
MORE_DRIVES = [(seed, size, 60) for seed in (12, 13, 14, 42) for size in ("64x48", "160x120")]
MORE_DRIVES += [(41, "640x480", 20)]
DATA = Path(os.environ["VDNA_SHARED"]) / "data"
KINDS = (".jpg", ".png")


def health_of(pictures):
    """(verdict, contrast, structure in percent of grain, bright, file) of one camera's pictures."""
    done = subprocess.run([os.environ["VDNA_HEALTH_OF"], *pictures], check=True,
                          stdout=subprocess.PIPE, text=True)
    for line in done.stdout.splitlines():
        verdict, contrast, structure, grain, bright, file = line.split("\t")
        yield verdict, int(contrast), 100 * int(structure) / int(grain), int(bright), file


def faults_of(name, folders):
    """Sentences about pictures that are not usable; prints the extremes of a set."""
    frames = [frame for folder in folders for frame in
              health_of(sorted(p for p in folder.iterdir() if p.suffix in KINDS))]
    contrast, structure, bright = ([frame[i] for frame in frames] for i in (1, 2, 3))
    print(f"{name}: {len(frames)} pictures, contrast at least {min(contrast)}, structure at least "
          f"{min(structure):.0f} % of grain, bright at most {max(bright)}")
    return [f"{file}: {verdict}, expected ok" for verdict, *_, file in frames if verdict != "ok"]


def render(folder, drives):
    """A folder for each drive and condition."""
    for seed, size, frames in drives:
        for number, condition in enumerate(CONDITIONS, start=1):
            out = Path(folder, f"{seed}-{size}-{condition}")
            subprocess.run([os.path.join(os.environ["VDNA_BIN"], "vdna"), "simulate", out,
                            "--condition", condition, "--seed", str(seed), "--frames", str(frames),
                            "--step", "2.8", "--size", size, "--variation", "0.6",
                            "--drive", str(seed * 100 + number)],
                           check=True, stdout=subprocess.DEVNULL)
            yield out


def main():
    drives = DRIVES + (MORE_DRIVES if "--all" in sys.argv[1:] else [])
    with tempfile.TemporaryDirectory() as folder:
        faults = faults_of("rendered", render(folder, drives))
    sets = sorted(DATA.iterdir()) if DATA.is_dir() else []
    for pictures in sets:
        faults += faults_of(pictures.name, sorted(p for p in pictures.iterdir() if p.is_dir()))
    if not sets:
        print(f"no real pictures in {DATA}: judged the rendered ones alone")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
