"""Pictures over a network that loses, repeats, reorders and corrupts: our receiver delivers every
message that came whole, and no other. LCM's own receiver, on the same network, does not.
"""

import os
import unittest

import own_network
from peers import LOCAL, Impairment, Machine, Receiver, address, cable, send_frames

# Percent lost, repeated, held back, corrupted.
BAD = (5, 5, 25, 1)
FRAMES = 100_000 if os.environ.get("VDNA_ALL") else 2_000
BYTES = 180_000  # three datagrams
SEED = 7


class Impaired(unittest.TestCase):

    def receive(self, kind, percent, frames):
        """A receiver after its end, and what the network did to it."""
        with Machine() as sender, Machine() as robot:
            cable(sender, "out", None, "near")
            cable(None, "far", robot, "in")
            address(sender, "out", 1)
            address(robot, "in", 2)
            with Receiver(LOCAL, kind, machine=robot) as receiver, \
                    Impairment("near", "far", SEED, percent, robot) as network:
                send_frames(LOCAL, frames, BYTES, 0, sender, network)
                _, did = network.end()
                receiver.end()
        wrong = [utime for utime, _, right in receiver.frames if not right]
        print(f"{kind}: {did}; delivered {receiver.counters}; wrong {len(wrong)}")
        return receiver, did, wrong

    def test_what_came_whole_is_delivered_and_nothing_else(self):
        receiver, did, wrong = self.receive("ours", BAD, FRAMES)
        self.assertEqual((wrong, receiver.changed, receiver.counters["rejected"]), ([], [], 0))
        self.assertGreater(did["whole"], FRAMES / 2)  # otherwise the network was no test
        self.assertLess(did["whole"], did["messages"] * 0.9)
        self.assertGreaterEqual(receiver.counters["received"], did["whole"] * 0.999)
        self.assertLessEqual(receiver.counters["received"], did["whole"])
        self.assertGreater(receiver.counters["repeated"], 0)
        stamps = [utime for utime, _, _ in receiver.frames]
        self.assertEqual(len(stamps), len(set(stamps)), "a frame was delivered twice")

    def test_lcm_itself_fails_on_the_same_network(self):
        receiver, did, wrong = self.receive("lcm", BAD, min(FRAMES, 10_000))
        self.assertTrue(wrong or receiver.counters["rejected"])
        self.assertLess(receiver.counters["received"] - len(wrong), did["whole"] * 0.999)

    def test_a_good_network_delivers_all(self):
        receiver, did, wrong = self.receive("ours", (0, 0, 0, 0), 500)
        self.assertEqual(did["whole"], did["messages"])
        self.assertEqual(receiver.counters["received"], did["whole"])
        self.assertEqual((wrong, receiver.counters["repeated"]), ([], 0))


if __name__ == "__main__":
    own_network.run_tests_apart(lambda: None)
