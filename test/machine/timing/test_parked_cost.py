"""What a parked robot costs: the daemon and its network's process, fed 640x480 JPEGs of a camera that
stands, 30 a second, in percent of a processor; and what they take while the camera moves.

    test_parked_cost.py [--all]   a minute in place of ten seconds

Environment: as of test/system, VDNA_ALL as --all.
"""
import os
import shutil
import sys
import time

import own_network
from selectord import Camera, Selectord, Watch, WithConfiguration, jpegs_in, vdna

COST_MAX = 3  # percent
RATE, WARMUP = 30, 10
if "--all" in sys.argv:
    sys.argv.remove("--all")
    os.environ["VDNA_ALL"] = "1"
SECONDS = 60 if os.environ.get("VDNA_ALL") else 10
WORK = os.path.abspath("parked")
MAP, DRIVE, STAND = (os.path.join(WORK, name) for name in ("map", "drive", "stand"))


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    vdna("simulate", DRIVE, "--frames", 120, "--size", "640x480", "--quality", 85)
    vdna("simulate", STAND, "--frames", 150, "--size", "640x480", "--quality", 85, "--step", 0)
    vdna("build", MAP, DRIVE)


def seconds_of(pids):
    """Processor time so far, in the program and in the system for it."""
    ticks = 0
    for pid in pids:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            fields = file.read().rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


class Sender:
    """Sends pictures with stamps that go on."""

    def __init__(self, camera):
        self._camera, self._sent = camera, 0

    def send(self, pictures, seconds):
        begin = time.monotonic()
        for number in range(int(seconds * RATE)):
            self._camera.send_jpeg(self._sent * 1000000 // RATE, pictures[number % len(pictures)])
            self._sent += 1
            time.sleep(max(0, begin + (number + 1) / RATE - time.monotonic()))
        return time.monotonic() - begin


# A picture comes again after five seconds, longer than the daemon remembers any.
class ParkedCost(WithConfiguration):

    work = WORK

    def test_a_parked_robot_costs_hardly_anything(self):
        # Two rendered pictures may have the same noise, which that of a sensor never is.
        drive, stand = jpegs_in(DRIVE), list(dict.fromkeys(jpegs_in(STAND)))
        with Watch() as watch, Camera() as camera, Selectord(
                "--map", MAP, "--warmup-frames", WARMUP) as daemon:
            sender = Sender(camera)
            sender.send(drive[:90], 3)
            begin = seconds_of(daemon.pids)
            moving = sender.send(drive[90:], 1)
            moved = seconds_of(daemon.pids) - begin
            sender.send(stand, 10)
            watch.collect(1.5)
            before = watch.of("status")[-1]
            begin = seconds_of(daemon.pids)
            stood = sender.send(stand, SECONDS)
            cost = seconds_of(daemon.pids) - begin
            watch.collect(1.5)
        after = watch.of("status")[-1]
        parked, processed, skipped = (after[fate] - before[fate]
                                      for fate in ("parked", "processed", "skipped"))
        print(f"while the camera moves {100 * moved / moving:.0f} % of a processor; parked "
              f"{100 * cost / stood:.2f} % in {stood:.0f} s, {parked} frames of {len(stand[0]) // 1000} "
              f"kB, {processed} others processed, {skipped} skipped")
        self.assertGreater(parked, 0.9 * SECONDS * RATE)
        self.assertLessEqual(100 * cost / stood, COST_MAX)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
