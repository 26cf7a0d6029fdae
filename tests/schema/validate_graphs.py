#!/usr/bin/env python3
"""Validates all graphs that ship against docs/reference/graph.schema.json, with a validator that knows nothing of Sinew;
and spoils them to see that the schema notices. Ends with 77 where Debian's python3-jsonschema is not installed.

SPDX-License-Identifier: GPL-3.0-or-later
"""
import copy
import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed: tools/install_packages")
    sys.exit(77)

root = pathlib.Path(__file__).resolve().parents[2]


def without_comments(text):
    """The JSON in a graph file; what is no text and no comment stays."""
    out, at = [], 0
    while at < len(text):
        if text[at] == '"':
            end = at + 1
            while text[end] != '"':
                end += 2 if text[end] == "\\" else 1
            out.append(text[at : end + 1])
            at = end + 1
        elif text.startswith("//", at):
            at = text.find("\n", at) if "\n" in text[at:] else len(text)
        elif text.startswith("/*", at):
            at = text.index("*/", at) + 2
        else:
            out.append(text[at])
            at += 1
    return "".join(out)


def graphs():
    for folder in ("learn", "demos", "scenes", "bench"):
        for path in sorted((root / "graphs" / folder).rglob("*.json")):
            document = json.loads(without_comments(path.read_text(encoding="utf-8")))
            if isinstance(document, dict) and str(document.get("format", "")).startswith("sinew "):
                yield path, document


def spoiled(document):
    """Copies with one thing wrong each, and what that is."""
    for name, node in document["nodes"].items():
        for attribute in node.get("inputs", {}):
            other = copy.deepcopy(document)
            inputs = other["nodes"][name]["inputs"]
            inputs[attribute + "X"] = inputs.pop(attribute)
            yield other, f"{name}.{attribute} misspelled"
            break
        other = copy.deepcopy(document)
        other["nodes"][name]["type"] += "X"
        yield other, f"{name}: another type"
        break
    for change, what in (
        (lambda d: d.update(format="sinew 999"), "format"),
        (lambda d: d.update(node={}), "unknown key"),
        (lambda d: d["nodes"].update({"a.b": {"type": "zMaterial"}}), "a dot in a name"),
        (lambda d: d.update(includes={"x": {}}), "an include without a file"),
        (lambda d: d.update(includes={"x": {"file": "a.json", "overrides": {"a": 1}}}), "an override of no input"),
        (lambda d: d["nodes"].update(m={"type": "zMaterial", "inputs": {"poissonsRatio": 3}}), "a limit"),
        (lambda d: d["nodes"].update(m={"type": "zTissue", "inputs": {"mesh": {"from": "mesh"}}}), "a wire"),
        (lambda d: d["nodes"].update(m={"type": "zMaterial", "inputs": {"youngsModulus": {"preset": "stone"}}}), "a preset"),
        (lambda d: d["nodes"].update(m={"type": "weights", "inputs": {"mesh": {"from": "a.b"}, "mode": "rmp"}}), "an option"),
    ):
        other = copy.deepcopy(document)
        change(other)
        yield other, what


def main():
    schema = json.loads((root / "docs/reference/graph.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    wrong = count = 0
    for path, document in graphs():
        count += 1
        for error in validator.iter_errors(document):
            wrong += 1
            print(f"{path}: {'/'.join(map(str, error.absolute_path))}: {error.message[:200]}")
        named = document.get("$schema")
        if named and not (path.parent / named).resolve().samefile(root / "docs/reference/graph.schema.json"):
            wrong += 1
            print(f"{path}: $schema names another file")
        if path.parent.name in ("learn", "demos") and not named:
            wrong += 1
            print(f"{path}: names no $schema")
        if path.name not in ("02_muscle_pulls.json", "25_included_limbs.json"):
            continue
        for other, what in spoiled(document):
            if validator.is_valid(other):
                wrong += 1
                print(f"{path}: the schema does not notice: {what}")
    print(f"{count} graphs, {wrong} faults")
    return 1 if wrong or count < 50 else 0


sys.exit(main())
