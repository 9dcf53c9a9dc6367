"""The latest frame wins: a camera of 30 Hz and a network that takes 160 ms. The age of answered
frames is measured from LCM's stamp to the answer, in units of the network's time in the same run,
so that the speed of the machine does not matter.

Expected: one network time plus half a camera period of waiting: 1.1. If frames were queued and
answered in turn, the age would grow to LCM's 30 frames: 30 network times.
"""
import os
import statistics
import subprocess
import unittest

import own_network
from camera30 import PERIOD_US, Camera30
from selectord import Camera, Listener, Selectord, Watch, answer_of

NETWORK_US = 160000
AGE_MAX = 1.3   # network times
ANSWERS = 60    # ten seconds
WORK = os.path.abspath("latest_frame")


def prepare():
    subprocess.run([os.environ["VDNA_STUB_MAP"], WORK], check=True)


class LatestFrame(unittest.TestCase):

    def test_the_age_of_answered_frames_stays_near_one_inference(self):
        with Listener("VDNA_LOCALISATION") as answers, Watch() as watch, Camera() as camera, \
                Selectord("--map", WORK, "--warmup-frames", 5,
                          "--backbone", os.environ["VDNA_STUB_BACKBONE"],
                          environment={"VDNA_STUB_US": str(NETWORK_US)}):
            with Camera30(camera, [b"picture"]) as camera30:
                seen = [answer_of(answers.next()) for _ in range(ANSWERS)]
            sent = camera30.sent
            status = watch.wait_for("status", lambda status: status["received"] == sent)

        network_us = status["inference"]["p50_us"]
        ages = [latency_us / network_us for _, latency_us, _ in seen]
        print(f"network {network_us / 1000:.1f} ms; age in network times: mean "
              f"{statistics.mean(ages):.3f}, median {statistics.median(ages):.3f}, "
              f"longest {max(ages):.3f}")
        self.assertLess(statistics.median(ages), AGE_MAX)
        # An occasional late wake-up weighs little in this mean, and nothing in the median.
        self.assertLess(statistics.mean(sorted(ages)[:-ANSWERS // 10]), AGE_MAX)

        # Stamps tell the frames' numbers: exactly the declared ones are missing between two answers.
        for (before, _, _), (utime, _, skipped) in zip(seen, seen[1:]):
            self.assertEqual((utime - before) // PERIOD_US - 1, skipped)
        self.assertEqual(status["received"], status["processed"] + status["skipped"])
        self.assertGreater(status["skipped"], 2 * status["processed"])


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
