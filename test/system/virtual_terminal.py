"""A terminal for programs under test: a pseudo-terminal, and what a person would see on it.

Only what our programs send is understood: UTF-8, positions, erasing, and modes that are set and reset.

    virtual_terminal.py SECONDS COMMAND...

runs a command for so long, in 80 x 24, and prints its screen.
"""
import codecs
import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
import time
import unicodedata

from ends_with_us import ENDS_WITH_US

_SEQUENCE = re.compile(r"\x1b\[(\??)([0-9;]*)([A-Za-z])")
_UNFINISHED = re.compile(r"\x1b(\[\??[0-9;]*)?\Z")
_CURSOR, _WRAPPING, _OTHER_PAGE = 25, 7, 1049
_NORMALLY = {_CURSOR, _WRAPPING}


def width_of(text):
    """Cells that a text takes."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    return len(text) - sum(map(bool, map(unicodedata.combining, text))) + wide


class VirtualTerminal:
    """A program on a terminal of its own. `environment` is added to this process's own."""

    def __init__(self, command, columns=80, rows=24, environment=None):
        self._master, slave = pty.openpty()
        self.modes = set(_NORMALLY)
        self.overflows = []  # what was written beyond the right or lower edge
        self.seen = ""       # everything that came
        self._pending, self._decoder = "", codecs.getincrementaldecoder("utf-8")()
        self._keyboard = termios.tcgetattr(slave)
        self._resize(columns, rows)
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, *map(str, command)], stdin=slave, stdout=slave, stderr=slave,
            env={**os.environ, "TERM": "xterm", "LC_ALL": "C.UTF-8", **(environment or {})},
            start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        self._slave = slave  # kept open, to ask for its state after the program's end
        self.pid = self._process.pid

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        os.close(self._slave)
        os.close(self._master)

    def _resize(self, columns, rows):
        self.columns, self.rows = columns, rows
        self._cells = [[" "] * columns for _ in range(rows)]
        self._at = [0, 0]
        fcntl.ioctl(self._master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def resize(self, columns, rows):
        """As a person does with a window; the program is told."""
        self.read(0)
        self._resize(columns, rows)

    def type(self, keys):
        os.write(self._master, keys.encode())

    def end(self, number=None, seconds=20):
        """Send a signal, if any, and wait for the program's end; its exit code."""
        if number is not None:
            self._process.send_signal(number)
        deadline = time.monotonic() + seconds
        while self._process.poll() is None and time.monotonic() < deadline:
            self.read(0.05)
        self.read(0.05)
        return self._process.wait(1)

    def is_as_before(self):
        """Whether a shell would find the terminal as it was."""
        return self.modes == _NORMALLY and termios.tcgetattr(self._slave) == self._keyboard

    def read(self, seconds):
        """Take what comes in this time."""
        deadline = time.monotonic() + seconds
        while select.select([self._master], [], [], max(0, deadline - time.monotonic()))[0]:
            self._take(self._decoder.decode(os.read(self._master, 65536)))

    def lines(self):
        """What is on the screen, without blanks at the ends of lines."""
        return ["".join(row).rstrip() for row in self._cells]

    def wait_for(self, pattern, seconds=30):
        """Wait until the screen has a match; return it."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            if found := re.search(pattern, "\n".join(self.lines())):
                return found
            self.read(0.1)
        raise AssertionError(f"no {pattern!r} within {seconds} s; the screen is\n" +
                             "\n".join(self.lines()))

    def _take(self, text):
        self.seen += text
        text = self._pending + text
        self._pending = ""
        if unfinished := _UNFINISHED.search(text):
            self._pending, text = unfinished[0], text[:unfinished.start()]
        end = 0
        for sequence in _SEQUENCE.finditer(text):
            self._write(text[end:sequence.start()])
            self._obey(*sequence.groups())
            end = sequence.end()
        self._write(text[end:])

    def _write(self, text):
        for letter in text:
            row, column = self._at
            if letter in "\r\n":
                self._at = [row, 0] if letter == "\r" else [min(row + 1, self.rows - 1), column]
            elif unicodedata.category(letter) == "Cc":
                raise AssertionError(f"control character {letter!r} in {text!r}")
            elif row >= self.rows or column + width_of(letter) > self.columns:
                self.overflows.append((self._at, text))
            else:
                self._cells[row][column:column + width_of(letter)] = \
                    [letter, *[""] * (width_of(letter) - 1)]
                self._at[1] += width_of(letter)

    def _obey(self, private, numbers, letter):
        numbers = [int(number) for number in numbers.split(";") if number]
        if private and letter in "hl":
            (self.modes.update if letter == "h" else self.modes.difference_update)(numbers)
        elif letter == "H":
            self._at = [number - 1 for number in numbers or (1, 1)]
        elif letter == "K" and self._at[0] < self.rows:
            row, column = self._at
            self._cells[row][column:] = [" "] * (self.columns - column)
        elif letter == "J":
            self._cells = [[" "] * self.columns for _ in range(self.rows)]
        elif letter != "m":
            raise AssertionError(f"unknown sequence {letter} {numbers}")


if __name__ == "__main__":
    with VirtualTerminal(sys.argv[2:]) as shown:
        shown.read(float(sys.argv[1]))
        print("\n".join(shown.lines()))
