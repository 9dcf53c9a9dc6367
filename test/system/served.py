"""A running `vdna serve`, and drives for it to show."""
import http.client
import json
import os
import queue
import shutil
import subprocess
import threading
import time
import urllib.parse

from ends_with_us import ENDS_WITH_US
from selectord import BIN, PATIENCE, vdna


CONDITIONS = ["summer", "winter", "night"]


def make_drives(work):
    """In the folder `work`: the map `map` of a drive under each condition, and `live`, one like the second
    of them on another day."""
    if os.path.exists(os.path.join(work, "live")):
        return
    shutil.rmtree(work, ignore_errors=True)
    drives = [os.path.join(work, name) for name in CONDITIONS]
    for drive, condition in zip(drives, CONDITIONS):
        vdna("simulate", drive, "--condition", condition, "--frames", 40)
    vdna("build", os.path.join(work, "map"), *drives)
    live = os.path.join(work, "live")
    vdna("simulate", live + ".part", "--condition", CONDITIONS[1], "--frames", 60, "--drive", 7,
         "--variation", 0.5)
    os.rename(live + ".part", live)


class Play:
    """`vdna play` of a folder, until it ends or the block does."""

    def __init__(self, folder, rate):
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, os.path.join(BIN, "vdna"), "play", folder, "--rate", str(rate)],
            stdout=subprocess.DEVNULL)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()


class Serve:
    """`vdna serve`; the constructor returns once it listens."""

    def __init__(self, *options, port=0):
        self._process = subprocess.Popen(
            [*ENDS_WITH_US, os.path.join(BIN, "vdna"), "serve", "--port", str(port), *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url = self._process.stdout.readline().strip()  # with the token
        if not self.url:
            raise AssertionError(f"vdna serve did not start: {self._process.communicate()[1]}")
        address = urllib.parse.urlsplit(self.url)
        self.port, self.token, self.pid = address.port, address.fragment, self._process.pid
        self.origin = f"http://127.0.0.1:{self.port}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.communicate()

    def stop(self):
        """End it as systemd or Ctrl-C would; its exit code and the seconds it took."""
        begin = time.monotonic()
        self._process.terminate()
        return self._process.wait(PATIENCE), time.monotonic() - begin

    def request(self, method, path, body=None, headers=None):
        """The status and the body of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        connection.request(method, path, body, headers or {})
        response = connection.getresponse()
        result = response.status, response.read()
        connection.close()
        return result

    def press(self, command):
        """Send a command as the page's button does; the status of the answer."""
        return self.request("POST", "/command", command,
                            {"Origin": self.origin, "X-Vdna-Token": self.token})[0]


class Viewer:
    """One that reads the events of a page's server."""

    def __init__(self, serve):
        self._connection = http.client.HTTPConnection("127.0.0.1", serve.port, timeout=PATIENCE)
        self._connection.request("GET", "/events")
        self._response = self._connection.getresponse()
        self._events = queue.Queue()
        self.newest = {}  # by kind
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        kind = None
        try:
            for line in self._response:
                name, _, value = line.decode().rstrip("\n").partition(": ")
                if name == "event":
                    kind = value
                elif name == "data":
                    self._events.put((kind, json.loads(value)))
        except (OSError, ValueError, AttributeError, http.client.HTTPException):
            pass  # the server or the test has ended
        finally:
            self._response.close()
            self._connection.close()

    def wait_for(self, kind, accept=lambda data: data is not None, seconds=PATIENCE):
        """The newest event of a kind, once it is one that `accept` accepts."""
        deadline = time.monotonic() + seconds
        while kind not in self.newest or not accept(self.newest[kind]):
            try:
                found, data = self._events.get(timeout=max(0, deadline - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"no such {kind} within {seconds} s; the newest is "
                                     f"{self.newest.get(kind)}") from None
            self.newest[found] = data
        return self.newest[kind]
