"""Each row of the tables in docs/operating/faults.md names a test that exists."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs/operating/faults.md"
HEADS = {"fault", "picture", "---"}
TEST = re.compile(r"\| `([\w./]+)` \|$")


def exists(name, sources):
    """A file, or a test that is run (its definition and its entry in a list)."""
    return (ROOT / name).is_file() or len(re.findall(rf"\b{re.escape(name)}\b", sources)) > 1


def main():
    sources = "\n".join(path.read_text(encoding="utf-8") for path in sorted(
        (ROOT / "test").rglob("test_*.c*")) if path.suffix in (".c", ".cpp"))
    rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines()
            if line.startswith("|") and line.split("|")[1].strip() not in HEADS]
    problems = [f"{PAGE}: expected the name of a test that exists at the end of: {row}"
                for row in rows
                if not (TEST.search(row) and exists(TEST.search(row)[1], sources))]
    if not rows:
        problems.append(f"{PAGE}: no rows found, expected tables of faults")
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
