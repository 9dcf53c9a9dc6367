"""Which frames of rendered drives, and of the real ones that $VDNA_SHARED has, would be taken for those of
a parked camera, by the comparison of pictures alone; the daemon asks only when the place filter says that
the robot stands. Frames that are a step apart never are. Each drive begins with a stand, so the noise is
known; those that stand are recognised, and of those that creep only what is centimetres away.

    test_parked_drives.py [--all] [FOLDER...]

--all: more worlds and longer drives. FOLDER: of picture files, a drive each, which are looked at too.
The real pictures may not be published; where they are missing, the rendered ones are looked at alone.
"""
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CONDITIONS = ["spring", "summer", "autumn", "winter", "overcast", "rain", "dusk", "night"]
DATA = Path(os.environ["VDNA_SHARED"]) / "data"
KINDS = (".jpg", ".png")
STAND = 64      # frames: twice the window that measures the noise
SIZE = "320x240"
ALL = "--all" in sys.argv[1:]
SEEDS = (11, 12, 13, 41) if ALL else (11,)
DRIVE, CREEP = (300, 300) if ALL else (30, 60)  # frames
CREEPING = (0.001, 0.01, 0.03)  # metres a frame: 3 cm/s, 30 cm/s, 90 cm/s at 30 Hz
FAR = 0.3       # metres: less than the frames of a map are apart
STANDS = 0.9    # of the frames after the first window


def pictures_in(folder):
    return sorted(p for p in Path(folder).iterdir() if p.suffix in KINDS)


def looked_at(pictures):
    """(is parked, number of the frame that it was compared with) of each."""
    done = subprocess.run([os.environ["VDNA_PARKED_OF"], *pictures], check=True,
                          stdout=subprocess.PIPE, text=True)
    for line in done.stdout.splitlines():
        parked, reference = line.split("\t")
        yield parked == "1", int(reference)


def simulated(folder, seed, condition, frames, step):
    out = Path(folder, f"{seed}-{condition}-{step}-{frames}")
    subprocess.run([os.path.join(os.environ["VDNA_BIN"], "vdna"), "simulate", out, "--condition", condition,
                    "--seed", str(seed), "--frames", str(frames), "--step", str(step), "--size", SIZE,
                    "--rate", "30", "--drive", str(seed * 100 + CONDITIONS.index(condition))],
                   check=True, stdout=subprocess.DEVNULL)
    return out


def way_of(folder):
    """Metres along x of each frame."""
    with open(Path(folder, "labels.csv"), encoding="utf-8", newline="") as file:
        return [float(row["x"]) for row in csv.DictReader(file)]


def check_steps(stand, drive, name):
    """A stand, then frames a step apart."""
    looks = list(looked_at(stand + drive))[len(stand):]
    wrong = sum(parked for parked, _ in looks)
    return len(looks), [f"{name}: {wrong} of {len(looks)} frames of a drive parked"] if wrong else []


def check_creeping(stand, drive, way, name):
    looks = list(looked_at(stand + drive))[len(stand):]
    far = [way[i] - way[max(reference - len(stand), 0)]
           for i, (parked, reference) in enumerate(looks) if parked]
    farthest = max(far, default=0)
    print(f"{name}: {len(far)} of {len(looks)} frames parked, at most {100 * farthest:.1f} cm from the "
          "frame that was seen")
    return [f"{name}: {farthest} m, expected at most {FAR}"] if farthest > FAR else []


def check_stand(stand, name):
    looks = list(looked_at(stand))[STAND // 2:]
    parked = sum(is_parked for is_parked, _ in looks)
    print(f"{name}: {parked} of {len(looks)} frames that stand parked")
    # Drops of rain are new in every picture, and beyond the limit.
    enough = name.endswith("rain") or parked >= STANDS * len(looks)
    return [] if enough else [f"{name}: expected {100 * STANDS:.0f} %"]


def rendered(folder):
    total, wrong = 0, []
    for seed in SEEDS:
        for condition in CONDITIONS:
            name = f"{seed} {condition}"
            stand = pictures_in(simulated(folder, seed, condition, STAND, 0))
            wrong += check_stand(stand, name)
            drive = pictures_in(simulated(folder, seed, condition, DRIVE, 0.7))[1:]  # the first stands
            frames, faults = check_steps(stand, drive, name)
            total, wrong = total + frames, wrong + faults
            creeps = seed == SEEDS[0] and (ALL or condition in ("summer", "night"))
            for step in CREEPING if creeps else ():
                creep = simulated(folder, seed, condition, CREEP, step)
                wrong += check_creeping(stand, pictures_in(creep), way_of(creep), f"{name}, {step} m a frame")
    return total, wrong


def real():
    """Each drive after the stand of a rendered camera, so some noise is known."""
    folders = [folder for pictures in (sorted(DATA.iterdir()) if DATA.is_dir() else [])
               for folder in sorted(pictures.iterdir()) if folder.is_dir()]
    return folders + [Path(name) for name in sys.argv[1:] if not name.startswith("--")]


def main():
    with tempfile.TemporaryDirectory() as folder:
        total, wrong = rendered(folder)
        stand = pictures_in(Path(folder, f"{SEEDS[0]}-night-0-{STAND}"))
        for drive in real():
            frames, faults = check_steps(stand, pictures_in(drive), str(drive))
            total, wrong = total + frames, wrong + faults
    print(f"{total} frames of drives, {len(wrong)} faults")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
