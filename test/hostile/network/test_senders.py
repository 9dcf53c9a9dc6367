"""Who may send: this machine alone with the stock URL, whatever the others try; with another URL those
that are listed, or all.
"""

import socket
import struct
import subprocess
import sys
import time
import unittest

import own_network
from peers import GROUP, LOCAL, STOCK, Machine, Receiver, address, cable, image_message, inside
from peers import Sender

ROBOT, LAPTOP = "10.9.0.1", "10.9.0.2"
PRELUDE = "from peers import *\nfrom test_senders import *\n"
SETTLED = 0.3  # seconds after which what was sent has come


def checksum(header):
    total = sum(struct.unpack(f">{len(header) // 2}H", header))
    return ~(total + (total >> 16)) & 0xffff


def spoof(source, message):
    """Send a short message with another machine's address as its sender."""
    content = struct.pack(">II", 0x4C433032, 1000) + b"CAMERA\0" + message
    udp = struct.pack(">HHHH", 7000, GROUP[1], 8 + len(content), 0) + content
    ends = socket.inet_aton(source) + socket.inet_aton(GROUP[0])
    start = struct.pack(">BBHHHBB", 0x45, 0, 20 + len(udp), 1, 0, 1, 17)
    header = start + struct.pack(">H", checksum(start + bytes(2) + ends)) + ends
    with socket.socket(socket.AF_PACKET, socket.SOCK_RAW) as raw:
        raw.bind(("laptop", 0))
        raw.send(bytes.fromhex("01005e7f4c43 020000000001 0800") + header + udp)


class Senders(unittest.TestCase):

    def setUp(self):
        self.laptop = self.enterContext(Machine())
        cable(None, "robot", self.laptop, "laptop")
        address(None, "robot", 1)
        address(self.laptop, "laptop", 2)

    def on_laptop(self, code):
        subprocess.run([*inside(self.laptop), sys.executable, "-c", PRELUDE + code], check=True)

    def received(self, url, *sources):
        """The stamps that come of frames 1 (from here) and 2 (from the laptop), and the counters."""
        with Receiver(url, sources=sources, work_ms=1) as receiver:
            self.on_laptop("Sender(ttl=1).send(image_message(2, 100))")
            Sender(ttl=0).send(image_message(1, 100))
            time.sleep(SETTLED)
            receiver.end()
        return sorted(utime for utime, _, _ in receiver.frames), receiver.counters

    def test_with_the_stock_url_only_this_machine_may_send(self):
        stamps, counters = self.received(STOCK)
        self.assertEqual((stamps, counters["foreign"]), ([1], 1))

    def test_with_another_url_all_machines_may(self):
        stamps, counters = self.received(LOCAL)
        self.assertEqual((stamps, counters["foreign"]), ([1, 2], 0))

    def test_of_a_list_of_senders_only_these_and_this_machine_may(self):
        for url in (STOCK, LOCAL):
            stamps, counters = self.received(url, "10.9.0.7", LAPTOP)
            self.assertEqual((stamps, counters["foreign"]), ([1, 2], 0))
            stamps, counters = self.received(url, "10.9.0.7")
            self.assertEqual((stamps, counters["foreign"]), ([1], 1))

    def test_an_address_that_the_machine_got_later_is_its_own(self):
        with Receiver(STOCK, work_ms=1) as receiver:
            subprocess.run("ip addr del 10.9.0.1/24 dev robot; ip addr add 10.9.0.9/24 dev robot;"
                           "ip route replace 224.0.0.0/4 dev robot", shell=True, check=True)
            time.sleep(1.1)  # own addresses are read once a second
            Sender().send(image_message(1, 100))
            time.sleep(SETTLED)
            receiver.end()
        self.assertEqual([utime for utime, _, _ in receiver.frames], [1])

    def test_unicast_never_comes_in(self):
        for url in (STOCK, LOCAL):
            with Receiver(url) as receiver:
                self.on_laptop(f"Sender(to=({ROBOT!r}, 7667)).send(image_message(2, 100))")
                for own in (ROBOT, "127.0.0.1"):
                    Sender(to=(own, 7667)).send(image_message(1, 100))
                time.sleep(SETTLED)
                receiver.end()
            self.assertEqual((receiver.frames, receiver.counters["foreign"]), ([], 0))

    def test_a_forged_sender_does_not_get_in(self):
        with Receiver(STOCK) as receiver:
            for forged in (ROBOT, "127.0.0.1", "127.1.2.3", "0.0.0.0"):
                self.on_laptop(f"spoof({forged!r}, image_message(2, 100))")
            time.sleep(SETTLED)
            receiver.end()
        self.assertEqual(receiver.frames, [])
        # That the packets are good, the same with an address that may send shows.
        with Receiver(LOCAL) as receiver:
            self.on_laptop("spoof('10.9.0.44', image_message(2, 100))")
            time.sleep(SETTLED)
            receiver.end()
        self.assertEqual([utime for utime, _, _ in receiver.frames], [2])

    def test_two_datagrams_end_nothing_wherever_they_come_from(self):
        attack = ("head = lambda offset, number, data: struct.pack('>IIIIHH', 0x4C433033, 7, 100000,"
                  " offset, number, 3) + data\n"
                  "sender = Sender(ttl=1)\n"
                  "sender.raw(head(0, 0, b'CAMERA\\0' + b'x' * 100))\n"
                  "sender.raw(head(0xffffff00, 1, b'y' * 0x200))\n")
        for url, malformed in ((STOCK, 1), (LOCAL, 2)):
            with Receiver(url) as receiver:
                self.on_laptop(attack)
                subprocess.run([sys.executable, "-c", PRELUDE + attack], check=True)
                Sender().send(image_message(1, 100))
                time.sleep(SETTLED)
                receiver.end()
            self.assertEqual([utime for utime, _, _ in receiver.frames], [1])
            self.assertEqual(receiver.counters["malformed"], malformed)


if __name__ == "__main__":
    own_network.run_tests_apart(lambda: None)
