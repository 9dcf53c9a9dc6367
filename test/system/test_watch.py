"""`vdna watch` and those who listen late: a real daemon, with a network that needs no pictures.

The screens are printed, so `ctest -V -R system.watch` shows them.
Environment: VDNA_BIN (folder of the programs), VDNA_STUB_MAP and VDNA_UNRULY_BACKBONE (of
test/support/stub).
"""
import json
import os
import re
import shutil
import signal
import subprocess
import time

import own_network
from selectord import BIN, Camera, Frames, Selectord, Watch, WithConfiguration, vdna
from virtual_terminal import VirtualTerminal, width_of

WORK = os.path.abspath("watch")
MAP = os.path.join(WORK, "map")
WARMUP = 3
PICTURE = bytes(64 * 64)
LATE_SECONDS = 2  # a status, and with it the ranking, comes every second


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    subprocess.run([os.environ["VDNA_STUB_MAP"], MAP], check=True)


class WithDaemon(WithConfiguration):

    work = WORK

    def daemon(self, *options):
        return Selectord("--map", MAP, "--backbone", os.environ["VDNA_UNRULY_BACKBONE"],
                         "--warmup-frames", WARMUP, *options)


class TheRanking(WithDaemon):

    def test_is_there_for_whoever_comes_late(self):
        with self.daemon() as _, Watch() as early, Frames(lambda _: PICTURE):
            first = early.wait_for("ranking")
            early.wait_for("localisation", lambda answer: answer["validity"] != "WARMING_UP")
            with Watch() as late:
                again = late.wait_for("repeated ranking", seconds=LATE_SECONDS)
                self.assertEqual(late.of("ranking"), [])
            self.assertTrue(again["no_prediction"])
            self.assertGreaterEqual(again["margin_bins"], 0)
            self.assertEqual(again, {**first, "repeated": True})

    def test_is_not_repeated_in_a_warmup(self):
        with self.daemon() as daemon, Watch() as watch:
            for forget in (lambda: vdna("command", "reset"),
                           lambda: os.kill(daemon.pid, signal.SIGHUP)):  # opens the map again
                with Frames(lambda _: PICTURE):
                    self.assertFalse(watch.wait_for("ranking")["repeated"])
                    watch.wait_for("repeated ranking")
                forget()
                watch.wait_for("status", lambda status: status["experience"] == "")
                before = len(watch.messages)
                watch.collect(2.5)
                self.assertEqual({message["type"] for message in watch.messages[before:]},
                                 {"status"})

    def test_is_not_repeated_by_a_daemon_that_stands_by(self):
        with self.daemon() as _, Watch() as watch, Frames(lambda _: PICTURE):
            watch.wait_for("repeated ranking")
            with self.daemon() as _:
                watch.wait_for("status", lambda status: status["state"] == "STANDBY")
                before = len(watch.of("repeated ranking"))
                watch.collect(3)
            self.assertIn(len(watch.of("repeated ranking")) - before, (2, 3, 4))

    def test_is_no_new_choice_when_repeated(self):
        answers = os.path.join(WORK, "answers.jsonl")
        with self.daemon("--answers", answers) as daemon, Frames(lambda _: PICTURE):
            with Watch() as watch:
                watch.wait_for("repeated ranking")
            until = vdna("watch", "--until", "ranking", "--for", 2.5, check=False)
            self.assertEqual(until.returncode, 1, until.stderr)
            self.assertEqual(until.stdout.count("ranking "), 1, until.stdout)  # the first it saw
            daemon.stop()
        with open(answers, encoding="utf-8") as file:
            kept = [json.loads(line) for line in file]
        self.assertEqual([answer["repeated"] for answer in kept if answer["type"] == "ranking"],
                         [False])


class Screen(WithDaemon):

    def watch(self, *options, **terminal):
        return VirtualTerminal([os.path.join(BIN, "vdna"), "watch", *options], **terminal)

    def expect_fits(self, terminal):
        print("\n".join(["+" + "-" * terminal.columns + "+",
                         *(f"|{line}{' ' * (terminal.columns - width_of(line))}|"
                           for line in terminal.lines()),
                         "+" + "-" * terminal.columns + "+"]), flush=True)
        self.assertEqual(terminal.overflows, [])

    def test_follows_a_daemon_that_dies_and_returns(self):
        with self.watch() as terminal:
            terminal.wait_for(r"No daemon heard on udpm://239.255.76.67:7667\?ttl=0 for \d+ s")
            self.assertNotIn(25, terminal.modes)
            self.expect_fits(terminal)
            with self.daemon() as _:
                terminal.wait_for("WARMUP")
                self.expect_fits(terminal)
                with Frames(lambda _: PICTURE):
                    terminal.wait_for(r"> \w+ +[█▌]+ +\d+\.\d+ (bins|tied)")
                    terminal.wait_for(r"Margin +\d+\.\d+ bins, after 3 frames, by distance")
                    terminal.wait_for(r"Place .*frame \d+ of ")
                    terminal.wait_for(r"Camera +(9|10|11)\.\d frames/s, newest 0\.\d s ago")
                    terminal.wait_for(r"Latency +p50 \d+\.\d ms, p99 \d+\.\d ms")
                    terminal.wait_for(r"Memory +\d+ MB, at most \d+ MB")
                    self.expect_fits(terminal)
            terminal.wait_for("SILENT")
            terminal.wait_for(r"No daemon heard on \S+ for \d+\s+s: it has ended")
            with self.daemon() as _, Frames(lambda _: PICTURE):
                terminal.wait_for(r"> \w+ +[█▌]+")
            self.expect_fits(terminal)
            terminal.type("q")
            self.assertEqual(terminal.end(), 0)
            self.assertTrue(terminal.is_as_before())

    def test_fits_every_window(self):
        with self.daemon() as _, Frames(lambda _: PICTURE), self.watch() as terminal:
            terminal.wait_for(r"Margin +\d")
            for columns, rows in ((40, 10), (200, 60), (79, 23), (12, 3), (1, 1), (80, 24)):
                terminal.resize(columns, rows)
                terminal.read(1)
                self.expect_fits(terminal)
            terminal.wait_for(r"(?s)UNSURE.*Candidates.*> .*Margin.*Place.*Camera.*q ends")

    def test_gives_the_terminal_back(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGSEGV):
            with self.watch() as terminal:
                terminal.wait_for("WAITING")
                self.assertFalse(terminal.is_as_before())
                code = terminal.end(number)
                self.assertTrue(terminal.is_as_before(), number)
                self.assertEqual(code, 0 if number in (signal.SIGTERM, signal.SIGINT) else -number)
        with self.watch() as terminal:
            terminal.wait_for("WAITING")
            terminal.type("\x03")
            self.assertEqual(terminal.end(), 0)
            self.assertTrue(terminal.is_as_before())
        with self.watch("--for", 1) as terminal:
            self.assertEqual(terminal.end(), 0)
            self.assertTrue(terminal.is_as_before())

    def test_is_drawn_at_most_five_times_a_second(self):
        with self.daemon() as _, Frames(lambda _: PICTURE), self.watch() as terminal:
            terminal.wait_for(r"Margin +\d")
            terminal.seen = ""
            begin = time.monotonic()
            for columns in range(80, 120):  # as a window that is drawn larger by its corner
                terminal.resize(columns, 24)
                terminal.read(0.05)
            whole = terminal.seen.count("\x1b[2J")
            seconds = time.monotonic() - begin
        self.assertGreater(whole, 2)
        self.assertLessEqual(whole, 5 * seconds + 1)

    def test_is_in_ascii_and_without_colours_where_these_are_not_wanted(self):
        for environment, has_colours, has_utf8 in (
                ({}, True, True), ({"NO_COLOR": "1"}, False, True), ({"LC_ALL": "C"}, True, False)):
            with self.daemon() as _, Frames(lambda _: PICTURE), \
                    self.watch(environment=environment) as terminal:
                terminal.wait_for(r"> \w+ +[█#]+")
                self.assertEqual("\x1b[32m" in terminal.seen, has_colours)
                self.assertEqual(terminal.seen.isascii(), not has_utf8)
                self.expect_fits(terminal)

    def test_is_not_for_logs_pipes_and_programs(self):
        for options in (["--log"], ["--json"], ["--summary"], ["--until", "localisation:9"]):
            with self.daemon() as _, Frames(lambda _: PICTURE), \
                    self.watch("--for", 3, *options, columns=2000) as terminal:
                terminal.end()
                self.assertNotIn("\x1b", terminal.seen)
                self.assertIn("listening", terminal.seen)
                self.assertEqual(len(re.findall(r"^ranking ", terminal.seen, re.M)),
                                 0 if options == ["--json"] else 1, terminal.seen)
        with self.watch("--for", 1, environment={"TERM": "dumb"}) as terminal:
            terminal.end()
            self.assertNotIn("\x1b", terminal.seen)

    def test_nothing_in_a_message_controls_the_terminal(self):
        with Camera("VDNA_STATUS") as other, self.watch() as terminal:
            terminal.wait_for("WAITING")
            other.send(b"\x1b]0;title\x07 no status")
            terminal.wait_for("A message was left out: VDNA_STATUS: ")
            self.expect_fits(terminal)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
