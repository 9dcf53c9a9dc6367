"""A network of the user's own, apps/examples/grey_levels.c, in the tools and the daemon.

Environment: VDNA_BIN (folder of the programs), VDNA_GREY_LEVELS (the plug-in).
"""
import os
import shutil
import unittest

from selectord import WithConfiguration, selectord, vdna, vdna_json

WORK = os.path.abspath("plugin")
MAP = os.path.join(WORK, "map")
GREY_LEVELS = os.environ["VDNA_GREY_LEVELS"]


class Plugin(WithConfiguration):

    work = WORK

    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        drives = [os.path.join(WORK, condition) for condition in ("summer", "night")]
        for drive in drives:
            vdna("simulate", drive, "--condition", os.path.basename(drive), "--frames", 10)
        vdna("build", MAP, *drives, "--backbone", GREY_LEVELS)

    def test_its_map_carries_its_name_and_taps(self):
        for experience in vdna_json("info", MAP)["experiences"]:
            self.assertEqual(experience["backbone"], "grey_levels")
            self.assertEqual(experience["taps"], "levels:16:1")
            self.assertEqual(experience["dim"], 16)

    def test_its_ranking_tells_night_from_day(self):
        live = os.path.join(WORK, "live")
        vdna("simulate", live, "--condition", "night", "--frames", 10, "--drive", 7)
        ranked = vdna_json("rank", live, MAP, "--warmup", 10, "--backbone", GREY_LEVELS)
        self.assertEqual([place["experience"] for place in ranked["ranking"]], ["night", "summer"])

    def test_the_daemon_takes_it_from_its_file_and_from_the_command_line(self):
        path = self.configure(f'[backbone]\nmanifest = "{GREY_LEVELS}"\n')
        for options in (["-c", path], ["--backbone", GREY_LEVELS]):
            done = selectord("--map", MAP, "--check", *options)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("backbone grey_levels fits", done.stdout)

    def test_a_map_of_another_network_is_refused_by_name(self):
        done = selectord("--map", MAP, "--check", "--backbone", "efficientnet_lite0")
        self.assertEqual(done.returncode, 1)
        self.assertIn("grey_levels", done.stderr)

    def test_what_is_no_plugin_is_one_clear_error(self):
        for name, words in (("grey_levels.so", "./grey_levels.so"), ("/nowhere/mine.so", "No such"),
                            ("grey_levels", "of a plug-in (./libNAME.so)")):
            for done in (selectord("--map", MAP, "--check", "--backbone", name),
                         vdna("rank", MAP, MAP, "--backbone", name, check=False)):
                self.assertEqual(done.returncode, 1)
                self.assertEqual(done.stderr.count("\n"), 1)
                self.assertIn(words, done.stderr)

    def test_what_its_network_is_given_is_not_shown(self):
        done = vdna("model", "inputs", GREY_LEVELS, os.path.join(WORK, "night"), "--npy",
                    os.path.join(WORK, "inputs.npy"), check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("does not show what its network is given", done.stderr)


if __name__ == "__main__":
    unittest.main()
