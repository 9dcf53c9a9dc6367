"""The HTML report of `vdna eval` against the JSON of the same run.

Python's own parser checks the page: every opened element is closed, nothing is fetched, and tables
and colours match those computed from the JSON.
"""

import csv
import json
import os
import re
import shutil
import re
import subprocess
import tempfile
import unittest
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

from browser import PROGRAM, Browser

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
        self.headings, self.photos, self.scrolling = [], 0, 0
        self.title = ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tags.append(tag)
        self.addresses += [attributes[key] for key in ("src", "href", "xlink:href", "action",
                                                       "srcset", "data") if key in attributes]
        self.photos += attributes.get("class") == "photo"
        self.scrolling += attributes.get("class") == "scroll" and attributes.get("tabindex") == "0"
        if tag not in VOID:
            self.open.append(tag)
        if tag == "h2":
            self.headings.append("")
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
        elif "h2" in self.open:
            self.headings[-1] += text
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
        cls.html = cls.evaluate("--csv", cls.folder / "result.csv", "--latex",
                                cls.folder / "tables.tex", "--figures", cls.folder / "figures")
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
            self.assertEqual(rows[title], [self.average(errors[key], errors["intervals"][key])
                                           for key in ERRORS])

    @staticmethod
    def average(value, interval):
        """As a cell has it."""
        if value is None:
            return "–"
        return f"{value:.3f}" + ("" if None in interval else "{:.3f} to {:.3f}".format(*interval))

    def test_the_answer_comes_first_then_pictures_tables_and_words(self):
        regret = self.result["methods"]["vdna"]
        low, high = regret["intervals"]["regret"]
        answer = (f"costs {regret['regret']:.2f} percentage points of Recall@1 (95 % interval over "
                  f"3 queries: {low:.2f} to {high:.2f})")
        self.assertLess(self.html.index(answer), self.html.index("<h2>"))
        order = ["Right and wrong matches", "Difference matrices", "Distance against recall",
                 "How well each method ranks", "Rankings", "What the words mean",
                 "How this was made"]
        self.assertEqual([name for name in self.page.headings if name in order], order)

    def test_pairs_show_a_live_and_a_map_picture_with_query_reference_frames_and_error(self):
        section = self.html[self.html.index("<h2>Right and wrong"):self.html.index("<h2>Difference")]
        self.assertEqual(section.count('class="photo"'), 2 * section.count('class="pair"'))
        self.assertEqual(section.count('class="photo"'), self.page.photos)
        for kind in ("✓ right: ", "✗ wrong: "):
            self.assertIn(kind, section)
        self.assertRegex(section, r"summer in [^<]+</b><br>frame \d+ \| \d+, \d+\.\d metres apart")

    def test_matrices_are_ranked_with_axes_a_legend_and_all_references(self):
        section = self.html[self.html.index("<h2>Difference"):self.html.index("<h2>Distance")]
        for query, part in zip(self.result["queries"], section.split("<summary>")[1:], strict=True):
            titles = re.findall(r">(\d)  ([^<]+)</text>", part)
            ranked = [escape(name).replace("&#x27;", "&#39;")
                      for name, _ in self.ranked(query, "vdna")]
            self.assertEqual(titles, [(str(i), name) for i, name in enumerate(ranked, 1)])
            panels = len(ranked) + 1
            self.assertEqual(part.count(">live frame<"), panels)
            self.assertEqual(part.count(">map frame<"), len(ranked))
            self.assertEqual(part.count(">chosen<"), 1)
            self.assertGreaterEqual(part.count(">best<"), 1)
            self.assertIn(">all references at once<", part)
            self.assertIn(f">Recall@1 {self.result['recall'][query]['all']:.2f} %<", part)
            self.assertRegex(part, r">near \d+\.\d\d<.*>far \d+\.\d\d<")
            self.assertIn(">nearest frame, right<", part)

    def test_every_table_is_in_a_box_that_the_keyboard_can_scroll(self):
        self.assertEqual(self.page.scrolling, self.page.tags.count("table"))

    def test_the_averages_are_in_a_table_of_their_own(self):
        with open(self.folder / "result_averages.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        found = {(row["row"], row["average"]): [float(row[key]) for key in ("value", "low", "high")]
                 for row in rows if row["table"] == "ranking" and row["value"]}
        for method, errors in self.result["methods"].items():
            self.assertEqual(found[method, "regret"],
                             [errors["regret"], *errors["intervals"]["regret"]])
        self.assertIn(("localisers", "nn"), {(row["table"], row["row"]) for row in rows})

    def test_every_figure_is_a_portable_svg_and_pdf(self):
        files = sorted(path.name for path in (self.folder / "figures").iterdir())
        stems = {name.split(".")[0] for name in files}
        self.assertEqual(files, sorted(stem + end for stem in stems for end in (".svg", ".pdf")))
        for stem in stems:
            self.assertRegex(stem, r"\A[A-Za-z0-9_-]+\Z")
        self.assertGreaterEqual(stems, {"pairs", "pairs-summer", "difference-summer", "localisers",
                                        "distance-recall-vdna", "neurons-winter"})
        texts = ""
        for name in files:
            data = (self.folder / "figures" / name).read_bytes()
            if name.endswith(".svg"):
                root = ElementTree.fromstring(data)
                self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
                self.assertFalse([e for e in root.iter() if e.tag.endswith("script")])
                texts += "".join(root.itertext())
            else:
                self.assertTrue(data.startswith(b"%PDF-1.4\n"), name)
                self.assertTrue(data.endswith(b"%%EOF\n"), name)
                table = int(re.search(rb"startxref\n(\d+)\n", data)[1])
                self.assertEqual(data[table:table + 4], b"xref", name)
        self.assertIn(HOSTILE, texts)

    def test_the_latex_tables_are_those_of_the_paper(self):
        tex = (self.folder / "tables.tex").read_text(encoding="utf-8")
        # Every environment is closed, and every brace.
        opened = []
        for kind, name in re.findall(r"\\(begin|end){(\w+)}", tex):
            if kind == "begin":
                opened.append(name)
            else:
                self.assertEqual(opened.pop(), name)
        self.assertEqual(opened, [])
        braces = re.sub(r"\\[{}%]|%.*", "", tex)
        self.assertEqual(braces.count("{"), braces.count("}"))
        for line in tex.splitlines():
            if line.startswith(r"\begin{tabular}"):
                columns = len(re.search(r"{([lr]+)}", line)[1])
            elif line.endswith(r"\\"):
                spanned = sum(int(n) - 1 for n in re.findall(r"\\multicolumn{(\d+)}", line))
                self.assertEqual(len(re.findall(r"(?<!\\)&", line)) + 1 + spanned, columns, line)
        for rule in ("toprule", "midrule", "bottomrule", "cmidrule(lr){2-4}"):
            self.assertIn("\\" + rule, tex)
        self.assertNotIn(HOSTILE, tex)
        self.assertIn(r"\textless{}script\textgreater{}alert({'}{\char34}\&{'})", tex)
        recall = self.result["recall"]["summer"]
        self.assertIn(f"summer / {recall['all']:.2f}", tex)
        self.assertIn(f"{recall['winter']:.2f} - winter", tex)

    @unittest.skipUnless(PROGRAM, "chromium is not installed")
    def test_the_page_fits_screens_and_wide_tables_scroll(self):
        with Browser() as browser:
            for width in (1280, 390):
                browser.resize(width)
                browser.open((self.folder / "report.html").as_uri())
                browser.wait_for("document.readyState === 'complete'")
                self.assertEqual(browser.value("document.documentElement.scrollWidth"), width)
                self.assertEqual(browser.value(
                    "[...document.querySelectorAll('.scroll')].filter(box => "
                    "box.scrollWidth > box.clientWidth).map(box => { box.scrollLeft = 9; "
                    "return box.scrollLeft; }).filter(x => !(x > 0))"), [])
            self.assertGreater(browser.value(
                "[...document.querySelectorAll('.scroll')].filter(box => "
                "box.scrollWidth > box.clientWidth).length"), 0)
            self.assertEqual(browser.complaints, [])

    @unittest.skipUnless(shutil.which("pdflatex"), "pdflatex is not installed")
    def test_pdflatex_compiles_the_tables(self):
        main = self.folder / "main.tex"
        main.write_text(r"""\documentclass{article}
\usepackage{booktabs,multirow,graphicx,subcaption}
\usepackage[table]{xcolor}
\begin{document}\input{tables.tex}\includegraphics{figures/localisers.pdf}\end{document}""")
        done = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", main.name],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])

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
