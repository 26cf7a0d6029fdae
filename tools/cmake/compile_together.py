#!/usr/bin/env python3
"""Which sources of a target can be compiled as one: prints a line `FILE<tab>GROUP` for each that has company.

    compile_together.py SOURCE...       paths from the working directory

Most of a short file's time goes into the headers that its neighbours read, too. Files of one folder make a group where no
two of them declare one name for themselves (in a nameless namespace, as static, or by using); a file with macros of its
own, of another language or of CGAL, whose files need gigabytes each, stays alone. Where a group begins hangs on the names
of its files alone, so that a new file changes one group and not all behind it.
"""
# SPDX-License-Identifier: GPL-3.0-or-later
import os
import re
import sys
import zlib

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
LARGEST = 8  # files a group: what an edit of one of them compiles
MEAN = 5  # of files until another group begins, by their names

TYPE = re.compile(r"(?:template <.*?> )?(?:class|struct|union|enum class|enum|concept)\s+(\w+)")
OTHER = re.compile(r"[^(={;]*?(\w+)\s*(?:<[^(]*>)?\s*(?:\[[^]]*\]\s*)?[(={;]")


def nameless_parts(text):
    """What stands in `namespace {`, which clang-format ends by `} // namespace` at the line's begin."""
    return re.findall(r"^namespace \{$(.*?)^\} // namespace$", text, re.M | re.S)


def declared(text):
    """Name -> how, of declarations that begin at the begin of a line; `template <...>` may have a line of its own."""
    names = {}
    for line in text.replace(">\n", "> ").splitlines():
        if not line or line[0].isspace() or line[0] in "}/#)":
            continue
        if found := re.match(r"using (?!namespace)(?:([\w:]+)::)?(\w+)(?: = (.*))?;", line):
            names[found[2]] = line
        elif found := re.match(r"namespace (\w+) = .*;", line):
            names[found[1]] = line
        elif not line.startswith(("namespace", "using", "extern \"C\"")) and (found := TYPE.match(line) or OTHER.match(line)):
            names[found[1]] = "static" if line.startswith("static ") else "own"
    for several in re.findall(r"^constexpr [^;{(]*?,[^;{(]*;", text, re.M):
        names.update((name, "own") for name in re.findall(r"(\w+) =", several))
    return names


def own_names(text):
    """Name -> how it is declared, of all that would meet its like from another file."""
    names = declared("\n".join(nameless_parts(text)))
    outside = declared(re.sub(r"^namespace \{$.*?^\} // namespace$", "", text, flags=re.M | re.S))
    names.update((name, how) for name, how in outside.items() if how != "own")
    return names


def header_names(text):
    """What the headers declare that a file includes itself: they reach the files behind it."""
    names = set()
    for header in re.findall(r'^#include "(.*)"', text, re.M):
        path = os.path.join(ROOT, header)
        if os.path.exists(path):
            names |= declared(open(path, encoding="utf-8").read()).keys()
    return names


def alone(path, text):
    return not path.endswith(".cpp") or re.search(r"^#\s*define|<CGAL/", text, re.M)


class Group:
    def __init__(self):
        self.files, self.names, self.headers, self.opened = [], {}, set(), None

    def takes(self, names, headers, opened):
        if self.opened not in (None, opened) or self.headers & kept(names) or headers & kept(self.names):
            return False
        return all(names[name] == self.names[name] not in ("own", "static") for name in names.keys() & self.names.keys())

    def add(self, path, names, headers, opened):
        self.files.append(path)
        self.names.update(names)
        self.headers |= headers
        self.opened = opened


def kept(names):
    """Those that mean something else than the same name in a header."""
    return {name for name, how in names.items() if how in ("own", "static") or " = " in how}


def groups_of(paths):
    """Groups of one folder, in its files' order."""
    done, now = [], []
    size = 0
    for path in sorted(paths):
        text = open(path, encoding="utf-8").read()
        if alone(path, text):
            continue
        if size == LARGEST or (size > 1 and zlib.crc32(os.path.basename(path).encode()) % MEAN == 0):
            done += now
            now, size = [], 0
        size += 1
        names, headers = own_names(text), header_names(text)
        opened = sorted(set(re.findall(r"^(?:using namespace [\w:]+;|inline namespace \w+)", text, re.M)))
        for group in now:
            if group.takes(names, headers, opened):
                group.add(path, names, headers, opened)
                break
        else:
            now.append(Group())
            now[-1].add(path, names, headers, opened)
    return done + now


def main():
    folders = {}
    for path in sys.argv[1:]:
        folders.setdefault(os.path.dirname(path), []).append(path)
    for paths in folders.values():
        for group in groups_of(paths):
            if len(group.files) > 1:
                name = re.sub(r"\W", "_", os.path.splitext(os.path.relpath(group.files[0]))[0])
                for path in group.files:
                    print(f"{path}\t{name}")


if __name__ == "__main__":
    main()
