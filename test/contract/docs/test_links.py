"""What the pages name exists: targets of relative links with their anchors, paths in code, and the
pages that sources name."""
import re
import sys
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ["apps", "docs", "lcmtypes", "lib", "models", "test"]
SOURCES = {".c", ".cmake", ".cpp", ".h", ".hpp", ".in", ".json", ".lcm", ".py", ".sh", ".txt", ""}

BLOCK = re.compile(r"^```.*?^``` *$|^ {4}[^\n]*$", re.M | re.S)
INLINE = re.compile(r"`([^`]+)`")
LINK = re.compile(r"\]\(([^()\s]+)\)")
HEADING = re.compile(r"^#+ +(.*?) *(?:\{#.*\})?$", re.M)
WORD = re.compile(r"[^\s'\"()\[\],;]+")
PAGE = re.compile(r"\bdocs/[\w./-]+\.(?:md|jpg|svg)\b")


def files():
    """Files of the project, made ones left out."""
    yield from (path for path in ROOT.iterdir() if path.is_file())
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*"):
            if path.is_file() and not {"__pycache__", "target"} & set(path.parts):
                yield path


def without_blocks(text):
    """The text, with an empty line for each line of a code block."""
    return BLOCK.sub(lambda block: "\n" * block[0].count("\n"), text)


@lru_cache(maxsize=None)
def anchors(page):
    """Anchors of a page's headings, as GitHub makes them."""
    text = without_blocks(page.read_text(encoding="utf-8"))
    plain = (re.sub(r"[^\w\- ]", "", heading).lower() for heading in HEADING.findall(text))
    return {heading.replace(" ", "-") for heading in plain}


def link_faults(page, text):
    for target in LINK.findall(INLINE.sub("", without_blocks(text))):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        linked = (page.parent / path).resolve() if path else page
        if not linked.exists() or not linked.is_relative_to(ROOT):
            yield f"links to {target}, which does not exist"
        elif anchor and anchor not in anchors(linked):
            yield f"links to {target}, but {linked.name} has no such heading"


def exists(word):
    """Whether a path from the root exists; <name> and * stand for any name."""
    pattern = re.sub(r"<[^>]*>", "*", word)
    return any(ROOT.glob(pattern)) if "*" in pattern else (ROOT / pattern).exists()


def code_faults(text):
    """Paths in code that begin with a folder of ours, and our headers as programs include them."""
    code = [block[0] for block in BLOCK.finditer(text)] + INLINE.findall(without_blocks(text))
    for word in WORD.findall("\n".join(code)):
        word = word.rstrip(".:").partition("::")[0]
        if re.fullmatch(r"<?vdna/\w+\.h>?", word):
            word = "lib/include/" + word.strip("<>")
        if word.partition("/")[0] in FOLDERS and "/" in word and not exists(word):
            yield f"names {word}, which does not exist"


def source_faults(text):
    for page in PAGE.findall(text):
        if not (ROOT / page).exists():
            yield f"names {page}, which does not exist"


def faults(path):
    if path.suffix == ".md":
        text = path.read_text(encoding="utf-8")
        return [*link_faults(path, text), *code_faults(text)]
    return source_faults(path.read_text(encoding="utf-8")) if path.suffix in SOURCES else []


def main():
    found = [f"{path.relative_to(ROOT)} {fault}" for path in sorted(files())
             for fault in faults(path)]
    for fault in found:
        print(fault)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
