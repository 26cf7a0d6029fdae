# Graph files as pages show them: read, shortened to a node, counted by type.
# SPDX-License-Identifier: GPL-3.0-or-later
import json
import re


def read(text):
    """A graph file, which may have comments."""
    out = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda m: m.group(1) or "", text, flags=re.S)
    return json.loads(out)


def node_text(name, node):
    """A node as hands write it: an input a line."""
    inputs = node.get("inputs", {})
    head = f'"{name}": {{ "type": {json.dumps(node["type"])}'
    if not inputs:
        return head + " }"
    lines = ",\n".join(f"    {json.dumps(k)}: {_short(v)}" for k, v in inputs.items())
    return head + ', "inputs": {\n' + lines + " } }"


def _short(value):
    """JSON of a value; long lists end in dots."""
    text = json.dumps(value)
    return text if len(text) < 300 else text[:280] + " …"


def types(graph):
    return {node.get("type") for node in graph.get("nodes", {}).values()}


def example_of(kind, graphs):
    """The (path, name, node) that shows a type: in the first graph that has it, of those that teach before others, the
    node with the most inputs. graphs: by path."""
    found = []
    for path, graph in graphs.items():
        rank = ("graphs/learn/", "graphs/demos/", "graphs/scenes/", "graphs/bench/").index(path[: path.rindex("/") + 1])
        for name, node in graph.get("nodes", {}).items():
            if node.get("type") == kind:
                found.append((rank, path, -len(node.get("inputs", {})), name, node))
    if not found:
        return None
    _, path, _, name, node = min(found, key=lambda f: f[:4])
    return path, name, node
