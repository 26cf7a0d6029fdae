# The documentation site: all that is declared is on it, all links lead somewhere.
# SPDX-License-Identifier: GPL-3.0-or-later
import glob
import html.parser
import json
import os
import posixpath
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from urllib.parse import unquote

ROOT = os.environ["SINEW_SOURCE_DIR"]
PROGRAM = os.environ["SINEW_PROGRAM"]


class Page(html.parser.HTMLParser):
    """Addresses, links, images, text and open tags of a page."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.words, self.open, self.wrong = set(), [], [], [], []
        self.feed(text)
        self.text = re.sub(r"\s+", " ", "".join(self.words))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if "id" in given:
            if given["id"] in self.ids:
                self.wrong.append(f"the address {given['id']} twice")
            self.ids.add(given["id"])
        self.links += [given[a] for a in ("href", "src") if a in given]
        if tag not in ("meta", "link", "img", "br", "hr", "input"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        self.words.append(data)


def build(folder, *words):
    maker = os.path.join(ROOT, "tools/site/make_site.py")
    return subprocess.run(
        [sys.executable, "-B", maker, "--program", PROGRAM, *words, folder],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def plain(text):
    """A sentence of Markdown without its marks."""
    return re.sub(r"\s+", " ", re.sub(r"[`*\\]", "", text)).strip()


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        done = build(cls.folder, "--no-pictures")
        assert done.returncode == 0, done.stdout
        cls.pages = {}
        for path in glob.glob(cls.folder + "/**/*.html", recursive=True):
            with open(path, encoding="utf-8") as file:
                cls.pages[os.path.relpath(path, cls.folder)] = Page(file.read())

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_links_lead_somewhere(self):
        count = 0
        for name, page in self.pages.items():
            for link in page.links:
                if re.match(r"[a-z]+:", link):
                    continue
                count += 1
                path, _, anchor = link.partition("#")
                target = posixpath.normpath(posixpath.join(posixpath.dirname(name), unquote(path))) if path else name
                self.assertTrue(os.path.isfile(os.path.join(self.folder, target)), f"{name} links to {link}")
                self.assertFalse(target.startswith(".."), f"{name} links to {link}")
                if anchor and target.endswith(".html"):
                    self.assertIn(unquote(anchor), self.pages[target].ids, f"{name} links to {link}")
        self.assertGreater(count, 5000)

    def test_every_page_can_be_reached(self):
        seen, ahead = set(), ["index.html"]
        while ahead:
            name = ahead.pop()
            if name in seen or name not in self.pages:
                continue
            seen.add(name)
            ahead += [posixpath.normpath(posixpath.join(posixpath.dirname(name), k.partition("#")[0])) for k in self.pages[name].links]
        self.assertEqual(set(self.pages) - seen, set())

    def test_pages_are_sound(self):
        for name, page in self.pages.items():
            self.assertEqual((page.wrong, page.open), ([], []), name)
            self.assertIsNone(re.search(r"\]\([^)]*\.(md|json|png)\)", page.text), name)  # Markdown that stayed

    def test_types_and_attributes_are_documented(self):
        types = json.loads(subprocess.run([PROGRAM, "nodes", "--json"], stdout=subprocess.PIPE, check=True, text=True).stdout)
        self.assertGreater(len(types), 40)
        for kind in types:
            page = self.pages[f"nodes/{kind['name']}.html"]
            self.assertIn(plain(kind["doc"]), plain(page.text))
            for a in kind["inputs"] + kind["outputs"]:
                place = f"{kind['name']}.{a['name']}"
                self.assertIn(a["name"], page.ids, place)
                self.assertIn(plain(a["doc"]), plain(page.text), place)
                for word in a.get("options", []) + list(a.get("presets", {})):
                    self.assertIn(word, page.text, place)
                if a.get("unit", "1") != "1":
                    self.assertIn(f" in {a['unit']}", page.text, place)
            self.assertIn(f"nodes/{kind['name']}.html", {posixpath.normpath("nodes/" + k) for k in self.pages["nodes/index.html"].links})

    def test_defaults_and_ranges_are_those_of_the_declaration(self):
        text = self.pages["nodes/zMaterial.html"].text
        self.assertIn("number in Pa; default 12000; above 0, at most 1e+13; keyable; presets gelatin 1,", text)
        self.assertIn("number; default 0.4; above -1, below 0.5; keyable", text)
        self.assertIn("default: the graph's timing.start", self.pages["nodes/zSolver.html"].text)
        self.assertIn("one of StVK | NeoHookean |", self.pages["nodes/zTissue.html"].text)

    def test_codes_are_documented(self):
        with open(os.path.join(ROOT, "engine/codes.cpp")) as file:
            source = re.sub(r'"\s*\n\s*"', "", file.read())
        rows = re.findall(r'\{"((?:DG|FE|IO)\d{3})",\s*"((?:\\.|[^"])*)",\s*"((?:\\.|[^"])*)"\}', source)
        self.assertGreater(len(rows), 100)
        for code, wrong, remedy in rows:
            text = plain(self.pages[f"codes/{code}.html"].text)
            for words in (wrong, remedy):
                self.assertIn(plain(words.replace('\\"', '"')), text, code)
        self.assertEqual(len(rows), sum(1 for name in self.pages if re.match(r"codes/[A-Z]", name)))

    def test_examples_of_codes_are_what_the_program_says(self):
        self.assertIn("cotton.shearStiffness: -1 is outside [0, 1e+12] N/m", self.pages["codes/DG013.html"].text)

    def test_documents_are_there_whole(self):
        found = glob.glob("docs/**/*.md", root_dir=ROOT, recursive=True)
        self.assertGreater(len(found), 15)
        for path in found:
            if path.startswith("docs/reference/"):
                continue
            page = plain(self.pages[path[:-3] + ".html"].text)
            with open(os.path.join(ROOT, path)) as file:
                text = re.sub(r"^```.*?^```", "", file.read(), flags=re.S | re.M)
            for heading in re.findall(r"^#+ (.*)$", text, re.M):
                self.assertIn(plain(heading), page, path)

    def test_every_type_has_an_example_that_is_a_graph(self):
        for name, page in self.pages.items():
            if re.match(r"nodes/(?!index)", name):
                self.assertRegex(page.text, r"sinew run graphs/(learn|scenes|bench)/\w+\.json", name)
        page = self.pages["nodes/zFiber.html"]
        self.assertIn("sinew run graphs/learn/02_muscle_pulls.json", page.text)
        self.assertIn("../graphs/learn/02_muscle_pulls.html", page.links)
        self.assertIn('"fibre": { "type": "zFiber"', page.text)

    def test_it_is_for_phones_and_for_the_dark(self):
        with open(os.path.join(self.folder, "style.css")) as file:
            style = file.read()
        self.assertIn("prefers-color-scheme: dark", style)
        self.assertIn("max-width: 50rem", style)
        with open(os.path.join(self.folder, "nodes/zTissue.html")) as file:
            self.assertIn('name="viewport" content="width=device-width', file.read())

    def test_a_folder_of_other_things_is_left_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(folder + "/mine.txt", "w") as file:
                file.write("mine")
            done = build(folder, "--no-pictures")
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("holds other things", done.stdout)
            self.assertEqual(os.listdir(folder), ["mine.txt"])


if __name__ == "__main__":
    if shutil.which("cmark-gfm") is None:
        print("SKIPPED: cmark-gfm is not installed, so the site is not tested (Debian: apt-get install cmark-gfm).")
        sys.exit(77)
    unittest.main()
