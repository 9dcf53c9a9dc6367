"""Commands: what an operator tells the daemon, and what it answers.

Environment: VDNA_BIN (folder of the programs), VDNA_STUB_MAP and VDNA_UNRULY_BACKBONE (of
test/support/stub).
"""
import os
import shutil
import signal
import subprocess

import own_network
from selectord import Camera, Frames, Selectord, Watch, WithLinkedMap, command_message, vdna

WORK = os.path.abspath("commands")
SMALL, LARGE = (os.path.join(WORK, name) for name in ("small", "large"))
NAMES = ["spring", "winter", "autumn"]
UNRULY = os.environ["VDNA_UNRULY_BACKBONE"]
PICTURE = bytes(64 * 64)
RELOAD, SHADOW = 2, 6


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    for path, names in ((SMALL, NAMES[:2]), (LARGE, NAMES)):
        subprocess.run([os.environ["VDNA_STUB_MAP"], path, *names], check=True)


def drive(rate=10):
    return Frames(lambda _: PICTURE, rate)


class Commands(WithLinkedMap):

    work = WORK
    first_map = LARGE

    def daemon(self, settings=""):
        return Selectord("--map", self.map, "--backbone", UNRULY, "--warmup-frames", 3, "-c",
                         self.configure(settings))

    def command(self, *words, code=0):
        """What `vdna command` prints."""
        done = vdna("command", *words, check=False)
        self.assertEqual(done.returncode, code, done)
        return done.stdout + done.stderr

    def test_pin_localises_in_it_over_resets_until_it_is_unpinned(self):
        with Watch() as watch, self.daemon(), drive():
            first, *others = [entry["experience"] for entry in watch.wait_for("ranking")["ranking"]]
            pinned = others[-1]
            self.assertIn(pinned + " is pinned", self.command("pin", pinned))
            watch.wait_for("localisation", lambda answer: answer["experience"] == pinned)
            status = watch.wait_for("status", lambda status: status["pinned"] == pinned)
            self.assertEqual(status["experience"], pinned)
            self.assertIn("unpin it first", self.command("exclude", pinned, code=1))
            self.assertIn("the map has " + ", ".join(sorted(NAMES)),
                          self.command("pin", "nowhere", code=1))
            seen = len(watch.of("localisation"))
            self.command("reset")
            ranking = watch.wait_for("ranking", lambda ranking: ranking["previous"] == "" and
                                     len(watch.of("localisation")) > seen + 3)
            self.assertEqual(ranking["ranking"][0]["experience"], first)
            self.assertEqual({answer["experience"] for answer in watch.of("localisation")[seen:]},
                             {pinned})
            self.assertIn("localising in " + first, self.command("pin"))
            watch.wait_for("localisation", lambda answer: answer["experience"] == first)
            results = watch.of("result")
        self.assertEqual([(result["command"], result["accepted"]) for result in results[:4]],
                         [("pin", True), ("exclude", False), ("pin", False), ("reset", True)])
        self.assertEqual({result["map_hash"] for result in results}, {status["map_hash"]})

    def test_exclude_chooses_among_the_rest_and_leaves_one(self):
        with Watch() as watch, self.daemon(), drive():
            names = [entry["experience"] for entry in watch.wait_for("ranking")["ranking"]]
            self.command("exclude", names[0])
            ranking = [entry["experience"] for entry in watch.wait_for("ranking")["ranking"]]
            self.assertEqual(ranking, names[1:] + names[:1])
            watch.wait_for("localisation", lambda answer: answer["experience"] == names[1])
            status = watch.wait_for("status", lambda status: status["excluded"])
            self.assertEqual((status["excluded"], status["experience"]), (names[:1], names[1]))
            self.command("exclude", names[2])
            self.assertIn("the only experience", self.command("exclude", names[1], code=1))
            self.assertIn("include it first", self.command("pin", names[0], code=1))
            self.command("include", names[0])
            watch.wait_for("status", lambda status: status["excluded"] == [names[2]])
            self.command("include")
            watch.wait_for("status", lambda status: status["excluded"] == [])

    def test_shadow_keeps_the_choice_over_reset_and_reload(self):
        with Watch() as watch, self.daemon("[select]\nshadow = true\n"), drive():
            choice = watch.wait_for("ranking")["ranking"][0]["experience"]
            self.assertTrue(watch.wait_for("status")["shadow"])
            self.command("reload")
            self.command("reset")
            seen = len(watch.of("localisation"))
            watch.collect(1)
            self.assertEqual({answer["experience"] for answer in watch.of("localisation")[seen:]},
                             {choice})
            self.command("shadow", "off")
            watch.wait_for("status", lambda status: not status["shadow"])

    def test_reload_is_answered_when_it_has_ended(self):
        self.use(SMALL)
        with Watch() as watch, self.daemon("[select]\npin = 'winter'\n") as daemon, drive():
            answer = watch.wait_for("localisation")  # the first one
            self.assertEqual(answer["experience"], "winter")
            self.use(LARGE)
            self.assertIn("3 experiences", self.command("reload"))
            large = watch.wait_for("result")
            status = watch.wait_for("status", lambda status: status["experiences"] == 3)
            self.assertEqual((large["map_hash"], status["pinned"]), (status["map_hash"], "winter"))
            self.command("pin", "autumn")
            self.use(SMALL)
            self.assertIn("autumn is no longer pinned", self.command("reload"))
            watch.wait_for("status", lambda status: status["pinned"] == "")
            self.use("/nowhere")
            self.assertIn("the old map serves", self.command("reload", code=1))
            os.kill(daemon.pid, signal.SIGHUP)
            result = watch.wait_for("result", lambda result: result["utime"] == 0)
            self.assertEqual((result["command"], result["accepted"]), ("reload", False))
            self.assertIn("the old map serves", result["text"])

    def skipped_over_reloads(self):
        """How many of the frames of a camera at 30 Hz are not answered, and so declared, while the map
        is opened again and again."""
        with Watch() as watch, self.daemon():
            with drive(rate=30) as frames:
                watch.wait_for("ranking")
                for path in (SMALL, LARGE, SMALL):
                    self.use(path)
                    self.command("reload")
                    watch.collect(0.3)
            status = watch.wait_for("status", lambda status: status["received"] == frames.sent)
        self.assertGreater(frames.sent, 30)
        self.assertEqual((status["refused"], status["lost"]), (0, 0))
        answers = watch.of("localisation")
        self.assertEqual(len(answers), status["processed"])
        self.assertEqual(len(answers) + status["skipped"], frames.sent)
        return status["skipped"]

    def test_a_reload_at_30_hz_loses_no_frame(self):
        """A busy machine may skip a frame now and then; one that a reload costs would be missing each time."""
        skipped = [self.skipped_over_reloads()]
        while skipped[-1] > 0 and len(skipped) < 5:
            skipped.append(self.skipped_over_reloads())
        print(f"frames skipped over three reloads, in each attempt: {skipped}")
        self.assertEqual(skipped[-1], 0)

    def test_what_is_no_command_is_refused_and_ends_nothing(self):
        with Watch() as watch, self.daemon() as daemon, Camera("VDNA_COMMAND") as operator:
            operator.send(b"no command")
            watch.wait_for("status", lambda status: status["rejected"] == 1)
            for utime, command, argument, words in (
                    (1, 77, b"", "command 77 is not known"), (2, -1, b"", "command -1"),
                    (3, 3, b"x" * 60000, "of 60000 bytes"), (4, 4, b"\x1b[31m\xff", "not a name"),
                    (5, 4, b"", "no experience"), (6, SHADOW, b"", "expected on or off")):
                operator.send(command_message(utime, command, argument))
                result = watch.wait_for("result")
                self.assertEqual((result["utime"], result["accepted"]), (utime, False))
                self.assertIn(words, result["text"])
            for number in range(200):
                operator.send(command_message(number, RELOAD))
            self.assertTrue(self.command("shadow", "off"))
            self.assertTrue(daemon.is_running())

    def test_without_a_daemon_nobody_answers(self):
        self.assertIn("no vdna_selectord has answered",
                      self.command("reset", "--timeout", "0.3", code=1))
        self.command("reset", "--no-wait")
        for words in (("exclude",), ("shadow", "perhaps"), ("reset", "winter"), ("explode",)):
            self.command(*words, code=2)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
