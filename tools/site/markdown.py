# From Markdown to HTML: cmark-gfm reads it, here headings get their addresses and code becomes links.
# SPDX-License-Identifier: GPL-3.0-or-later
import html
import re
import subprocess


def to_html(text):
    """GitHub's Markdown as HTML."""
    words = ["cmark-gfm", "-e", "table", "-e", "strikethrough", "-e", "autolink"]
    return subprocess.run(words, input=text, stdout=subprocess.PIPE, check=True, text=True).stdout


def slug(heading):
    """The address that GitHub gives a heading."""
    words = re.sub(r"<[^>]+>", "", heading)
    return re.sub(r"[^\w\- ]", "", html.unescape(words).strip().lower()).replace(" ", "-")


def with_addresses(page):
    """Headings that can be linked to; one that comes twice gets a number, as on GitHub."""
    seen = {}

    def add(match):
        level, inner = match.groups()
        name = slug(inner)
        seen[name] = seen.get(name, -1) + 1
        if seen[name]:
            name += f"-{seen[name]}"
        return f'<h{level} id="{html.escape(name)}">{inner}</h{level}>'

    return re.sub(r"<h([1-6])>(.*?)</h\1>", add, page, flags=re.S)


def with_tables_that_scroll(page):
    return page.replace("<table>", '<div class="scroll"><table>').replace("</table>", "</table></div>")


def outside_links(page, change):
    """Changes text that is in no link, no heading and no block of code: `change(text, in_code)`."""
    out, depth, in_code = [], 0, False
    for part in re.split(r"(<[^>]+>)", page):
        if part.startswith("<"):
            if re.match(r"<(a|pre|h[1-6]|title|svg)\b", part):
                depth += 1
            elif re.match(r"</(a|pre|h[1-6]|title|svg)>", part):
                depth -= 1
            elif part == "<code>":
                in_code = True
            elif part == "</code>":
                in_code = False
            out.append(part)
        else:
            out.append(part if depth else change(part, in_code))
    return "".join(out)


_sentences = {}


def prepare(texts):
    """Reads many sentences at once, so that `inline` has them."""
    texts = sorted(set(texts))
    parts = to_html("\n\n⁂\n\n".join(texts)).split("<p>⁂</p>")
    _sentences.update((text, re.sub(r"^<p>|</p>$", "", part.strip())) for text, part in zip(texts, parts, strict=True))


def inline(text):
    """A sentence, with `code` in it, as it stands in declarations and cells."""
    if text not in _sentences:
        prepare([text])
    return _sentences[text]


def phrase(text):
    """Plain words as HTML."""
    return html.escape(text, quote=False)
