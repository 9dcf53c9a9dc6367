"""A drive past the daemon: pictures go out over LCM one by one, each as soon as the previous one is
answered, so that none is skipped."""
import re
import socket
import struct
import time
from pathlib import Path

from measure import waited
from selectord import Camera, image_message

PATIENCE = 120  # seconds
PERIOD_US = 100_000  # of the camera
FINGERPRINTS = Path(__file__).resolve().parents[2] / "lcmtypes" / "fingerprints.txt"
RESET = 1  # of vdna_msg.command_t


class Answers:
    """The daemon's output as datagrams: LCM's short messages on loopback."""

    def __init__(self):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        group, port = Camera.ADDRESS
        self._socket.bind((group, port))
        member = struct.pack("4s4s", socket.inet_aton(group), socket.inet_aton("127.0.0.1"))
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        self._socket.settimeout(PATIENCE)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def next_channel(self):
        """The channel of the next message."""
        return self._socket.recv(1 << 16)[8:].partition(b"\0")[0]


class Drive:
    """Frames one after the other; `asked` has (seconds until the answer, until the ranking or None,
    share of the time that daemon and bench waited for a processor)."""

    def __init__(self, camera, answers, daemon):
        self._camera, self._answers, self._daemon = camera, answers, daemon
        self.asked = []

    def ask(self, number, picture):
        """Send one picture, the number-th of the camera, and wait for its answer."""
        message = image_message(number * PERIOD_US, picture)
        before = sum(map(waited, (*self._daemon.pids, "self")))
        begin, ranked = time.perf_counter(), None
        self._camera.send(message)
        while (channel := self._answers.next_channel()) != b"VDNA_LOCALISATION":
            if channel == b"VDNA_RANKING":
                ranked = time.perf_counter() - begin
        seconds = time.perf_counter() - begin
        share = (sum(map(waited, (*self._daemon.pids, "self"))) - before) / seconds
        self.asked.append((seconds, ranked, share))
        return seconds


def reset_message():
    """A vdna_msg.command_t that makes the daemon choose again."""
    text = FINGERPRINTS.read_text(encoding="ascii")
    fingerprint = int(re.search(r"^vdna_msg\.command_t (\w+)$", text, re.M)[1], 16)
    return struct.pack(">QqiIx", fingerprint, 0, RESET, 1)
