"""The programs under test as objects: a running vdna_selectord and `vdna watch`.

VDNA_BIN is the folder of vdna and vdna_selectord.
"""
import contextlib
import io
import json
import os
import queue
import signal
import socket
import struct
import subprocess
import threading
import time
import unittest

from ends_with_us import ENDS_WITH_US

BIN = os.environ["VDNA_BIN"]
# LCM's default network is that of the namespace.
os.environ.pop("LCM_DEFAULT_URL", None)
SANITIZED = bool(os.environ.get("VDNA_SANITIZE"))  # so neither memory nor times are the daemon's own
SLOWER = 10 if SANITIZED else 1  # times may be longer by this
PATIENCE = 60  # seconds; an idle machine needs far less


def vdna(*arguments, check=True):
    """Run `vdna` to its end; the result has its standard output and error."""
    result = subprocess.run([os.path.join(BIN, "vdna"), *map(str, arguments)],
                            capture_output=True, text=True, timeout=10 * PATIENCE)
    if check and result.returncode != 0:
        raise AssertionError(f"vdna {' '.join(map(str, arguments))}: exit {result.returncode}: "
                             f"{result.stderr}")
    return result


def vdna_json(*arguments):
    """The output of `vdna ... --json`."""
    return json.loads(vdna(*arguments, "--json").stdout)


def jpegs_in(folder):
    """The contents of the folder's JPEG files, by name."""
    found = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".jpg"):
            with open(os.path.join(folder, name), "rb") as file:
                found.append(file.read())
    return found


class WithConfiguration(unittest.TestCase):
    """Tests that write a configuration into the folder `work`."""

    def configure(self, text):
        path = os.path.join(self.work, f"{self.id()}.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path


class WithLinkedMap(WithConfiguration):
    """Tests whose daemon opens `map`, a link, which use() replaces at once; at first `first_map`."""

    def setUp(self):
        self.map = os.path.join(self.work, f"{self.id()}.map")
        self.use(self.first_map)

    def use(self, path):
        os.symlink(path, self.map + ".new")
        os.rename(self.map + ".new", self.map)


def selectord(*arguments, environment=None):
    """Run vdna_selectord until it ends by itself; `environment` is added to this process's own."""
    return subprocess.run([os.path.join(BIN, "vdna_selectord"), *map(str, arguments)],
                          env={**os.environ, **(environment or {})},
                          capture_output=True, text=True, timeout=PATIENCE)


class _Lines:
    """The lines of a pipe, read by a thread so that a wait can time out."""

    def __init__(self, pipe):
        self._queue = queue.Queue()
        self._thread = threading.Thread(target=self._read, args=(pipe,), daemon=True)
        self._thread.start()

    def _read(self, pipe):
        with pipe:
            for line in pipe:
                self._queue.put(line)
        self._queue.put(None)

    def rest(self):
        """All lines not taken yet; waits until the other end is closed."""
        self._thread.join()
        return [line for line in self._queue.queue if line is not None]

    def next(self, deadline):
        """The next line; None at the end or past the deadline (time.monotonic())."""
        try:
            return self._queue.get(timeout=max(0, deadline - time.monotonic()))
        except queue.Empty:
            return None


class Selectord:
    """A running daemon; the constructor returns once it is READY.

    `program` replaces vdna_selectord; `environment` is added to this process's own; `prefix` is a
    command that executes the daemon in its place.
    """

    def __init__(self, *options, program=os.path.join(BIN, "vdna_selectord"), environment=None,
                 prefix=(), errors=subprocess.PIPE):
        begin = time.monotonic()
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, *prefix, program, *map(str, options)],
            env={**os.environ, **(environment or {})},
            stdout=subprocess.PIPE, stderr=errors, text=True)
        self.pid = self._process.pid
        self._output = _Lines(self._process.stdout)
        self._errors = _Lines(self._process.stderr or io.StringIO())
        self.log = []  # its standard error, after its end
        if not self._output.next(time.monotonic() + PATIENCE):
            self.__exit__()
            raise AssertionError(f"the daemon was never READY: {self.log}")
        self.ready_after = time.monotonic() - begin  # seconds
        # Its processes at this moment.
        self.pids = [pid for pid in (self.pid, network_process(self.pid)) if pid]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        self._output.rest()
        self.log += self._errors.rest()

    def is_running(self):
        return self._process.poll() is None

    def stop(self, number=signal.SIGTERM):
        """End it by a signal; return its exit code and the seconds it took."""
        begin = time.monotonic()
        self._process.send_signal(number)
        code = self._process.wait(PATIENCE)
        return code, time.monotonic() - begin


def kind_of(message):
    """The type of a message; a ranking that only repeats the choice is no "ranking"."""
    return "repeated ranking" if message.get("repeated") else message["type"]


class Watch:
    """`vdna watch --json`; the constructor returns once it listens."""

    def __init__(self):
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, os.path.join(BIN, "vdna"), "watch", "--json"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self._lines, self._errors = _Lines(self._process.stdout), _Lines(self._process.stderr)
        self.messages = []
        listening = self._errors.next(time.monotonic() + PATIENCE)
        if not listening or "listening" not in listening:
            self.__exit__()
            raise AssertionError(f"vdna watch does not listen: {listening}")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        self._lines.rest()
        self._errors.rest()

    def wait_for(self, kind, accept=lambda message: True, seconds=PATIENCE):
        """The next message of this kind that `accept` accepts. All others are kept."""
        deadline = time.monotonic() + seconds
        while (line := self._lines.next(deadline)) is not None:
            message = json.loads(line)
            self.messages.append(message)
            if kind_of(message) == kind and accept(message):
                return message
        raise AssertionError(f"no such {kind} within {seconds} s; the last messages were "
                             f"{self.messages[-3:]}")

    def collect(self, seconds):
        """Keep all messages of this time."""
        deadline = time.monotonic() + seconds
        while (line := self._lines.next(deadline)) is not None:
            self.messages.append(json.loads(line))

    def of(self, kind):
        """The messages of one kind received so far."""
        return [message for message in self.messages if kind_of(message) == kind]


class Listener:
    """The short messages of one channel, undecoded, received directly."""

    def __init__(self, channel):
        self._channel = channel.encode() + b"\0"
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._socket.bind(Camera.ADDRESS)
        group = socket.inet_aton(Camera.ADDRESS[0]) + socket.inet_aton("0.0.0.0")
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def next(self, seconds=PATIENCE):
        """The bytes of the next message."""
        deadline = time.monotonic() + seconds  # overall: other channels' messages also arrive
        while True:
            self._socket.settimeout(max(0.001, deadline - time.monotonic()))
            data = self._socket.recv(65536)
            if data[8:8 + len(self._channel)] == self._channel:
                return data[8 + len(self._channel):]


def answer_of(message):
    """Camera stamp, latency in microseconds and frames skipped of a localisation_t."""
    utime, = struct.unpack_from(">q", message, 8)
    return utime, *struct.unpack(">qq", message[-16:])


def memory_of(pid):
    """Memory of a process from /proc, in bytes: VmRSS, VmHWM, VmLck, ..."""
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        lines = [line.split() for line in file]
    return {line[0][:-1]: 1024 * int(line[1]) for line in lines if line[-1] == "kB"}


def network_process(daemon):
    """The id of the process that runs the network of a daemon; None if there is none."""
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
                parent = file.read().rpartition(")")[2].split()[1]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(parent) == daemon:
            return int(pid)
    return None


class Camera:
    """Bytes of any kind on a channel, in the format of LCM's short messages."""

    MAGIC = 0x4C433032
    ADDRESS = ("239.255.76.67", 7667)

    def __init__(self, channel="CAMERA"):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._channel = channel.encode()
        self._number = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def send_datagram(self, data):
        self._socket.sendto(data, self.ADDRESS)

    def send(self, message):
        """Send any bytes as one message."""
        header = struct.pack(">II", self.MAGIC, self._number)
        self._number += 1
        self.send_datagram(header + self._channel + b"\0" + message)

    def lose(self, messages):
        """Number messages that never come."""
        self._number += messages

    def send_jpeg(self, utime, data):
        """Send a well-formed camera message; its data need not be a JPEG."""
        self.send(image_message(utime, data))


def image_message(utime, data):
    """A bot_core.image_t that carries a JPEG."""
    fingerprint = 0x14739FFE13D5F5F0
    mjpg = int.from_bytes(b"MJPG", "little")
    return (struct.pack(">QqiiiIi", fingerprint, utime, 0, 0, 0, mjpg, len(data)) + data +
            struct.pack(">i", 0))


def grey_message(utime, pixels):
    """A bot_core.image_t of raw grey pixels in one row."""
    fingerprint = 0x14739FFE13D5F5F0
    grey = int.from_bytes(b"GREY", "little")
    width = height = int(len(pixels) ** 0.5)
    if width * height != len(pixels):
        width, height = len(pixels), 1
    return (struct.pack(">QqiiiIi", fingerprint, utime, width, height, width, grey, len(pixels)) +
            pixels + struct.pack(">i", 0))


class Frames:
    """Sends pictures, ten a second or `rate`, which `picture` gives by number, until the block ends."""

    def __init__(self, picture, rate=10):
        self._picture, self._stop, self._rate = picture, threading.Event(), rate
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.sent = 0

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()

    def _run(self):
        with Camera() as camera:
            while not self._stop.wait(1 / self._rate):
                camera.send(grey_message(self.sent * 1000000 // self._rate, self._picture(self.sent)))
                self.sent += 1


def lcm_log(path, events):
    """Write an LCM log: (channel, message) ten times a second."""
    with open(path, "wb") as file:
        for number, (channel, message) in enumerate(events):
            file.write(struct.pack(">IqqII", 0xEDA1DA01, number, number * 100000, len(channel),
                                   len(message)) + channel.encode() + message)
    return path


@contextlib.contextmanager
def logger(path):
    """lcm-logger, which records the camera's channel; it listens once this is entered."""
    with contextlib.suppress(FileNotFoundError):
        os.unlink(path)
    # By its path: the lcm-logger of `pip install lcm` is a script, which leaves its child behind.
    process = subprocess.Popen([os.environ["VDNA_LCM_LOGGER"], "--channel=CAMERA", "--force", path],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + PATIENCE
        while not joins_multicast(process.pid) and time.monotonic() < deadline:
            time.sleep(0.02)
        yield
        process.send_signal(signal.SIGINT)
        process.wait(PATIENCE)
    finally:
        process.kill()
        process.wait()


def joins_multicast(pid):
    """True if a process has a UDP socket at LCM's port."""
    with open("/proc/net/udp", encoding="ascii") as file:
        sockets = {line.split()[9] for line in file if ":1DF3 " in line}  # 7667
    try:
        files = [os.readlink(f"/proc/{pid}/fd/{name}") for name in os.listdir(f"/proc/{pid}/fd")]
    except FileNotFoundError:
        return False
    return any(f"socket:[{inode}]" in files for inode in sockets)


def command_message(utime, command, argument=b""):
    """A vdna_msg.command_t."""
    fingerprint = 0xD703A8025AC63713
    return struct.pack(">QqiI", fingerprint, utime, command, len(argument) + 1) + argument + b"\0"


def localisation_message(utime):
    """A vdna_msg.localisation_t that says WARMING_UP."""
    fingerprint = 0x7A3367ABC5866E67
    return struct.pack(">QqiI1sI1siqbqbI1s3ddbi4diqq", fingerprint, utime, 1, 1, b"\0", 1, b"\0",
                       -1, 0, 0, 0, 0, 1, b"\0", 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0)
