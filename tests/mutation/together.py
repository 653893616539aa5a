# SPDX-License-Identifier: MIT
"""Many mutants in one build: each is switched on by the environment, so that a module is compiled once for all of them.

Those that cannot be written so (in kernels, headers of the API, declarations, places that must be constant) are left to
run.py one by one.
"""
import os
import re
import subprocess
import time

_NAMES = {"<": "Less", "<=": "LessEqual", ">": "Greater", ">=": "GreaterEqual", "==": "Equal", "!=": "NotEqual",
          "+": "Plus", "-": "Minus"}
_DECLARATION = re.compile(r"\s*((static |constexpr |const )*(auto|bool|int|double|float|unsigned|[\w:]+(<[^;=]*>)?)[&*]? \w+ = )(.*);$", re.S)
# Such as a lock: in a block of its own it would end there.
_OBJECT = re.compile(r"\s*((static |constexpr |const )*(?!return\b|delete\b|throw\b|else\b)[\w:]+(<[^;=]*>)?[&*]? \w+\s*[({].*);", re.S)
_KERNEL = re.compile(r"foreach_target|-inl\.hpp|\bhn::|constexpr [^=;]*\(")


def _closing(text, begin):
    depth = 0
    for at in range(begin, len(text)):
        depth += (text[at] == "(") - (text[at] == ")")
        if depth == 0:
            return at
    return -1


def switched(mutant, number):
    """What stands in the place of mutant.find, or None."""
    find, replace, on = mutant.find, mutant.replace, f"crofton::mutation::kOn == {number}"
    if mutant.at >= 0:
        if find in _NAMES:
            return f"{find} crofton::mutation::{_NAMES[find]}<{number}>() {find}"
        if replace == ";":
            return f"if (!({on})) {{ {find} }}"
        if re.fullmatch(r"[\w.+-]+", find) and find not in ("&&", "||", "+=", "-="):
            return f"({on} ? {replace} : {find})"
        return None
    old, new = _DECLARATION.fullmatch(find), _DECLARATION.fullmatch(replace)
    if old and new and old.group(1) == new.group(1) and "{" not in find:
        return f"{old.group(1)}{on} ? ({new.group(5)}) : ({old.group(5)});"
    if find.startswith("if (") and replace.startswith("if ("):
        a, b = _closing(find, 3), _closing(replace, 3)
        if a > 0 and b > 0 and find[a:] == replace[b:]:
            return f"if ({on} ? bool({replace[4:b]}) : bool({find[4:a]}){find[a:]}"
    whole = find.rstrip().endswith(";") and find.count("{") == find.count("}") and find.count("(") == find.count(")")
    if whole and not old and not _OBJECT.match(find) and (replace.rstrip().endswith(";") or not replace.strip()):
        return f"if ({on}) {{ {replace} }} else {{ {find} }}"
    return None


class Together:
    """Several mutants of one scratch tree at once."""

    def __init__(self, scratch, mutants):
        self.scratch = scratch
        self.numbers = {}
        self.originals = {}
        self.by_file = {}
        for number, mutant in enumerate(mutants, 1):
            text = (scratch.tree / mutant.file).read_text()
            if "/include/" in mutant.file or _KERNEL.search(text) or switched(mutant, number) is None:
                continue
            at = mutant.at if mutant.at >= 0 else text.index(mutant.find)
            taken = self.by_file.setdefault(mutant.file, [])
            if all(at + len(mutant.find) <= b or at >= e for b, e, _, _ in taken):
                taken.append((at, at + len(mutant.find), number, mutant))

    def mutants(self):
        return [(number, mutant) for list_ in self.by_file.values() for _, _, number, mutant in list_]

    def _write(self, file):
        path = self.scratch.tree / file
        text = self.originals.setdefault(file, path.read_text())
        for begin, end, number, mutant in sorted(self.by_file[file], key=lambda entry: -entry[0]):
            piece = switched(mutant, number).replace("\n", " ")  # lines stay where they are
            text = text[:begin] + piece + "\n" * mutant.find.count("\n") + text[end:]
        header = self.scratch.tree / "tests" / "mutation" / "switch.hpp"
        path.write_text(f'#include "{header}"\n#line 1\n{text}')

    def restore(self):
        for file, text in self.originals.items():
            (self.scratch.tree / file).write_text(text)

    def build(self, tests):
        """Compiles; a mutant on a line with an error is left to be tried alone."""
        for file in list(self.by_file):
            self._write(file)
        for _ in range(6):
            done = self.scratch.compile(tests, keep_going=True)
            if done.returncode == 0:
                return True
            wrong = set(re.findall(r"^(?:\.\./)*([\w./-]+?):(\d+):(?:\d+:)? +(?:error|fatal|  required)", done.stdout, re.M))
            wrong |= set(re.findall(r"^(?:\.\./)*([\w./-]+?):(\d+):\d+: +required from", done.stdout, re.M))
            dropped = 0
            for name, line in wrong:
                for file, list_ in self.by_file.items():
                    if not name.endswith(file.split("/", 1)[1]):
                        continue
                    text = self.originals[file]
                    kept = [e for e in list_ if not text.count("\n", 0, e[0]) + 1 <= int(line) <= text.count("\n", 0, e[1]) + 1]
                    dropped += len(list_) - len(kept)
                    self.by_file[file] = kept
            if not dropped:
                print(done.stdout[-3000:])
                return False
            for file in list(self.by_file):
                self._write(file)
        return False

    def run(self, number, mutant, limits):
        os.environ["CROFTON_MUTANT"] = str(number)
        try:
            for test in mutant.tests:
                failed = self.scratch.run(test, limits[test])
                if failed:
                    return "caught", failed
            return "survived", ""
        finally:
            del os.environ["CROFTON_MUTANT"]


def try_together(scratch, mutants, known, minutes):
    """Judges as many of the mutants as can be put into one build. The tests are built once more when it is over."""
    started = time.monotonic()
    batch = Together(scratch, mutants)
    chosen = batch.mutants()
    tests = sorted({test for _, mutant in chosen for test in mutant.tests})
    print(f"{len(chosen)} of {len(mutants)} mutants in one build of {', '.join(tests)}", flush=True)
    try:
        if not chosen or not batch.build(tests):
            return
        limits = {}
        for test in tests:
            if failed := scratch.run(test, 1200):
                print(f"the tests fail without a fault: {failed}")
                return
            limits[test] = 30 + 10 * scratch.times[test]
        chosen = batch.mutants()
        print(f"{len(chosen)} built after {time.monotonic() - started:.0f} s", flush=True)
        for number, mutant in chosen:
            if time.monotonic() - started > 60 * minutes:
                break
            begun = time.monotonic()
            status, by = batch.run(number, mutant, limits)
            known.put(mutant, status, by, time.monotonic() - begun)
            print(f"{status}: {mutant.name} {by} ({time.monotonic() - begun:.0f} s)", flush=True)
    finally:
        batch.restore()
