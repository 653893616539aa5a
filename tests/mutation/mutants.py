# SPDX-License-Identifier: MIT
"""Mutants: deliberate faults of the engine's sources, made by rule."""
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
    module: str = ""
    at: int = 0  # where the text begins

    def apply(self, text):
        """The text of the file with the fault in it. ValueError if the place is not there."""
        if text[self.at:self.at + len(self.find)] != self.find:
            raise ValueError(f"{self.name}: {self.file} has changed")
        return text[:self.at] + self.replace + text[self.at + len(self.find):]


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


def by_rule(root, folder, count, seed, tests):
    """`count` places of a module's sources, as many of each rule. The places are drawn by a hash of their own text, so
    that a change elsewhere moves few draws."""
    module, drawn = folder.split("/")[-1], {}
    for path in sorted((root / "engine" / folder / "src").rglob("*.[ch]pp")):
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
            mutant = Mutant(name, file, text[begin:end], replacement, what, tests, module, begin)
            drawn.setdefault(rule, []).append((digest, mutant))
    ranked = [(place, rule, mutant) for rule, list_ in sorted(drawn.items())
              for place, (_, mutant) in enumerate(sorted(list_, key=lambda pair: pair[0]))]
    ranked.sort(key=lambda entry: entry[:2])
    return [mutant for _, _, mutant in ranked[:count]]
