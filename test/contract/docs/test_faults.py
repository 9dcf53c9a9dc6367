"""Each row of the tables in docs/operating/faults.md and doctor.md names a test that exists, and each check
of `vdna doctor` has rows."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGES = [ROOT / "docs/operating" / name for name in ("faults.md", "doctor.md")]
DOCTOR = ROOT / "apps/doctor/doctor.cpp"
HEADS = {"fault", "picture", "check", "---"}
UNTESTED = {"word", "`ok`", "`--`", "`warn`", "`FAIL`"}  # words, no faults
CHECK = re.compile(r'\{"(\w+)", "(\w+)", check_\w+\(')
TEST = re.compile(r"\| `([\w./]+)` \|$")


def exists(name, sources):
    """A file, or a test that is run (its definition and its entry in a list)."""
    return (ROOT / name).is_file() or len(re.findall(rf"\b{re.escape(name)}\b", sources)) > 1


def rows_of(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    return [line for line in lines
            if line.startswith("|") and line.split("|")[1].strip() not in HEADS | UNTESTED]


def problems_of(page, sources):
    rows = rows_of(page)
    if not rows:
        yield f"{page}: no rows found, expected tables of faults"
    for row in rows:
        if not (TEST.search(row) and exists(TEST.search(row)[1], sources)):
            yield f"{page}: expected the name of a test that exists at the end of: {row}"


def checks_without_rows():
    checks = [" ".join(names) for names in CHECK.findall(DOCTOR.read_text(encoding="utf-8"))]
    rows = {row.split("|")[1].strip() for row in rows_of(PAGES[1])}
    if not checks:
        yield f"{DOCTOR}: no checks found"
    for check in sorted(set(checks) ^ rows):
        yield f"{PAGES[1]}: expected rows for each check of {DOCTOR}, and no others: {check}"


def main():
    sources = "\n".join(path.read_text(encoding="utf-8") for path in sorted(
        (ROOT / "test").rglob("test_*.c*")) if path.suffix in (".c", ".cpp"))
    problems = [problem for page in PAGES for problem in problems_of(page, sources)]
    problems += checks_without_rows()
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
