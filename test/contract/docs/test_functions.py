"""Each public function has a row in docs/internals/functions.md, with a test and a fuzz target that
call it, or why there is no fuzz target.

    test_functions.py          checks it
    test_functions.py --write  adds rows of new functions, removes those of functions that are gone, and
                               looks for other tests where they no longer call the function; a reason
                               is left to be written
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "test/contract/abi"))
import declarations  # noqa: E402

PAGE = ROOT / "docs/internals/functions.md"
HEAD = "| function | test | fuzz target |\n|---|---|---|\n"
ROW = re.compile(r"^\| `(\w+)` \| (.*) \| (.*) \|$", re.M)


def sources(pattern):
    """{name of a source of tests: its text}."""
    return {str(path.relative_to(ROOT / "test")): path.read_text(encoding="utf-8")
            for path in sorted((ROOT / "test").rglob(pattern)) if path.suffix in (".c", ".cpp")}


def calls(text, function):
    """Times that a source calls a function. A macro without `_sized` calls the one with it."""
    return len(re.findall(rf"\b{function.removesuffix('_sized')}(?:_sized)?\b", text))


def is_called(cell, function, found):
    """Whether a cell names a source that calls the function."""
    return calls(found.get(cell.strip("`"), ""), function) > 0


def problems_of(functions, rows, tests, fuzzers):
    for function in functions:
        test, fuzzer = rows.get(function, ("", ""))
        if not is_called(test, function, tests):
            yield f"{function}: found '{test}', expected a test below test/ that calls it"
        if not re.match(r"none: \w", fuzzer) and not is_called(fuzzer, function, fuzzers):
            yield (f"{function}: found '{fuzzer}', expected a fuzz target below test/ that calls it, "
                   "or `none: ` and why")
    for function in rows.keys() - set(functions):
        yield f"{function}: found a row, expected none, since no header declares it"


def best(function, found):
    """The source that calls a function most often; "" if none does."""
    name = max(found, key=lambda source: calls(found[source], function))
    return f"`{name}`" if calls(found[name], function) else ""


def row_of(function, row, tests, fuzzers):
    test, fuzzer = row
    if not is_called(test, function, tests):
        test = best(function, tests)
    if not is_called(fuzzer, function, fuzzers):
        fuzzer = best(function, fuzzers) or (fuzzer if fuzzer.startswith("none: ") else "none:")
    return f"| `{function}` | {test} | {fuzzer} |\n"


def main():
    headers = sorted((ROOT / "lib/include/vdna").glob("*.h"))
    functions = declarations.functions(headers)
    text = PAGE.read_text(encoding="utf-8")
    rows = {function: (test, fuzzer) for function, test, fuzzer in ROW.findall(text)}
    tests, fuzzers = sources("test_*"), sources("fuzz_*")
    if sys.argv[1:] == ["--write"]:
        text = text[:text.index(HEAD)] + HEAD + "".join(
            row_of(function, rows.get(function, ("", "")), tests, fuzzers)
            for function in functions)
        PAGE.write_text(text, encoding="utf-8")
        return 0
    problems = list(problems_of(functions, rows, tests, fuzzers))
    if problems:
        print("\n".join(problems))
        print(f"{PAGE}: see {Path(__file__).name} --write")
    return 1 if problems or not functions else 0


if __name__ == "__main__":
    sys.exit(main())
