"""A camera that sends 30 frames a second, received or not."""
import threading
import time

PERIOD = 1 / 30  # seconds
PERIOD_US = round(PERIOD * 1e6)


class Camera30:
    """Sends pictures in turn from a thread, stamped at a regular beat, until the block ends."""

    def __init__(self, camera, pictures):
        self._camera, self._pictures = camera, pictures
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.sent = 0

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()

    def _run(self):
        next_time = time.monotonic()
        while not self._stop.wait(max(0, next_time - time.monotonic())):
            self._camera.send_jpeg(self.sent * PERIOD_US,
                                   self._pictures[self.sent % len(self._pictures)])
            self.sent += 1
            next_time += PERIOD
