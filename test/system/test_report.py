"""The HTML report of `vdna eval` against the JSON of the same run.

Python's own parser checks the page: every opened element is closed, nothing is fetched, and tables
and colours match those computed from the JSON.
"""

import json
import os
import re
import subprocess
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

VDNA = Path(os.environ["VDNA_BIN"]) / "vdna"

HOSTILE = "<script>alert('\"&')"  # a possible folder name
CONDITIONS = {"summer": "summer", "winter": "winter", HOSTILE: "dusk"}
TITLES = {"vdna": "Visual DNA", "fd": "Fréchet distance", "pixel": "Pixel intensity",
          "random": "Chance"}
ERRORS = ["ranking_error_swap_once", "ranking_error_half_l1", "regret", "kendall_tau",
          "pearson_within", "spearman_within", "pearson_pooled", "spearman_pooled"]
# Elements without an end tag.
VOID = {"meta", "img", "br"}


class Page(HTMLParser):
    """Tables as {caption: [[(class, text)]]}, addresses, and faults of nesting."""

    def __init__(self, html):
        super().__init__()
        self.open, self.tags, self.addresses, self.tables, self.texts = [], [], [], {}, []
        self.title = ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tags.append(tag)
        self.addresses += [attributes[key] for key in ("src", "href", "xlink:href", "action",
                                                       "srcset", "data") if key in attributes]
        if tag not in VOID:
            self.open.append(tag)
        if tag == "caption":
            self.caption, self.rows = "", []
        elif tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append((attributes.get("class", ""), ""))

    def handle_startendtag(self, tag, attributes):
        self.tags.append(tag)  # <circle/> in a drawing

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            raise ValueError(f"line {self.getpos()[0]}: </{tag}> closes nothing")
        if tag == "caption":
            self.tables[self.caption] = self.rows

    def handle_data(self, text):
        if "title" in self.open and "head" in self.open:
            self.title += text
        elif "caption" in self.open:
            self.caption += text
        elif {"td", "th"} & set(self.open):
            kind, before = self.rows[-1][-1]
            self.rows[-1][-1] = (kind, before + text)
        else:
            self.texts.append(text)

    def text_of(self, beginning):
        """The only text outside of tables that begins like this."""
        (text,) = [text for text in self.texts if text.startswith(beginning)]
        return text

    def table(self, beginning):
        """The only table whose caption begins like this."""
        (rows,) = [rows for caption, rows in self.tables.items() if caption.startswith(beginning)]
        return rows


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory(prefix="vdna-report-")
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        cls.runs = cls.folder / "runs & <b>more"
        cls.runs.mkdir()
        for drive, (name, condition) in enumerate(CONDITIONS.items()):
            cls.vdna("simulate", cls.runs / name, "--condition", condition, "--frames", 24,
                     "--step", 2, "--size", "64x48", "--variation", 0.5, "--drive", drive + 1)
        cls.html = cls.evaluate()
        cls.page = Page(cls.html)
        cls.result = json.loads((cls.folder / "result.json").read_text())

    @staticmethod
    def vdna(*arguments):
        subprocess.run([str(VDNA), *map(str, arguments)], stdout=subprocess.DEVNULL,
                       stderr=subprocess.PIPE, check=True)

    @classmethod
    def evaluate(cls, *options, warmup="8"):
        report = cls.folder / "report.html"
        cls.vdna("eval", cls.runs, "--warmup", warmup, "--tolerance", 3, "--cache",
                 cls.folder / "cache", "--json", cls.folder / "result.json", "--html", report,
                 *options)
        return report.read_text(encoding="utf-8")

    def ranked(self, query, method):
        """References by distance, each with its distance from its true rank."""
        recall = {name: value for name, value in self.result["recall"][query].items()
                  if name != "all"}
        distance = self.result["distance"][method][query]
        order = [name for name in self.result["queries"] if name != query]
        truth = sorted(order, key=lambda name: -recall[name])
        predicted = sorted(order, key=distance.get)
        return [(name, abs(truth.index(name) - rank)) for rank, name in enumerate(predicted)]

    def titles(self):
        """{method: title}: the JSON and the page have the methods in one order."""
        shown = [row[0][1] for row in self.page.table("Ranking errors")[1:]]
        return dict(zip(self.result["methods"], shown, strict=True))

    def test_every_opened_element_is_closed(self):
        self.assertEqual(self.page.open, [])
        self.assertTrue(self.html.startswith("<!DOCTYPE html>"))
        self.assertIn("runs & <b>more", self.page.title)

    def test_the_page_fetches_nothing_and_runs_nothing(self):
        self.assertGreater(len(self.page.addresses), 0)
        for address in self.page.addresses:
            self.assertTrue(address.startswith("data:image/"), address[:80])
        for word in ("http:", "https:", "@import", "url("):
            self.assertNotIn(word, self.html)
        self.assertFalse({"script", "link", "iframe", "object"} & set(self.page.tags))

    def test_a_hostile_folder_name_is_text(self):
        self.assertNotIn(HOSTILE, self.html)
        self.assertIn("&lt;script&gt;alert(&#39;&quot;&amp;&#39;)", self.html)
        self.assertIn(HOSTILE, [text for _, text in self.page.table("Visual DNA:")[0]])

    def test_the_averages_are_those_of_the_json(self):
        rows = {row[0][1]: [text for _, text in row[1:]]
                for row in self.page.table("Ranking errors")[1:]}
        self.assertEqual({**self.titles(), **TITLES}, self.titles())
        for method, title in self.titles().items():
            errors = self.result["methods"][method]
            self.assertEqual(rows[title], ["–" if errors[key] is None else f"{errors[key]:.3f}"
                                           for key in ERRORS])

    def test_the_true_ranking_names_the_recall_in_all_references(self):
        head, *rows = self.page.table("The truth")
        for column, query in enumerate(self.result["queries"], 1):
            recall = self.result["recall"][query]
            self.assertEqual(head[column][1], f"{query} / {recall['all']:.2f}")
            shown = [row[column][1].split(" – ", 1) for row in rows]
            self.assertEqual([value for value, _ in shown],
                             [f"{recall[name]:.2f}" for _, name in shown])
            values = [recall[name] for _, name in shown]
            self.assertEqual(values, sorted(values, reverse=True))

    def test_exactly_the_misplaced_references_are_coloured_and_marked(self):
        seen = set()
        for method, title in self.titles().items():
            if method == "random":
                continue
            rows = self.page.table(f"{title}:")[1:]
            for column, query in enumerate(self.result["queries"], 1):
                for row, (name, off) in zip(rows, self.ranked(query, method), strict=True):
                    kind, text = row[column]
                    self.assertEqual(kind, ["", "one", "more"][min(off, 2)])
                    mark = f" ↕{off}" if off else ""
                    self.assertEqual(text.split(" – ", 1)[1], name + mark)
                    seen.add(kind)
        self.assertGreaterEqual(seen, {"", "one"}, "the data set shows both")

    def test_the_neurons_say_why_the_first_choice_is_not_the_second(self):
        for query in self.result["queries"]:
            (first, _), (second, _), *_ = self.ranked(query, "vdna")
            distance = self.result["distance"]["vdna"][query]
            told = self.page.text_of(f"{first} is {distance[second] - distance[first]:.2f} bins nearer than {second}: ")
            share = float(re.search(r"10 of 1280 neurons make (-?\d+) % of it", told)[1])
            rows = [[text for _, text in row] for row in self.page.tables[
                f"Neurons that tell {first} from {second} best"]][1:]
            self.assertEqual(len(rows), 10)
            margins = [float(row[1]) for row in rows]
            self.assertEqual(margins, sorted(margins, key=abs, reverse=True))
            self.assertAlmostEqual(sum(float(row[2]) for row in rows), share, delta=1.1)

    def test_the_localisers_are_those_of_the_json(self):
        page = Page(self.evaluate("--localisers", "nn,seqslam,fused,all"))
        self.assertEqual(page.open, [])
        result = json.loads((self.folder / "result.json").read_text())["localisers"]
        rows = page.table("Localisers: Recall@1")[1:]
        self.assertEqual([row[1][1] for row in rows], list(result))
        for row in rows:
            for cell, kind in zip(row[2:], ("mean", "first_choice"), strict=True):
                found = result[row[1][1]][kind]
                self.assertEqual(
                    cell[1],
                    f"{found['recall']:.2f} ({found['low']:.2f} to {found['high']:.2f})")
        shown = [[text for _, text in row] for row in page.table("Recall@1 in % by localiser")[1:]]
        for query, reference, *values in shown:
            self.assertEqual(values, ["" if reference not in found["recall"][query] else
                                      f"{found['recall'][query][reference]:.2f}"
                                      for found in result.values()])

    def test_a_report_that_cannot_be_written_leaves_nothing(self):
        folder = self.folder / "taken.html"
        folder.mkdir()
        done = subprocess.run(
            [str(VDNA), "eval", str(self.runs), "--warmup", "8", "--cache",
             str(self.folder / "cache"), "--html", str(folder)],
            text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("taken.html: cannot rename a complete .partial file to it", done.stderr)
        self.assertEqual([p.name for p in self.folder.iterdir() if ".part" in p.name], [])

    def test_ablations_have_a_table_each(self):
        page = Page(self.evaluate("--ablate", "warmup,leave-one-out", warmup="4,8"))
        self.assertEqual([row[0][1] for row in page.table("Ablation: warmup")[1:]], ["4", "8"])
        self.assertEqual(len(page.table("Ablation: leave-one-out")[1:]), len(CONDITIONS))


if __name__ == "__main__":
    unittest.main()
