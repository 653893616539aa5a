# SPDX-License-Identifier: MIT
"""Mutants: deliberate faults of the engine's sources, written down (*.txt) or made by rule."""
import hashlib
import re
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Mutant:
    name: str
    file: str
    find: str
    replace: str
    why: str
    tests: list = field(default_factory=list)
    equivalent: str = ""  # the reason why no test can tell it from the original
    switch: str = ""  # what stands in the place of `find` where $ON says whether the mutant is in force
    at: int = -1  # where the text begins, for mutants made by rule

    @property
    def module(self):
        return self.file.split("/")[1]

    def apply(self, text):
        """The text of the file with the fault in it. ValueError if the place is not there exactly once."""
        at = self.at
        if at < 0:
            if text.count(self.find) != 1:
                raise ValueError(f"{self.name}: the text to find is {text.count(self.find)} times in {self.file}, not once")
            at = text.index(self.find)
        return text[:at] + self.replace + text[at + len(self.find):]


def read_list(path):
    """Blocks of `key: value` lines, each begun by `[name]`. `find` and `with` may have several lines, each with its key."""
    mutants, block = [], None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        if line.startswith("["):
            block = {"name": line.strip("[]")}
            mutants.append(block)
            continue
        key, colon, value = line.partition(":")
        if block is None or not colon or key not in ("file", "find", "with", "why", "tests", "equivalent", "switch"):
            raise ValueError(f"{path}:{number}: expected [name] or one of file, find, with, why, tests, equivalent, switch")
        value = value[1:] if value.startswith(" ") else value
        block[key] = block[key] + "\n" + value if key in block else value
    for block in mutants:
        missing = {"file", "find", "with", "why"} - block.keys()
        if missing:
            raise ValueError(f"{path}: [{block['name']}] lacks {', '.join(sorted(missing))}")
    return [Mutant(b["name"], b["file"], b["find"], b["with"], b["why"], b.get("tests", "").split(), b.get("equivalent", ""),
                   b.get("switch", ""))
            for b in mutants]


# What may stand in its place, and what the fault is.
_OPERATORS = [
    ("comparison", r" (<=|>=|==|!=|<|>) ", {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}),
    ("sign", r" (\+=|-=|\+|-) ", {"+": "-", "-": "+", "+=": "-=", "-=": "+="}),
    ("logic", r" (&&|\|\|) ", {"&&": "||", "||": "&&"}),
]
_BOUND = re.compile(r"(?<![\w.])(0x1p-\d+f?)(?![\w.])|(?<![\w.])(\d+\.\d*)(?= \* kUnit)")
_OFF_BY_ONE = re.compile(r"(?:[+-] (1)(?=[;)\] ]))|(?:= (0)(?=; \w+ [<!]))")
_STATEMENT = re.compile(r"^ +(?!return|const |static |constexpr |auto |using |break|continue|delete |if |for |else|case )"
                        r"[\w.:\[\]>*-]+(\(.*\)| (\+|-|\*|\||&|\^)?= .*);$")
# Also where a fault could not be compiled: sums of texts, what static_assert compares.
_SKIP = re.compile(r"to_string\(|offsetof\(|^\s*(#|static_assert|CROFTON_ASSERT|template|using|namespace|HWY_EXPORT|friend|\[\[nodiscard\]\] friend)|operator|Prefetch|reserve\(")


def _without_comments(text):
    """The text with comments, strings and characters blanked, every other character in its place."""
    token = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", re.S)
    return token.sub(lambda m: re.sub(r"[^\n]", "~", m.group()), text)


def _candidates(text):
    """(rule, begin, end, replacement) of every place that a rule speaks of."""
    plain = _without_comments(text)
    at, before = 0, ";"
    for line in plain.splitlines(keepends=True):
        body = line.rstrip("\n")
        if body.startswith(" ") and not _SKIP.search(body):
            for rule, pattern, other in _OPERATORS:
                for match in re.finditer(pattern, body):
                    yield rule, at + match.start(1), at + match.end(1), other[match.group(1)]
            for match in _BOUND.finditer(body):
                group = 1 if match.group(1) else 2
                yield "bound", at + match.start(group), at + match.end(group), f"({match.group(group)} / 16)"
            for match in _OFF_BY_ONE.finditer(body):
                group = 1 if match.group(1) else 2
                yield "one off", at + match.start(group), at + match.end(group), {"1": "2", "0": "1"}[match.group(group)]
            if before[-1] in ";{}" and _STATEMENT.match(body):
                start = len(body) - len(body.lstrip())
                yield "dropped", at + start, at + len(body), ";"
        if body.strip():
            before = body.rstrip()
        at += len(line)


def by_rule(root, module, count, seed, tests):
    """`count` places of a module's sources, as many of each rule. The places are drawn by a hash of their own text, so
    that a change elsewhere moves few draws."""
    drawn = {}
    for path in sorted((root / "engine" / module / "src").rglob("*.cpp")):
        file = str(path.relative_to(root))
        text = path.read_text()
        seen = {}
        for rule, begin, end, replacement in _candidates(text):
            line_begin = text.rfind("\n", 0, begin) + 1
            line = text[line_begin:text.find("\n", end)].strip()
            key = f"{rule}|{file}|{line}|{begin - line_begin}"
            seen[key] = seen.get(key, 0) + 1
            digest = hashlib.sha256(f"{seed}|{key}|{seen[key]}".encode()).hexdigest()
            name = f"{module}-{rule.replace(' ', '-')}-{digest[:8]}"
            what = f"{rule}: {text[begin:end]!r} becomes {replacement!r} in: {line}"
            mutant = Mutant(name, file, text[begin:end], replacement, what, tests, at=begin)
            drawn.setdefault(rule, []).append((digest, mutant))
    ranked = [(place, rule, mutant) for rule, list_ in sorted(drawn.items())
              for place, (_, mutant) in enumerate(sorted(list_, key=lambda pair: pair[0]))]
    ranked.sort(key=lambda entry: entry[:2])
    return [mutant for _, _, mutant in ranked[:count]]
