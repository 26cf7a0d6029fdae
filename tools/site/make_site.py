"""Makes the documentation as static web pages, from what the program declares and what stands in docs.

make_site.py --program SINEW [--no-pictures] [--kept FOLDER] [FOLDER]

FOLDER: where to (default out/site); it is made anew. --kept: where simulated pictures are kept for the next time (default
build/site_pictures). Needs cmark-gfm."""
# SPDX-License-Identifier: GPL-3.0-or-later
import argparse
import concurrent.futures
import glob
import hashlib
import json
import os
import shutil
import subprocess
import sys

import graphs
import pages

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def words_of(program, *words, wrong=False):
    done = subprocess.run([program, *words], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0 and not wrong:
        sys.exit(f"sinew {' '.join(words)}\n{done.stdout}")
    return done.stdout


def codes(program, folder):
    """(code, what is wrong, what to do) of each, from the page that the program writes."""
    words_of(program, "docs", folder)
    with open(os.path.join(folder, "codes.md"), encoding="utf-8") as file:
        rows = [line.strip().strip("|").replace("\\|", "\0").split("|") for line in file if line[2:4] in ("DG", "FE", "IO")]
    return [tuple(cell.strip().replace("\0", "|") for cell in row) for row in rows]


def broken(program):
    """By code (graph's path, what `sinew check` says), from graphs that are wrong in one way."""
    named = {}
    for expected in sorted(glob.glob(os.path.join(ROOT, "graphs/broken/*.expected.txt"))):
        path = os.path.relpath(expected, ROOT).replace(".expected.txt", ".json")
        with open(expected, encoding="utf-8") as file:
            for code in (line.split()[0] for line in file if line.strip()):
                named.setdefault(code, path)
    with concurrent.futures.ThreadPoolExecutor() as workers:
        said = workers.map(lambda path: words_of(program, "check", path, wrong=True), named.values())
    return {code: (path, words) for (code, path), words in zip(named.items(), said) if code in words}


def picture(program, path, kept):
    """A picture of first, middle and last frame; simulated once for each state of graph and program."""
    program_is = os.stat(program)
    key = hashlib.sha256(f"{read(path)}{program_is.st_size}.{program_is.st_mtime_ns}".encode()).hexdigest()[:24]
    file = os.path.join(kept, key + ".png")
    if not os.path.exists(file):
        os.makedirs(kept, exist_ok=True)
        words_of(program, "snapshot", path, "--size", "1200x420", "--no-cache", "-o", file + ".part.png")
        os.replace(file + ".part.png", file)
    return file


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("folder", nargs="?", default="out/site")
    arguments.add_argument("--program", required=True)
    arguments.add_argument("--no-pictures", action="store_true")
    arguments.add_argument("--kept", default=os.path.join(ROOT, "build", "site_pictures"))
    given = arguments.parse_args()
    if shutil.which("cmark-gfm") is None:
        sys.exit("cmark-gfm is missing (Debian: apt-get install cmark-gfm)")
    program, folder = os.path.abspath(given.program), os.path.abspath(given.folder)
    mark = os.path.join(folder, ".sinew-site")
    if os.path.isdir(folder) and os.listdir(folder) and not os.path.exists(mark):
        sys.exit(f"{folder} holds other things; name an empty folder")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    open(mark, "w").close()

    found = []
    for room in ("learn", "demos", "scenes", "bench"):
        found += sorted(glob.glob(f"graphs/{room}/*.json", root_dir=ROOT))
    site = pages.Site(
        root=ROOT,
        folder=folder,
        types=json.loads(words_of(program, "nodes", "--json")),
        codes=codes(program, os.path.join(folder, "reference")),
        broken=broken(program),
        graphs={path: graphs.read(read(path)) for path in found},
    )
    if not given.no_pictures:
        for path in found:
            if path.startswith("graphs/learn/"):
                print(f"picture of {path}", flush=True)
                site.add_picture(path, picture(program, path, os.path.abspath(given.kept)))
    os.remove(os.path.join(folder, "reference", "nodes.md"))
    os.remove(os.path.join(folder, "reference", "codes.md"))
    count = site.write()
    print(f"{count} pages: {os.path.join(folder, 'index.html')}")


main()
