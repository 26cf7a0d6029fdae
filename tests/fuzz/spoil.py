# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done to good inputs: to bytes, to text with numbers, to JSON. The same seed does the same on every machine."""
import copy
import hashlib
import json
import re


class Dice:
    """Splitmix64: a generator of its own, so that inputs stay the same whatever Python runs them."""

    def __init__(self, *seed):
        text = ":".join(map(str, seed)).encode()
        self.state = int.from_bytes(hashlib.sha256(text).digest()[:8], "little")

    def below(self, n):
        self.state = (self.state + 0x9E3779B97F4A7C15) & 0xFFFFFFFFFFFFFFFF
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & 0xFFFFFFFFFFFFFFFF
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & 0xFFFFFFFFFFFFFFFF
        return (z ^ (z >> 31)) % n

    def of(self, options):
        return options[self.below(len(options))]


NUMBERS = ["0", "-0", "1", "-1", "2", "3", "255", "65536", "2147483647", "2147483648", "-2147483649", "4294967295",
           "18446744073709551615", "1000000000000000000", "1e-320", "1e-30", "1e30", "1e155", "1e308", "1e400", "-1e308",
           "nan", "inf", "-inf", "0x10", "1.5", "1,5", "1e", ".", "-", "", "99999999999999999999999999", "\u0661", "True"]


def spoil_bytes(dice, data, others):
    """One fault in bytes; `others` are whole inputs of the same kind, to splice with."""
    data = bytearray(data)
    size = max(1, len(data))
    kind = dice.below(8)
    at = dice.below(size)
    if kind == 0:  # cut off
        del data[at:]
    elif kind == 1:  # one byte
        if data:
            data[at] = dice.of([0, 255, 127, 128, 10, 32, 45, 48, 57, dice.below(256)])
    elif kind == 2:  # a bit
        if data:
            data[at] ^= 1 << dice.below(8)
    elif kind == 3:  # a piece gone
        del data[at:at + 1 + dice.below(64)]
    elif kind == 4:  # a piece twice, now and then very often
        data[at:at] = data[at:at + 1 + dice.below(64)] * dice.of([1, 1, 2, 200])
    elif kind == 5:  # bytes at random
        data[at:at] = bytes(dice.below(256) for _ in range(1 + dice.below(16)))
    elif kind == 6:  # a binary number
        width = dice.of([2, 4, 8])
        value = dice.of([0, 1, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x7FF0000000000000, 0x7FF8000000000001, 1 << 62])
        data[at:at + width] = (value & ((1 << 8 * width) - 1)).to_bytes(width, dice.of(["little", "big"]))
    else:  # the beginning of one, the end of another
        other = dice.of(others)
        data = data[:at] + other[dice.below(max(1, len(other))):]
    return bytes(data)


def spoil_text(dice, data, others):
    """One fault in text made of words and lines."""
    kind = dice.below(5)
    if kind == 0:
        return spoil_bytes(dice, data, others)
    if kind <= 2:  # a number becomes another one
        found = list(re.finditer(rb"[-+]?[0-9.]+(e[-+]?[0-9]+)?", data))
        if found:
            m = found[dice.below(len(found))]
            return data[:m.start()] + dice.of(NUMBERS).encode() + data[m.end():]
    lines = data.split(b"\n")
    i, j = dice.below(len(lines)), dice.below(len(lines))
    if kind == 3:  # lines change places, or one goes, or comes again
        what = dice.below(3)
        if what == 0:
            lines[i], lines[j] = lines[j], lines[i]
        elif what == 1:
            del lines[i]
        else:
            lines.insert(j, lines[i])
    else:  # words change places, go or come again
        words = lines[i].split(b" ")
        w = dice.below(len(words))
        words[w:w + 1] = dice.of([[], [words[w]] * 2, [words[w]] * 500, [lines[j].split(b" ")[0]]])
        lines[i] = b" ".join(words)
    return b"\n".join(lines)


class Nested:
    """A value in so many lists, which Python's own recursion need not walk down."""

    def __init__(self, depth, value):
        self.depth, self.value = depth, value


def places(tree, way=()):
    """All places of a JSON tree, each as the keys that lead there."""
    yield way
    if isinstance(tree, dict):
        for key in tree:
            yield from places(tree[key], way + (key,))
    elif isinstance(tree, list):
        for i in range(len(tree)):
            yield from places(tree[i], way + (i,))


def there(tree, way):
    for key in way:
        tree = tree[key]
    return tree


def values_by_key(trees):
    """What stands under each key of some trees, and the keys' texts and those of values."""
    by_key, words = {}, set()
    for tree in trees:
        for way in places(tree):
            if way and isinstance(way[-1], str):
                by_key.setdefault(way[-1], []).append(there(tree, way))
                words.add(way[-1])
            if isinstance(there(tree, way), str):
                words.add(there(tree, way))
    return by_key, sorted(words)


def spoil_json(dice, tree, by_key, words):
    """One change in a JSON tree, after which it may be right as before. `by_key`, `words`: see values_by_key."""
    tree = copy.deepcopy(tree)
    ways = [w for w in places(tree) if w]
    if not ways:
        return tree
    way = dice.of(ways)
    gentle = dice.below(10)
    if gentle < 7:  # numbers and what else stands under names that mean something
        ways_to_values = [w for w in ways if not isinstance(there(tree, w), dict) and w[-1] in by_key]
        way = dice.of(ways_to_values or ways)
    parent, key = there(tree, way[:-1]), way[-1]
    value = parent[key]
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if gentle < 7 and key in by_key and (not is_number or gentle < 2):
        parent[key] = copy.deepcopy(dice.of(by_key[key]))
        return tree
    kind = 2 if gentle < 7 else dice.below(9)
    if kind == 0:
        del parent[key]
    elif kind == 1:
        parent[key] = dice.of([None, True, False, 0, -1, 1, 3, 1e-12, 1e9, -1e9, 1e155, 1e300, 2**31, 2**53, 10**18, "",
                               "x", [], {}, [[]], [0, 0, 0], [1e300] * 16, {"keys": [[1, 0], [3, 1]]},
                               {"value": 1, "unit": "kPa"}, {"from": "nothing.out"}])
    elif kind == 2 and is_number:
        parent[key] = value * dice.of([-1, 0, 1e-6, 0.1, 0.5, 0.7, 1.5, 2, 3, 10, 1e6])
    elif kind == 3:  # what stands elsewhere
        parent[key] = copy.deepcopy(there(tree, dice.of(ways)))
    elif kind == 4:
        parent[key] = dice.of(words)
    elif kind == 5 and isinstance(value, list) and value:
        value[dice.below(len(value)):] = [copy.deepcopy(dice.of(value)) for _ in range(dice.of([0, 1, 2, 50]))]
    elif kind == 6 and isinstance(parent, dict):  # under another name
        parent[dice.of(words)] = parent.pop(key)
    elif kind == 7 and is_number:
        parent[key] = {"keys": [[1, value], [2, value], [dice.of([3, 2, 1e9, -1]), value]]}
    elif kind == 8:
        parent[key] = Nested(dice.of([1, 3, 3, 2000]), value)
    else:
        other = dice.of(ways)
        if other[:len(way)] != way and way[:len(other)] != other:  # change places
            there(tree, other[:-1])[other[-1]], parent[key] = value, there(tree, other)
    return tree


def as_text(tree):
    """JSON text."""
    if isinstance(tree, dict):
        return "{" + ",".join(json.dumps(key) + ":" + as_text(tree[key]) for key in tree) + "}"
    if isinstance(tree, list):
        return "[" + ",".join(map(as_text, tree)) + "]"
    if isinstance(tree, Nested):
        return "[" * tree.depth + as_text(tree.value) + "]" * tree.depth
    return json.dumps(tree)
