"""Ten thousand camera frames over real LCM through the real daemon: JPEG decoded, the default
network run, warmed up, ranked and localised repeatedly. From READY on our own code allocates
nothing, even if pictures change their size, and from the 100th frame on ONNX Runtime, libjpeg and
LCM do not grow.

VDNA_FRAMES sets another number of frames.
"""
import os
import shutil
import unittest

import own_network
from allocations import Allocations
from selectord import (Camera, Listener, Selectord, answer_of, jpegs_in, memory_of,
                       network_process, vdna)

WORK = os.path.abspath("real_frames")
MAP, LIVE = os.path.join(WORK, "map"), os.path.join(WORK, "drives")
SIZES = ["320x240", "448x448", "200x150"]  # whole ratios and not, shrinking and growing
FRAMES = int(os.environ.get("VDNA_FRAMES", 10000))
SETTLED = 100      # frames
RESET_EVERY = 1000 # frames
FLAT_LIVE = 64 << 10      # bytes allocated; ONNX Runtime's are among them
FLAT_RESIDENT = 2 << 20   # bytes; memory freed after a frame is not always returned


def prepare():
    if os.path.exists(LIVE):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    drives = [os.path.join(WORK, condition) for condition in ("summer", "winter")]
    for drive in drives:
        vdna("simulate", drive, "--condition", os.path.basename(drive), "--frames", 40)
    vdna("build", MAP, *drives)
    for size in SIZES:
        vdna("simulate", os.path.join(LIVE + ".part", size), "--condition", "winter", "--frames", 30,
             "--drive", 7, "--size", size)
    os.rename(LIVE + ".part", LIVE)


def live_pictures():
    """Of all sizes in turn."""
    return [picture for pictures in zip(*(jpegs_in(os.path.join(LIVE, size)) for size in SIZES))
            for picture in pictures]


class RealFrames(unittest.TestCase):

    def test_ten_thousand_frames_cost_no_allocation_of_ours_and_no_memory(self):
        live = live_pictures()
        allocations = Allocations(os.path.join(WORK, "allocations"))
        with Listener("VDNA_LOCALISATION") as answers, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 30,
                          environment=allocations.environment) as daemon:
            pids = {"daemon": daemon.pid, "network": network_process(daemon.pid)}

            def read():
                return {name: (*allocations.read(pid), memory_of(pid)["VmRSS"])
                        for name, pid in pids.items()}
            ready = read()
            for frame in range(FRAMES + SETTLED):
                if frame == SETTLED:
                    early = read()
                if frame % RESET_EVERY == SETTLED // 2:
                    vdna("command", "reset")
                camera.send_jpeg(frame, live[frame % len(live)])
                utime, _, skipped = answer_of(answers.next())
                self.assertEqual((utime, skipped), (frame, 0))
            late = read()

        for name in pids:
            self.assert_flat(name, ready[name], early[name], late[name])
        _, calls, _ = late["network"]
        self.assertTrue(any("onnxruntime" in name and count > FRAMES
                            for name, count in calls.items()))

    def assert_flat(self, name, ready, early, late):
        (early_live, early_calls, early_resident), (live, calls, resident) = early, late
        more = {name: count - early_calls.get(name, 0) for name, count in calls.items()}
        print(f"{name} over {FRAMES} frames: live {early_live} -> {live} bytes, resident "
              f"{early_resident} -> {resident}; allocations per frame: " +
              ", ".join(f"{name} {count / FRAMES:.2f}" for name, count in more.items() if count))
        self.assertGreater(ready[1]["program"], 0)  # otherwise nothing is being counted
        self.assertEqual(calls["program"], ready[1]["program"])
        self.assertLess(abs(live - early_live), FLAT_LIVE)
        self.assertLess(resident - early_resident, FLAT_RESIDENT)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
