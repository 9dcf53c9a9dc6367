"""System test of the live page in a real browser: headless Chromium at the width of a desk and of a
phone, light and dark.

Environment: VDNA_BIN (folder of the programs); VDNA_SHOTS (where screenshots go, if set). Exit code 77 =
skipped: there is no chromium.
"""
import os
import sys
import time
import unittest

import own_network
from browser import PROGRAM, Browser
from selectord import Selectord
from served import Play, Serve, make_drives

WORK = os.path.abspath("page")
MAP = os.path.join(WORK, "map")
LIVE = os.path.join(WORK, "live")
SHOTS = os.environ.get("VDNA_SHOTS")
WIDTHS = (1280, 390)  # CSS pixels
SHIFT_MAX = 0.02      # cumulative layout shift; below 0.1 is good, says web.dev
OPTIONS = ("--map", MAP, "--warmup-frames", 12)

# Sums the layout shifts from the first one on.
WATCH_SHIFTS = """window.shift = 0; window.shifted = []; new PerformanceObserver(list => {
  for (const entry of list.getEntries()) {
    shift += entry.value;
    for (const {node, previousRect: was, currentRect: is} of entry.sources)
      shifted.push([(node?.parentElement ?? node)?.outerHTML?.slice(0, 60), node?.nodeName, JSON.stringify(was), JSON.stringify(is)]);
  }
}).observe({type: "layout-shift", buffered: true});"""

# Texts with less contrast than WCAG 2 AA asks for: 4.5, or 3 if they are large.
WEAK_TEXTS = """(() => {
  const numbers = colour => colour.match(/[\\d.]+/g).map(Number);
  const luminance = colour => numbers(colour).slice(0, 3).map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const background = element => {
    for (; element; element = element.parentElement) {
      const colour = getComputedStyle(element).backgroundColor;
      if ((numbers(colour)[3] ?? 1) > 0) return colour;
    }
    return "rgb(255, 255, 255)";
  };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; node = walker.nextNode();) {
    const element = node.parentElement, style = getComputedStyle(element);
    if (!node.data.trim() || !element.checkVisibility() || ["SCRIPT", "STYLE"].includes(element.tagName)) continue;
    const [a, b] = [luminance(style.color), luminance(background(element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const size = parseFloat(style.fontSize), bold = style.fontWeight >= 700;
    if (ratio < (size >= 24 || (bold && size >= 18.66) ? 3 : 4.5)) found.push(`${node.data}: ${ratio.toFixed(2)}`);
  }
  return found;
})()"""

# A ranking as a later daemon sends it.
PREDICTED = """{"validity": "VALID", "window_frames": 40, "margin_bins": 2.3, "ranked_by": "transfer", "neurons": 1280, "reasons": [
  {"tap": "embedding", "neuron": 512, "bins": 0.46, "live_bin": 100.4, "winner_bin": 110, "runner_up_bin": 400.6,
   "winner_most": 7, "winner_least": 9, "runner_up_most": 11, "runner_up_least": 0},
  {"tap": "embedding", "neuron": 3, "bins": -0.23, "live_bin": 20, "winner_bin": 30, "runner_up_bin": 10,
   "winner_most": -1, "winner_least": -1, "runner_up_most": -1, "runner_up_least": -1}], "ranking": [
  {"experience": "winter", "distance_bins": 7.4, "predicted_recall": 0.94, "predicted_low": 0.88, "predicted_high": 0.97},
  {"experience": "summer", "distance_bins": 9.7, "tied": true, "predicted_recall": 0.61, "predicted_low": 0.5, "predicted_high": 0.7},
  {"experience": "night", "distance_bins": 12.5, "predicted_recall": null}]}"""


def text_of(identity):
    return f"document.getElementById('{identity}').innerText"


class Page(unittest.TestCase):
    def setUp(self):
        self.serve = self.enterContext(Serve("--map", MAP))
        self.browser = self.enterContext(Browser())
        self.browser.call("Page.addScriptToEvaluateOnNewDocument", source=WATCH_SHIFTS)
        self.browser.resize(WIDTHS[0])

    def tearDown(self):
        self.assertEqual(self.browser.complaints, [])
        ours = (self.serve.origin, "data:", "about:")
        self.assertEqual([url for url in self.browser.requested if not url.startswith(ours)], [])

    def open(self, url=None):
        self.browser.open("about:blank")  # else what follows # alone would load nothing anew
        self.browser.open(url or self.serve.url)
        self.browser.wait_for("typeof state !== 'undefined' && state.pulse && state.commands")

    def shoot(self, name):
        if SHOTS:
            os.makedirs(SHOTS, exist_ok=True)
            self.browser.screenshot(os.path.join(SHOTS, name + ".png"))

    def expect_readable(self, name):
        """Light and dark: enough contrast, and nothing wider than the window."""
        for scheme in ("light", "dark"):
            self.browser.prefer(scheme)
            time.sleep(0.4)  # bars move
            self.shoot(f"{name}-{scheme}")
            self.assertEqual(self.browser.value(WEAK_TEXTS), [], f"{name}, {scheme}")
            self.assertLessEqual(self.browser.value("document.documentElement.scrollWidth - innerWidth"), 0, name)

    def test_shows_the_choice_and_why_and_moves_nothing(self):
        for width in WIDTHS:
            self.browser.resize(width)
            self.open()
            self.expect_readable(f"{width}-waiting")
            with Selectord(*OPTIONS), Play(LIVE, 8):
                self.browser.wait_for("state.status?.state === 'WARMUP' && state.status.progress > 0")
                self.expect_readable(f"{width}-warmup")
                self.browser.wait_for(text_of("sentence") + ".startsWith('Localising in winter, because')")
                self.browser.wait_for(text_of("match-facts") + ".includes('winter, frame')")
                self.browser.wait_for("live.naturalWidth > 0 && !live.hidden")
                self.browser.wait_for("match.naturalWidth === 160 && !match.hidden")
                rows = self.browser.value("[...ranking.rows].map(row => row.innerText)")
                self.assertIn("winter", rows[0])
                self.assertEqual(len(rows), 3)
                self.browser.wait_for(text_of("live-facts") + ".match(/[1-9][.]\\d frames per second/)")
                self.browser.wait_for(text_of("legend") + ".includes('winter')")
                self.browser.wait_for("stages.rows.length >= 8")
                self.assertRegex(self.browser.value(text_of("why")), r"^winter is [0-9.]+ bins nearer than \w+: ")
                self.assertEqual(self.browser.value("reasons.rows.length"), 5)
                self.assertIn("MiB", self.browser.value(text_of("facts")))
                time.sleep(3)
                self.expect_readable(f"{width}-valid")
            if not SHOTS:  # a screenshot of what is below the window moves things
                self.assertLess(self.browser.value("shift"), SHIFT_MAX, self.browser.value("shifted"))

    def test_shows_predictions_and_fields_that_it_does_not_know(self):
        for width in WIDTHS:
            self.browser.resize(width)
            self.open()
            self.browser.value(f"take('ranking', {PREDICTED})")
            self.browser.value("take('status', {state: 'NONE_FITS', experience: 'winter', experiences: 3, "
                               "map_hash: '', reason: 'nothing like it', mood: 'sad'})")
            self.browser.value("take('problems', ['Damaged experiences left out: 1'])")
            self.browser.value("take('headline', {tone: 'doubt', text: 'No experience fits, winter is the least bad.'})")
            self.browser.wait_for("ranking.rows.length === 3")
            first, second, third = self.browser.value("[...ranking.rows].map(row => row.innerText)")
            self.assertIn("94 % (88–97)", first)
            self.assertIn("tied", second)
            self.assertIn("–", third)
            self.assertEqual(self.browser.value("document.querySelectorAll('.bar b').length"), 2)
            self.assertEqual(self.browser.value(text_of("why")),
                             "winter is 2.30 bins nearer than summer: 2 of 1280 neurons make 10 % of it.")
            reasons = self.browser.value("[...reasons.rows].map(row => [...row.cells].map(cell => cell.innerText))")
            self.assertEqual([[cell.strip() for cell in row] for row in reasons],
                             [["embedding 512", "20.0 %", "100, 110, 401", "7, 9", "11, 0"],
                              ["embedding 3", "-10.0 %", "20, 30, 10", "–, –", "–, –"]])
            self.assertEqual(self.browser.value("reasons.rows[1].className"), "against")
            self.browser.wait_for(text_of("problems") + ".includes('Damaged experiences left out: 1')")
            self.browser.value("raw.open = true")
            self.browser.wait_for(text_of("fields") + ".includes('sad')")
            self.expect_readable(f"{width}-predicted")

    def test_is_used_by_keyboard(self):
        self.open()
        reached = []
        for _ in range(7):
            self.browser.press("Tab", 9)
            reached.append(self.browser.value("document.activeElement.innerText.split('\\n')[0] || document.activeElement.id"))
            self.assertEqual(self.browser.value("getComputedStyle(document.activeElement).outlineStyle"), "solid")
        self.assertEqual(reached[0].lower(), "reset")
        self.assertIn("Every field received", reached)
        self.browser.value("document.querySelector('#commands button').focus()")
        self.browser.press("Enter", 13)
        self.browser.wait_for(text_of("sent") + " === 'reset sent'")

    def test_pins_and_excludes_by_keyboard(self):
        self.open()
        with Selectord(*OPTIONS), Play(LIVE, 8):
            self.browser.wait_for("ranking.rows.length === 3")
            button = "[...document.querySelectorAll('button')].find(b => b.dataset.key === '{}')".format
            for key, state in (("pin summer", "state.status.pinned === 'summer'"),
                               ("exclude night", "state.status.excluded.includes('night')"),
                               ("shadow", "state.status.shadow")):
                self.browser.value(button(key) + ".focus()")
                self.browser.press("Enter", 13)
                self.browser.wait_for(state)
                self.browser.wait_for(button(key) + ".getAttribute('aria-pressed') === 'true'")
                self.assertEqual(self.browser.value("document.activeElement.dataset.key"), key)
            rows = " ".join(self.browser.value("[...ranking.rows].map(row => row.innerText)"))
            self.assertIn("summer pinned ✓", rows)
            self.assertIn("night excluded", rows)
            self.assertIn("In shadow", self.browser.value(text_of("margin")))
            for width in WIDTHS:
                self.browser.resize(width)
                self.expect_readable(f"{width}-commanded")
            for key in ("pin summer", "exclude night", "shadow"):
                self.browser.value(button(key) + ".click()")
            self.browser.wait_for("!state.status.pinned && !state.status.excluded.length && !state.status.shadow")

    def test_commands_only_with_the_token(self):
        self.open(self.serve.origin + "/")
        self.browser.wait_for("document.querySelector('#commands button')?.disabled")
        self.assertIn("token", self.browser.value(text_of("sent")))
        self.open(self.serve.origin + "/#wrong")
        self.browser.value("window.isOld = true; location.reload()")
        self.browser.wait_for("!window.isOld && document.querySelector('#commands button')?.disabled === false")
        self.assertEqual(self.browser.value("location.hash"), "")  # not for others to see
        self.browser.value("document.querySelector('#commands button').click()")
        self.browser.wait_for(text_of("sent") + ".includes('token is wrong')")

    def test_follows_a_daemon_that_dies_and_returns(self):
        self.open()
        with Selectord(*OPTIONS), Play(LIVE, 10):
            self.browser.wait_for(text_of("state") + " === 'VALID'")
        self.browser.wait_for(text_of("state") + " === 'SILENT'")
        self.assertIn("No daemon heard", self.browser.value(text_of("sentence")))
        self.shoot("1280-silent")
        with Selectord(*OPTIONS), Play(LIVE, 10):
            self.browser.wait_for("state.ranking === null")
            self.browser.wait_for(text_of("state") + " === 'VALID'")

    def test_follows_a_server_that_dies_and_returns(self):
        self.open()
        port = self.serve.port
        self.serve.stop()
        self.browser.wait_for(text_of("state") + " === 'GONE'")
        self.shoot("1280-gone")
        with Serve(port=port):
            self.browser.wait_for(text_of("state") + " === 'WAITING'")
            self.browser.wait_for(text_of("no-match") + ".includes('--map DIR')")
            self.assertEqual(self.browser.value(text_of("link")), "live")


if __name__ == "__main__":
    if not PROGRAM:
        print("skipped: no chromium; ./dev test --all installs it")
        sys.exit(77)
    own_network.run_tests_apart(lambda: make_drives(WORK))
