# The programs in docs/embedding.md: takes them out of the page, and runs one and compares what it prints.
#
# examples.py extract PAGE FOLDER       writes each program and NAME.expected; prints the names
# examples.py check EXPECTED WORDS...   runs WORDS; fails unless they print what the page says
# examples.py write PAGE NAME WORDS...    runs WORDS and puts what they print below NAME
# SPDX-License-Identifier: GPL-3.0-or-later
import re
import subprocess
import sys
from pathlib import Path

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
LANGUAGES = {"c": ".c", "cpp": ".cpp", "python": ".py"}


def programs(page):
    """(name, source, expected) of each program; every block of a language must be one and have its output below it."""
    blocks = [(m.group(1), m.group(2)) for m in BLOCK.finditer(page)]
    for (language, source), after in zip(blocks, blocks[1:] + [("", "")]):
        if language not in LANGUAGES:
            continue
        named = re.match(r"(?://|#) ([\w.]+)\n", source)
        if not named or not named.group(1).endswith(LANGUAGES[language]):
            sys.exit(f"a block of {language} does not begin with its name: {source[:60]!r}")
        if after[0] != "text":
            sys.exit(f"{named.group(1)} has no output below it")
        yield named.group(1), source, after[1]


def extract(page, folder):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, source, expected in programs(Path(page).read_text()):
        for path, text in ((folder / name, source), (folder / f"{name}.expected", expected)):
            if not path.exists() or path.read_text() != text:
                path.write_text(text)
        print(name)


def check(expected, *words):
    done = subprocess.run(words, capture_output=True, text=True)
    wanted = Path(expected).read_text()
    if done.returncode != 0 or done.stdout != wanted:
        sys.exit(f"exit {done.returncode}\n--- printed\n{done.stdout}{done.stderr}--- the page says\n{wanted}")


def write(page, name, *words):
    text = Path(page).read_text()
    printed = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    at = re.search(rf"^```\w+\n(?://|#) {re.escape(name)}\n", text, re.M).start()
    begin = text.index("```text\n", at) + len("```text\n")
    Path(page).write_text(text[:begin] + printed + text[text.index("```", begin) :])


if __name__ == "__main__":
    {"extract": extract, "check": check, "write": write}[sys.argv[1]](*sys.argv[2:])
