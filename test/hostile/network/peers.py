"""Machines on a network: namespaces joined by virtual cables, and programs that run in them.

$VDNA_SEND_FRAMES, $VDNA_RECEIVE_FRAMES and $VDNA_IMPAIR are the programs.
"""

import json
import os
import socket
import struct
import subprocess
import threading
import time

from ends_with_us import ENDS_WITH_US

GROUP = ("239.255.76.67", 7667)
STOCK = "udpm://239.255.76.67:7667?ttl=0"
LOCAL = "udpm://239.255.76.67:7667?ttl=1"


def run(*command):
    subprocess.run([str(part) for part in command], check=True)


class Machine:
    """A network namespace; None is that of the test."""

    def __init__(self):
        self._process = subprocess.Popen([*ENDS_WITH_US, "unshare", "-n", "sleep", "infinity"])
        self.pid = self._process.pid
        ours = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.pid}/ns/net") == ours:
            time.sleep(0.01)
        self.run("ip", "link", "set", "lo", "up")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()

    def inside(self):
        return ["nsenter", "-t", str(self.pid), "-n"]

    def run(self, *command):
        run(*self.inside(), *command)


def inside(machine):
    return machine.inside() if machine else []


def cable(one, name, other, other_name):
    """Join two machines. Packets of 64 kB are not split, so that one is one datagram."""
    run("ip", "link", "add", name, "mtu", 65535, "type", "veth", "peer", "name", other_name, "mtu",
        65535)
    for machine, end in ((one, name), (other, other_name)):
        if machine:
            run("ip", "link", "set", end, "netns", machine.pid)
        run(*inside(machine), "ip", "link", "set", end, "up")


def address(machine, name, number):
    """An address on an interface, by which multicast goes out."""
    run(*inside(machine), "ip", "addr", "add", f"10.9.0.{number}/24", "dev", name)
    run(*inside(machine), "ip", "route", "replace", "224.0.0.0/4", "dev", name)


class _Program:
    """A program that says READY and ends with its standard input."""

    def __init__(self, command, machine=None):
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, *inside(machine), *map(str, command)], text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.pid = self._process.pid
        first = self._process.stdout.readline()
        if first != "READY\n":
            raise AssertionError(f"{command} said {first!r}")
        self._lines = []
        # Its output is read while it runs: it must not wait for us.
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with self._process.stdout as output:
            self._lines.extend(line.rstrip("\n") for line in output)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.stdin.close()
        self._process.wait()
        self._reader.join()

    def signal(self, number):
        self._process.send_signal(number)

    def end(self):
        """The rest of its output, without the last line, and that, as JSON."""
        self._process.stdin.close()
        self._reader.join()
        if self._process.wait() != 0:
            raise AssertionError(f"exit {self._process.returncode}")
        return self._lines[:-1], json.loads(self._lines[-1])


class Receiver(_Program):
    """receive_frames."""

    def __init__(self, url=STOCK, kind="ours", max_bytes=1 << 20, work_ms=0, sources=(),
                 machine=None):
        super().__init__([os.environ["VDNA_RECEIVE_FRAMES"], kind, url, max_bytes, work_ms,
                          *sources], machine)

    def end(self):
        """The frames, as (stamp, age in microseconds, whether it is right), and the counters."""
        lines, self.counters = super().end()
        self.frames = [tuple(map(int, line.split())) for line in lines if line[0] != "#"]
        self.changed = [line for line in lines if line[0] == "#"]
        return self


class Impairment(_Program):
    """impair, between two interfaces of the test's namespace."""

    def __init__(self, one, other, seed, percent, receiver):
        super().__init__([os.environ["VDNA_IMPAIR"], one, other, seed, *percent, receiver.pid])


def send_frames(url, count, size, interval_us, machine=None, reader=None):
    """With `reader`, an Impairment, wait for it after each frame."""
    run(*inside(machine), os.environ["VDNA_SEND_FRAMES"], url, count, size, interval_us,
        *([reader.pid] if reader else []))


FINGERPRINT, GREY = 0x14739FFE13D5F5F0, 1497715271


def image_message(utime, size):
    """A bot_core.image_t with the bytes of frames.h."""
    mask = (1 << 64) - 1
    data = bytearray()
    for at in range(0, size, 8):
        x = ((utime + 1) * 0x9E3779B97F4A7C15 + at * 0xBF58476D1CE4E5B9) & mask
        data += ((x ^ x >> 29) * 0x94D049BB133111EB & mask).to_bytes(8, "little")
    return struct.pack(">QqiiiIi", FINGERPRINT, utime, size, 1, 0, GREY, size) + data[:size] + bytes(4)


class Sender:
    """Messages in datagrams made here."""

    def __init__(self, to=GROUP, ttl=0):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        self._to = to
        self.number = 0

    def __del__(self):
        self._socket.close()

    def raw(self, datagram):
        self._socket.sendto(datagram, self._to)

    def datagrams(self, message, channel="CAMERA", fragment=None):
        """Those of one message; fragments have that many bytes."""
        content = channel.encode() + b"\0" + message
        number, self.number = self.number, self.number + 1
        if not fragment:
            return [struct.pack(">II", 0x4C433032, number) + content]
        count = -(-len(content) // fragment)
        name = len(channel) + 1
        return [struct.pack(">IIIIHH", 0x4C433033, number, len(message), max(0, i * fragment - name),
                            i, count) + content[i * fragment:(i + 1) * fragment]
                for i in range(count)]

    def send(self, message, channel="CAMERA", fragment=None):
        for datagram in self.datagrams(message, channel, fragment):
            self.raw(datagram)
