"""Messages that come while nobody reads: each is counted, and the first frame after a pause is new."""

import signal
import struct
import threading
import time
import unittest

import own_network
from peers import STOCK, Receiver, Sender, image_message

CAMERA_PERIOD = 1 / 30
SETTLED = 0.3
# As on a machine that was not told to have larger buffers.
SMALL_BUFFER = STOCK + "&recv_buf_size=212992"


class Camera(threading.Thread):
    """30 frames a second, of these sizes by turns."""

    def __init__(self, sizes, fragment=None):
        super().__init__(daemon=True)
        self._frames = [image_message(utime, sizes[utime % len(sizes)]) for utime in range(400)]
        self._fragment, self._ended = fragment, threading.Event()
        self.sent = 0
        self.start()

    def run(self):
        sender, begin = Sender(), time.monotonic()
        while not self._ended.wait(max(0, begin + self.sent * CAMERA_PERIOD - time.monotonic())):
            sender.send(self._frames[self.sent], fragment=self._fragment)
            self.sent += 1

    def stop(self):
        self._ended.set()
        self.join()


def assert_conserved(test, sent, counters, frames):
    """`sent` camera messages of one sender, the last of which came: each has one fate."""
    handed_out = counters["received"] - counters["skipped"] - counters["oversized"]
    test.assertEqual(handed_out, len(frames))
    test.assertEqual(sent, counters["received"] + counters["rejected"] + counters["lost"])
    test.assertEqual([frame for frame in frames if not frame[2]], [])


class Backlog(unittest.TestCase):

    def test_every_message_has_one_fate(self):
        for fragment in (None, 5000):
            with Receiver(SMALL_BUFFER, work_ms=20, max_bytes=30000) as receiver:
                sender = Sender()
                sizes = [100, 20000, 30001, 3000, 30000, 60000]
                for i in range(600):
                    message = image_message(i, sizes[i % len(sizes)])
                    if i % 10 == 9:
                        message = message[:-1]
                    sender.send(message, fragment=fragment)
                    if i % 50 == 49:
                        time.sleep(0.1)
                time.sleep(1.1)  # what is half received by then is given up
                sender.send(image_message(600, 100))
                time.sleep(SETTLED)
                receiver.end()
            print(f"fragments of {fragment}: {len(receiver.frames)} frames, {receiver.counters}")
            for fate in ("skipped", "oversized", "rejected", "lost", "dropped"):
                self.assertGreater(receiver.counters[fate], 0, fate)
            self.assertEqual(receiver.frames[-1][0], 600)
            self.assertEqual(receiver.changed, [])
            assert_conserved(self, 601, receiver.counters, receiver.frames)

    def test_each_kind_of_message_is_counted(self):
        reset = struct.pack(">QqiI", 0xD703A8025AC63713, 0, 1, 1) + b"\0"
        sender = Sender()
        with Receiver(max_bytes=30000) as receiver:
            sender.send(reset, "VDNA_COMMAND")
            sender.send(reset, "VDNA_COMMAND", fragment=20)
            sender.send(reset + b"?", "VDNA_COMMAND")  # rejected
            sender.send(bytes(70000), "VDNA_COMMAND", fragment=60000)  # rejected
            sender.send(bytes(70000), fragment=60000)  # no picture: rejected
            sender.send(image_message(1, 70000), fragment=60000)  # oversized
            sender.send(image_message(2, 30001))  # oversized
            sender.send(image_message(3, 30000))
            sender.send(image_message(4, 70000), "LIDAR", fragment=60000)
            sender.send(image_message(5, 100), "LIDAR")
            sender.raw(b"LC04 is malformed")
            time.sleep(SETTLED)
            receiver.end()
        self.assertEqual([(utime, right) for utime, _, right in receiver.frames], [(3, 1)])
        self.assertEqual(receiver.counters, {
            "received": 3, "skipped": 0, "oversized": 2, "rejected": 3, "commands": 2, "lost": 0,
            "incomplete": 0, "dropped": 0, "malformed": 1, "foreign": 0,
            "repeated": 4,  # the second fragments of what was not kept
            "unprotected_frames": 2,  # of the largest one, only the beginning came
            "corrupted_frames": 0, "repeated_frames": 0, "reordered_frames": 0, "lost_frames": 0,
            "stream_count": 0, "other_sender_frames": 0})

    def test_after_a_sleep_the_first_frame_is_new(self):
        for url, size, fragment, seconds in (
                (SMALL_BUFFER, 30000, None, 3), (STOCK, 30000, None, 1),
                (SMALL_BUFFER, 300000, 60000, 1), (SMALL_BUFFER, 2000, None, 1)):
            camera = Camera([size], fragment)
            with Receiver(url, work_ms=20) as receiver:
                time.sleep(0.5)
                receiver.signal(signal.SIGSTOP)
                before = camera.sent
                time.sleep(seconds)
                after = camera.sent
                receiver.signal(signal.SIGCONT)
                time.sleep(1.3)  # what is half received is given up after a second
                camera.stop()
                time.sleep(SETTLED)
                receiver.end()
            first = next(frame for frame in receiver.frames if frame[0] >= after - 2)
            older = [frame for frame in receiver.frames if before < frame[0] < after - 2]
            print(f"{size} bytes: first frame after the sleep is {first[0] - after:+} and "
                  f"{first[1]} us old; {receiver.counters}")
            self.assertEqual(older, [])
            # At most one frame was waiting for as long as another is worked on, and a camera period.
            self.assertLess(first[1], 1e6 * CAMERA_PERIOD + 20000)
            first_sent = receiver.frames[0][0]
            assert_conserved(self, camera.sent - first_sent, receiver.counters, receiver.frames)

    def test_a_flood_of_another_sender_takes_few_frames(self):
        camera = Camera([20000])
        with Receiver(work_ms=0) as receiver:
            time.sleep(0.3)
            flood = Sender()
            until, message = time.monotonic() + 3, image_message(-1, 200)
            begin = camera.sent
            while time.monotonic() < until:
                flood.send(message)
                flood.send(message)
                time.sleep(0.001)
            sent = camera.sent - begin
            camera.stop()
            time.sleep(SETTLED)
            receiver.end()
        stamps = {frame[0] for frame in receiver.frames}
        answered = len([utime for utime in range(begin, begin + sent) if utime in stamps])
        print(f"{flood.number} messages of a flood; {answered} of {sent} frames handed out")
        self.assertGreater(flood.number, 10 * sent)
        self.assertGreaterEqual(answered, 0.9 * sent)
        self.assertGreaterEqual(receiver.counters["other_sender_frames"], flood.number / 2)


if __name__ == "__main__":
    own_network.run_tests_apart(lambda: None)
