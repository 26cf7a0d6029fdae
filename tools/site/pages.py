# The pages of the site: documents, node types, codes, graphs; and where links between them lead.
# SPDX-License-Identifier: GPL-3.0-or-later
import glob
import html
import json
import os
import posixpath
import re
import shutil

import graphs as graph_files
import markdown
from markdown import phrase

REFERENCE = {"docs/reference/nodes.md": "nodes/index.html", "docs/reference/codes.md": "codes/index.html"}
FAMILIES = (
    ("DG0", "The graph file"),
    ("DG1", "Evaluation and hosts"),
    ("FE2", "Meshes and set-up"),
    ("FE3", "The solve"),
    ("IO4", "Files"),
)


class Site:
    """types: as `sinew nodes --json` lists them. codes: (code, what is wrong, what to do). broken: by code (graph, what
    is said of it). graphs: by path from the root, as read."""

    def __init__(self, root, folder, types, codes, broken, graphs):
        self.root, self.folder = root, folder
        self.types = {t["name"]: t for t in types}
        self.codes, self.broken, self.graphs = codes, broken, graphs
        self.pictures = {}
        self.documents = self._documents()
        self.titles = {path: self._title(path) for path in self.documents}
        self.said = self._graph_lines()
        sentences = [t["doc"] for t in types] + [a["doc"] for t in types for a in t["inputs"] + t["outputs"]]
        markdown.prepare(sentences + [text for code in codes for text in code] + [self._said_of(path) for path in graphs])

    # What there is

    def _documents(self):
        """By path of the Markdown file that of the page."""
        found = ["README.md"]
        for pattern in ("docs/*.md", "docs/*/*.md"):
            found += sorted(p for p in glob.glob(pattern, root_dir=self.root) if p not in REFERENCE)
        for room in ("graphs", "engine", "solver", "nodes", "tools", "tests"):
            found += sorted(p for p in glob.glob(room + "/**/README.md", root_dir=self.root, recursive=True) if "node_modules" not in p)
        out = {p: "index.html" if p == "README.md" else self._page_of(p) for p in found}
        return out

    @staticmethod
    def _page_of(path):
        if path.endswith("/README.md"):
            # The rooms stand beside docs; nodes/ itself is the reference's.
            return "rooms/" + path[: -len("README.md")] + "index.html" if not path.startswith("graphs/") else path[:-9] + "index.html"
        return path[:-3] + ".html"

    def _read(self, path):
        with open(os.path.join(self.root, path), encoding="utf-8") as file:
            return file.read()

    def _title(self, path):
        for line in self._read(path).splitlines():
            if line.startswith("# "):
                return line[2:].strip()
        return path

    def _graph_lines(self):
        """By graph's path what graphs/README.md says of it."""
        out = {}
        for line in self._read("graphs/README.md").splitlines():
            match = re.match(r"\| \[[^]]+\]\(([^)]+\.json)\) \| (.*) \|$", line)
            if match:
                out["graphs/" + match[1]] = match[2]
        return out

    def add_picture(self, path, file):
        target = "pictures/" + os.path.basename(path)[:-5] + ".png"
        os.makedirs(os.path.join(self.folder, "pictures"), exist_ok=True)
        shutil.copyfile(file, os.path.join(self.folder, target))
        self.pictures[path] = target

    # Links

    def target(self, path):
        """Where what stands at a path of the project is on the site; None if it is not a part of it. Files that are
        shown as they are get copied."""
        path = posixpath.normpath(path)
        if path in REFERENCE:
            return REFERENCE[path]
        if path in self.documents:
            return self.documents[path]
        if path in self.graphs:
            return path[:-5] + ".html"
        full = os.path.join(self.root, path)
        if os.path.isdir(full):
            return self.documents.get(posixpath.join(path, "README.md"))
        if os.path.isfile(full):
            copy = os.path.join(self.folder, path)
            os.makedirs(os.path.dirname(copy), exist_ok=True)
            shutil.copyfile(full, copy)
            return path
        return None

    def _linked(self, body, source, page):
        """Links and images of a document lead to where their targets are on the site."""

        def change(match):
            attribute, address = match.groups()
            address = html.unescape(address)
            if re.match(r"[a-z]+:", address) or address.startswith("#"):
                return match.group(0)
            path, _, anchor = address.partition("#")
            full = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
            found = self.target(full)
            if found is None:
                return 'class="dim"'
            if full in REFERENCE and anchor:
                names = {n.lower(): n for n in list(self.types) + [c[0] for c in self.codes]}
                if anchor.lower() in names:
                    found, anchor = f"{posixpath.dirname(found)}/{names[anchor.lower()]}.html", ""
            return f'{attribute}="{_to(page, found)}{"#" + anchor if anchor else ""}"'

        return re.sub(r'(href|src)="([^"]*)"', change, body)

    def _referring(self, body, page):
        """Types, attributes and codes become links to their pages."""
        plugs = {t: {a["name"] for a in of["inputs"] + of["outputs"]} for t, of in self.types.items()}
        known = {c[0] for c in self.codes}

        def change(text, in_code):
            def code(match):
                c = match.group(0)
                return f'<a href="{_to(page, f"codes/{c}.html")}">{c}</a>' if c in known else c

            if in_code:
                kind, _, attribute = text.partition(".")
                if kind in plugs and (not attribute or attribute in plugs[kind]):
                    anchor = f"#{attribute}" if attribute else ""
                    return f'<a href="{_to(page, f"nodes/{kind}.html")}{anchor}">{text}</a>'
            text = re.sub(r"\b(?:DG|FE|IO)\d{3}\b", code, text)
            if in_code:
                return text

            def plug(match):
                kind, attribute = match.groups()
                if attribute in plugs.get(kind, ()):
                    return f'<a href="{_to(page, f"nodes/{kind}.html")}#{attribute}">{match.group(0)}</a>'
                return match.group(0)

            return re.sub(r"\b([a-z]\w+)\.([a-z]\w+)\b", plug, text)

        return markdown.outside_links(body, change)

    # Pages

    def write(self):
        """Gives how many pages there are."""
        count = 0
        for path, page in self.documents.items():
            body = markdown.with_addresses(markdown.with_tables_that_scroll(markdown.to_html(self._read(path))))
            count += self._put(page, self.titles[path], self._linked(body, path, page))
        for name in self.types:
            count += self._put(f"nodes/{name}.html", name, self._node(name))
        count += self._put("nodes/index.html", "Node types", self._nodes())
        for code, wrong, remedy in self.codes:
            count += self._put(f"codes/{code}.html", f"{code}: {wrong}", self._code(code, wrong, remedy))
        count += self._put("codes/index.html", "Diagnostic codes", self._all_codes())
        for path in self.graphs:
            count += self._put(path[:-5] + ".html", os.path.basename(path)[:-5], self._graph(path))
        here = os.path.dirname(os.path.abspath(__file__))
        shutil.copyfile(os.path.join(here, "style.css"), os.path.join(self.folder, "style.css"))
        return count

    def _put(self, page, title, body):
        full = os.path.join(self.folder, page)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, "w", encoding="utf-8") as file:
            file.write(
                '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
                '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
                f"<title>{phrase(re.sub('[`*]', '', title))} · Sinew</title>\n"
                f'<link rel="stylesheet" href="{_to(page, "style.css")}">\n</head>\n<body>\n<div class="all">\n'
                f"{self._menu(page)}\n<main>\n{self._referring(body, page)}\n</main>\n</div>\n</body>\n</html>\n"
            )
        return 1

    def _menu(self, page):
        def item(target, text):
            here = ' aria-current="page"' if target == page else ""
            return f'<li><a href="{_to(page, target)}"{here}>{phrase(text)}</a></li>'

        groups = [("Sinew", [("index.html", "Sinew"), (self.documents["docs/start.md"], "Start")])]
        groups[0][1].append((self.documents["graphs/README.md"], "Graphs"))
        groups.append(("Reference", [("nodes/index.html", "Node types"), ("codes/index.html", "Diagnostic codes")]))
        for name, folder in (("Concepts", "docs/concepts"), ("Theory", "docs/theory"), ("More", "docs")):
            of = [p for p in self.documents if posixpath.dirname(p) == folder and p != "docs/start.md"]
            groups.append((name, [(self.documents[p], re.sub("[`*]", "", self.titles[p])) for p in of]))
        rooms = [(page, page[len("rooms/") : -len("/index.html")]) for page in self.documents.values() if page.startswith("rooms/")]
        groups.append(("Rooms of the source", rooms))
        if page.startswith("nodes/"):
            groups.insert(2, ("Types", [(f"nodes/{n}.html", n) for n in self.types]))
        if page.startswith("codes/"):
            groups.insert(2, ("Codes", [(f"codes/{c[0]}.html", c[0]) for c in self.codes]))
        lists = "".join(f"<h2>{name}</h2><ul>{''.join(item(*one) for one in of)}</ul>" for name, of in groups)
        return f'<nav><input type="checkbox" id="menu"><label for="menu">Pages</label><div class="pages">{lists}</div></nav>'

    def _node(self, name):
        kind = self.types[name]
        out = [f"<h1>{name}</h1>", f"<p>{markdown.inline(kind['doc'])}</p>"]
        example = graph_files.example_of(name, self.graphs)
        out.append("<h2>Inputs</h2>" + self._attributes(kind["inputs"], self._givers))
        out.append("<h2>Outputs</h2>" + self._attributes(kind["outputs"], self._takers))
        if example:
            path, node_name, node = example
            page = f"nodes/{name}.html"
            out.append("<h2>Example</h2>")
            link = f'<a href="{_to(page, self.target(path))}">{os.path.basename(path)}</a>'
            out.append(f"<p>From {link}: {markdown.inline(self._said_of(path))}</p>")
            out.append(f"<pre><code>{phrase(graph_files.node_text(node_name, node))}</code></pre>")
            out.append(f"<pre><code>sinew run {path} --out out/{os.path.basename(path)[:-5]} --open</code></pre>")
            if path in self.pictures:
                out.append(f'<p><img src="{_to(page, self.pictures[path])}" alt="First, middle and last frame of {path}"></p>')
            others = [p for p, g in self.graphs.items() if name in graph_files.types(g) and p != path]
            if others:
                links = ", ".join(f'<a href="{_to(page, self.target(p))}">{os.path.basename(p)[:-5]}</a>' for p in others[:12])
                out.append(f"<p>Also in {links}.</p>")
        return "\n".join(out)

    def _said_of(self, path):
        """What graphs/README.md says of a graph, without its links, which lead from another place."""
        return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", self.said.get(path, "a graph to measure by"))

    def _attributes(self, attributes, others):
        if not attributes:
            return "<p>None.</p>"
        rows = []
        for a in attributes:
            more = others(a)
            rows.append(
                f'<div><dt id="{a["name"]}"><a href="#{a["name"]}"><code>{a["name"]}</code></a></dt><dd class="facts">{_facts(a)}</dd>'
                f"<dd>{markdown.inline(a['doc'])}</dd>{more}</div>"
            )
        return f'<dl class="attributes">{"".join(rows)}</dl>'

    def _givers(self, attribute):
        """Which outputs can be connected, for inputs that only a connection brings."""
        if attribute["kind"] == "value":
            return ""
        found = [f"{n}.{o['name']}" for n, t in self.types.items() for o in t["outputs"] if o["type"] == attribute["type"]]
        return f'<dd class="facts">Takes {", ".join(f"<code>{f}</code>" for f in found)}</dd>' if found else ""

    def _takers(self, attribute):
        found = [
            f"{n}.{i['name']}"
            for n, t in self.types.items()
            for i in t["inputs"]
            if i["type"] == attribute["type"] and i["kind"] != "value"
        ]
        return f'<dd class="facts">Goes into {", ".join(f"<code>{f}</code>" for f in found)}</dd>' if found else ""

    def _nodes(self):
        rows = "".join(
            f'<tr><td><a href="{n}.html">{n}</a></td><td>{markdown.inline(t["doc"])}</td></tr>' for n, t in self.types.items()
        )
        schema = '<a href="../reference/graph.schema.json">JSON Schema</a>'
        return (
            f"<h1>Node types</h1><p>What the program declares; <code>sinew nodes TYPE</code> prints the same. For editors: the {schema} "
            f'of graph files.</p><div class="scroll"><table><thead><tr><th>type</th><th>what it does</th></tr></thead><tbody>{rows}</tbody></table></div>'
        )

    def _code(self, code, wrong, remedy):
        family = next(name for start, name in FAMILIES if code.startswith(start))
        out = [f"<h1>{code}: {markdown.inline(wrong)}</h1>", f'<p class="dim">{family}</p>']
        out.append(f"<h2>What to do</h2><p>{markdown.inline(remedy)}</p>")
        if code in self.broken:
            path, said = self.broken[code]
            name = os.path.basename(path)
            text = self._read(path)
            out.append(f"<h2>Example</h2><p><code>sinew check {path}</code> says</p>")
            out.append(f'<pre class="said"><code>{phrase(said.strip())}</code></pre>')
            link = f'<a href="{_to(f"codes/{code}.html", self.target(path))}">{name}</a>'
            shown = text if len(text) < 4000 else text[:4000] + "\n…"
            out.append(f"<p>of {link}:</p><pre><code>{phrase(shown.strip())}</code></pre>")
        return "\n".join(out)

    def _all_codes(self):
        out = ["<h1>Diagnostic codes</h1><p>What is wrong, by code. A code keeps its meaning for ever.</p>"]
        for start, name in FAMILIES:
            rows = "".join(
                f'<tr><td><a href="{c}.html">{c}</a></td><td>{markdown.inline(wrong)}</td><td>{markdown.inline(remedy)}</td></tr>'
                for c, wrong, remedy in self.codes
                if c.startswith(start)
            )
            head = "<thead><tr><th>code</th><th>what is wrong</th><th>what to do</th></tr></thead>"
            out.append(f'<h2>{name}</h2><div class="scroll"><table>{head}<tbody>{rows}</tbody></table></div>')
        return "\n".join(out)

    def _graph(self, path):
        page, name = path[:-5] + ".html", os.path.basename(path)[:-5]
        out = [f"<h1>{name}</h1>", f"<p>{markdown.inline(self._said_of(path))}</p>"]
        if path in self.pictures:
            out.append(f'<p><img src="{_to(page, self.pictures[path])}" alt="First, middle and last frame"></p>')
        out.append(f"<pre><code>sinew run {path} --out out/{name} --open</code></pre>")
        used = ", ".join(f"<code>{t}</code>" for t in sorted(graph_files.types(self.graphs[path])))
        out.append(f"<p>{len(self.graphs[path].get('nodes', {}))} nodes of the types {used}.</p>")
        text = self._read(path)
        if len(text) > 20000:
            out.append("<p>The file is long; its beginning:</p>")
            text = text[:6000] + "\n…"
        out.append(f"<pre><code>{phrase(text.strip())}</code></pre>")
        return "\n".join(out)


def _to(page, target):
    """The address of a page as seen from another one."""
    return posixpath.relpath(target, posixpath.dirname(page) or ".")


def _number(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, list):
        return " ".join(_number(v) for v in value) if value else "none"
    return str(value) if not isinstance(value, str) else value or "none"


def _facts(a):
    """Type, unit, default, range: a line."""
    out = [a["type"] if a["kind"] in ("value", "output") else f"{a['kind']}: {a['type']}"]
    if a.get("unit", "1") != "1":
        out[0] += f" in {a['unit']}"
    if a.get("required"):
        out.append("required")
    if "default_from" in a:
        out.append(f"default: the graph's {a['default_from']}")
    elif "default" in a and not a.get("required") and a["type"] != "file":
        value = a["default"]
        plain = isinstance(value, (bool, int, float, str)) or (isinstance(value, list) and all(isinstance(v, (int, float)) for v in value))
        out.append(f"default {_number(value) if plain else json.dumps(value)}")
    limits = a.get("limits", {})
    if limits:
        words = {"min": "at least", "max": "at most", "above": "above", "below": "below"}
        out.append(", ".join(f"{words[k]} {_number(v)}" for k, v in limits.items()))
    if a.get("keyable"):
        out.append("keyable")
    if a.get("options"):
        out.append("one of " + " | ".join(a["options"]))
    if a.get("presets"):
        out.append("presets " + ", ".join(f"{k} {_number(v)}" for k, v in a["presets"].items()))
    return phrase("; ".join(out))
