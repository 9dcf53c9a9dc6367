"""The README is short: at most 700 words beside its code, and one or two pictures, the first before any
code."""
import sys
from pathlib import Path

from test_links import BLOCK, LINK

README = Path(__file__).resolve().parents[3] / "README.md"
WORDS_MAX = 700
PICTURE_BEFORE = 25  # lines


def main():
    text = README.read_text(encoding="utf-8")
    words = [word for word in LINK.sub("]", BLOCK.sub("", text)).split()
             if any(letter.isalnum() for letter in word)]
    print(f"README.md: {len(words)} words, at most {WORDS_MAX}")
    pictures = [line for line, of_line in enumerate(text.split("\n"), 1) if "![" in of_line]
    print(f"README.md: pictures on lines {pictures}, one or two expected, the first before line "
          f"{PICTURE_BEFORE}")
    return 0 if len(words) <= WORDS_MAX and 1 <= len(pictures) <= 2 and \
        pictures[0] < PICTURE_BEFORE else 1


if __name__ == "__main__":
    sys.exit(main())
