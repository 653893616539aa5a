# SPDX-License-Identifier: MIT
"""Writes several mutants into one text: the smallest expression around each becomes `(on ? faulty : true)`, or its
statement `if (on) { faulty } else { true }`. The rest of the text keeps its lines.
"""
import re
from dataclasses import dataclass

_ON = "::crofton::mutation::kOn == {}"
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
_TOKEN = re.compile(r"0x[\da-fA-F.]+p[+-]?\d+f?|\d+\.?\d*(?:e[+-]?\d+)?[fu]?|\w+|\s+|[-+*/<>=!&|^]=|&&|\|\||->|.", re.S)
_ASSIGNMENT = re.compile(r"(?<![=<>!])=(?!=)")


@dataclass
class Edit:
    begin: int
    end: int
    number: int
    text: str  # what stands there while the mutant is in force
    statement: bool


def _trim(text, begin, find, replace):
    """The range of what differs, in whole tokens, and what it becomes."""
    old, new = _TOKEN.findall(find), _TOKEN.findall(replace)
    first = 0
    while first < min(len(old), len(new)) and old[first] == new[first]:
        first += 1
    last = 0
    while last < min(len(old), len(new)) - first and old[-1 - last] == new[-1 - last]:
        last += 1
    end = len(old) - last
    before = len("".join(old[:first]))
    return begin + before, begin + before + len("".join(old[first:end])), "".join(new[first:len(new) - last])


def _open(text):
    """How many brackets are closed that were not opened, and opened that are not closed; whether a comma stands alone."""
    depth, low, comma = 0, 0, False
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        low = min(low, depth)
        comma = comma or (depth == 0 and c == ",")
    return -low, depth - low, comma


def _balanced(text):
    return _open(text)[:2] == (0, 0)


def _left(plain, at):
    """Where the expression begins that goes on to the left of `at`."""
    depth = 0
    while at > 0:
        c = plain[at - 1]
        if c in ")]}":
            depth += 1
        elif c in "([{":
            if depth == 0:
                return at
            depth -= 1
        elif depth == 0:
            if c in ";,~" or plain[:at].endswith((" ? ", " : ", "return ")):
                return at
            if c == "=" and plain[at] != "=" and plain[at - 2] not in "=<>!":
                return at
        at -= 1
    return at


def _right(plain, at):
    depth = 0
    while at < len(plain):
        c = plain[at]
        if c in "([{":
            depth += 1
        elif c in ")]}":
            if depth == 0:
                return at
            depth -= 1
        elif depth == 0 and (c in ";," or plain.startswith((" ? ", " : "), at)):
            return at
        at += 1
    return at


def _expression(text, plain, begin, end, new):
    """The range of the smallest whole expression around a difference, or None."""
    if ";" in plain[begin:end] + new or re.search(r"\b(return|if) ", plain[begin:end] + new):
        return None
    low, high = begin, end
    if _ASSIGNMENT.search(plain[begin:end]):
        place = re.search(r"[\w.:>-]+(\[[^\]]*\])*\s*$", plain[:low])
        low = place.start() if place else low
    else:
        low = _left(plain, low)
    high = _right(plain, high)
    for _ in range(4):
        while low < begin and plain[low].isspace():
            low += 1
        while high > end and plain[high - 1].isspace():
            high -= 1
        old, whole = plain[low:high], plain[low:begin] + new + plain[end:high]
        closed, opened, comma = (max(pair) for pair in zip(_open(old), _open(whole)))
        if closed and plain[low - 1] in "([{":
            low = _left(plain, low - 1)
        if opened and plain[high] in ")]}":
            high = _right(plain, high + 1)
        if not closed and not opened:
            return None if comma or not old.strip() or not whole.strip() else (low, high)
    return None


def _statement(text, plain, begin, end, new):
    """The lines around a difference, where they are whole statements; or None."""
    low = text.rfind("\n", 0, begin) + 1
    high = text.find("\n", end)
    old, whole = plain[low:high], _COMMENT.sub("", text[low:begin] + new + text[end:high])
    if not _balanced(old) or not _balanced(whole) or not old.rstrip(" ~").endswith((";", "}")):
        return None
    if whole.strip() and not whole.rstrip().endswith((";", "}")):
        return None
    if plain[:low].rstrip(" \n~")[-1] not in ";{})":
        return None
    declares = r"(?!return\b|delete\b|throw\b|else\b|if\b|for\b)(const |static |constexpr )*[\w:]+(<[^;=]*>)?[&*]? \w+\s*[=({]"
    if re.match(r"\s*" + declares, old) or re.match(r"\s*[}]", old):
        return None
    return low, high


def _plain(text):
    """Comments, strings and characters become `~`, every other character stays in its place."""
    token = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", re.S)
    return token.sub(lambda m: re.sub(r"[^\n]", "~" if m.group()[0] == "/" else "_", m.group()), text)


def edit(text, number, mutant):
    """The Edit of a mutant, or None where it cannot be switched."""
    at = mutant.at
    plain = _plain(text)
    begin, end, new = _trim(text, at, mutant.find, mutant.replace)
    found = _expression(text, plain, begin, end, new)
    if found and plain[found[1]] == ";" and plain[:found[0]].rstrip(" \n~")[-1] in ";{})":
        line = plain[plain.rfind("\n", 0, found[0]) + 1:found[0]]
        if not _open(line)[1]:  # not in the head of a loop
            found = None  # all of a statement
    statement = found is None
    if statement:
        if new == ";" and plain[end - 1] == ";":
            found = begin, end
        else:
            found = _statement(text, plain, begin, end, new)
    if found is None:
        return None
    return Edit(*found, number, text[found[0]:begin] + new + text[end:found[1]], statement)


def _one_line(piece):
    return " ".join(_COMMENT.sub("", piece).split("\n"))


def write(text, edits):
    """The text with all of the edits, which are nested or apart."""
    edits = sorted(edits, key=lambda e: (e.begin, -e.end))
    result, at = [], 0
    while edits:
        outer = edits[0]
        inner = [e for e in edits[1:] if e.begin < outer.end]
        edits = edits[1 + len(inner):]
        same = [e for e in inner if (e.begin, e.end) == (outer.begin, outer.end)]
        below = [e for e in inner if e not in same]
        old = text[outer.begin:outer.end]
        if below:
            moved = [Edit(e.begin - outer.begin, e.end - outer.begin, e.number, e.text, e.statement) for e in below]
            piece = write(old, moved)
        else:
            piece = old
        piece = _one_line(piece)
        for e in [outer] + same:
            on = _ON.format(e.number)
            if "$ON" in e.text:
                piece = _one_line(e.text).replace("$ON", f"({on})")
                for b in below:  # once there, too: else one of the two would be lost
                    there = text[b.begin:b.end]
                    if same or piece.count(there) != 1:
                        raise ValueError(f"mutant {b.number} is inside of what mutant {e.number} replaces")
                    piece = piece.replace(there, write(there, [Edit(0, len(there), b.number, b.text, b.statement)]))
            elif e.statement:
                piece = f"if ({on}) {{ {_one_line(e.text)} }} else {{ {piece} }}"
            else:
                piece = f"({on} ? ({_one_line(e.text)}) : ({piece}))"
        result.append(text[at:outer.begin])
        result.append(piece + "\n" * old.count("\n"))
        at = outer.end
    return "".join(result) + text[at:]
