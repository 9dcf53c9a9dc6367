"""Our receiver and messages of ours with other versions of LCM, both ways: that of the build, which
vdna_transport sends with, and PyPI's.

$VDNA_WORK is the folder of the virtual environment that has it.
"""

import os
import subprocess
import time
import unittest
from pathlib import Path

import own_network
from ends_with_us import ENDS_WITH_US
from peers import LOCAL, STOCK, Machine, Receiver, address, cable, inside, send_frames
from tools import virtual_environment

ENVIRONMENT = Path(os.environ["VDNA_WORK"]) / "environment"
PYTHON = ENVIRONMENT / "bin/python"
SETTLED = 0.5
SIZES = (0, 100, 60000, 65400, 65500, 200000)
FOR_LCM = (100, 65400, 65500, 120000)  # no more fits into its buffer, unless the machine is told

SEND = """
import sys, time, lcm
from peers import image_message
network = lcm.LCM(sys.argv[1])
for utime, size in enumerate(map(int, sys.argv[2:])):
    network.publish("CAMERA", image_message(utime, size))
    time.sleep(0.05)
"""
LISTEN = """
import sys, select, lcm
from peers import image_message
network = lcm.LCM(sys.argv[1])
right = []
def on_frame(channel, data):
    utime = int.from_bytes(data[8:16], "big")
    size = int.from_bytes(data[32:36], "big")
    right.append((utime, size, data == image_message(utime, size)))
network.subscribe("CAMERA", on_frame)
print("READY", flush=True)
while not select.select([sys.stdin], [], [], 0)[0]:
    network.handle_timeout(50)
print(right)
"""


def python(code, *arguments, machine=None):
    return [*inside(machine), str(PYTHON), "-c", code, *map(str, arguments)]


class Versions(unittest.TestCase):

    def test_what_pypi_s_lcm_sends_we_receive(self):
        with Receiver(STOCK) as receiver:
            subprocess.run(python(SEND, STOCK, *SIZES), check=True)
            time.sleep(SETTLED)
            receiver.end()
        self.assertEqual([(utime, right) for utime, _, right in receiver.frames],
                         [(utime, 1) for utime in range(len(SIZES))])
        self.assertEqual((receiver.counters["lost"], receiver.counters["malformed"]), (0, 0))

    def test_what_the_lcm_of_the_build_sends_we_receive(self):
        for size in SIZES[1:]:
            with Receiver(STOCK) as receiver:
                send_frames(STOCK, 10, size, 20000)
                time.sleep(SETTLED)
                receiver.end()
            self.assertEqual([(utime, right) for utime, _, right in receiver.frames],
                             [(utime, 1) for utime in range(10)])

    def test_what_we_send_pypi_s_lcm_and_that_of_the_build_receive(self):
        for size in FOR_LCM:
            listener = subprocess.Popen([*ENDS_WITH_US, *python(LISTEN, STOCK)], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            self.assertEqual(listener.stdout.readline(), "READY\n")
            with Receiver(STOCK, "lcm") as other:
                send_frames(STOCK, 5, size, 50000)
                time.sleep(SETTLED)
                other.end()
            output, _ = listener.communicate()
            self.assertEqual(output, str([(utime, size, True) for utime in range(5)]) + "\n")
            self.assertEqual([(utime, right) for utime, _, right in other.frames],
                             [(utime, 1) for utime in range(5)])

    def test_between_machines_too(self):
        with Machine() as laptop:
            cable(None, "robot", laptop, "laptop")
            address(None, "robot", 1)
            address(laptop, "laptop", 2)
            with Receiver(LOCAL) as receiver:
                subprocess.run(python(SEND, LOCAL, *SIZES, machine=laptop), check=True)
                send_frames(LOCAL, 10, 100000, 20000, laptop)
                time.sleep(SETTLED)
                receiver.end()
        self.assertEqual([(utime, right) for utime, _, right in receiver.frames],
                         [(utime, 1) for utime in [*range(len(SIZES)), *range(10)]])


if __name__ == "__main__":
    own_network.run_tests_apart(lambda: virtual_environment(ENVIRONMENT, "lcm==1.5.3"))
