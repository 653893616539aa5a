# SPDX-License-Identifier: MIT
"""Many mutants in one build: each is switched on by the environment, so that a module is compiled once for all of them.

Kernels and headers too. The build is that of users: tests and untouched sources come from a compiler cache, if there is
one. What does not compile so (a place that must be constant) is not judged.
"""
import os
import re
import time
from concurrent.futures import ThreadPoolExecutor

import switches

_ERROR = re.compile(r"^(?:\.\./)*([\w./-]+?):(\d+):\d+: +(?:error|fatal|  required|required from)", re.M)


_INCLUDE = re.compile(r'^#include ["<]([^">]+)[">]', re.M)
# A kernel is compiled for what most machines have and for the baseline: half the time.
_TARGETS = "#undef HWY_DISABLED_TARGETS\n#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)\n#line 1\n"


class Together:
    """Several mutants of one scratch tree at once."""

    def __init__(self, scratch, numbered):
        self.scratch = scratch
        self.originals = {}
        self.by_file = {}  # file: [(edit, mutant)]
        self.relaxed = {}  # file: lines whose constants must not be constexpr
        for number, mutant in numbered:
            text = self.originals.setdefault(mutant.file, (scratch.tree / mutant.file).read_text())
            if edit := switches.edit(text, number, mutant):
                self.by_file.setdefault(mutant.file, []).append((edit, mutant))
        self.kernels = self._find_kernels()

    def _find_kernels(self):
        """Sources with kernels that have mutants, or include headers that do."""
        names = {}
        for path in (self.scratch.tree / "engine").rglob("*.[ch]pp"):
            names[str(path.relative_to(self.scratch.tree))] = path.read_text()
        changed, before = set(self.by_file), 0
        while len(changed) > before:
            before = len(changed)
            ends = {file.split("/src/")[-1].split("/internal/")[-1].split("/include/")[-1] for file in changed}
            ends |= {end.split("/")[-1] for end in ends}
            changed |= {file for file, text in names.items() if ends.intersection(_INCLUDE.findall(text))}
        kernels = [file for file in changed if file.endswith(".cpp") and "hwy/foreach_target.h" in names[file]]
        self.originals |= {file: names[file] for file in kernels}
        return kernels

    def mutants(self):
        return [(edit.number, mutant) for list_ in self.by_file.values() for edit, mutant in list_]

    def _write(self, file):
        text = switches.write(self.originals[file], [edit for edit, _ in self.by_file.get(file, [])])
        lines = text.split("\n")
        here = {n for n, line in enumerate(lines, 1) if re.search(r"\bconstexpr [^;]*::crofton::mutation::kOn", line)}
        for line in here | self.relaxed.get(file, set()):
            lines[line - 1] = lines[line - 1].replace("static constexpr ", "static inline const ").replace("constexpr ", "const ")
        header = self.scratch.tree / "tests" / "mutation" / "switch.hpp"
        text = _TARGETS * (file in self.kernels) + f'#include "{header}"\n#line 1\n' + "\n".join(lines)
        path = self.scratch.tree / file
        if path.read_text() != text:
            path.write_text(text)

    def restore(self):
        for file, text in self.originals.items():
            (self.scratch.tree / file).write_text(text)

    def build(self, tests):
        """Compiles; a mutant on a line with an error is left out."""
        for file in {*self.by_file, *self.kernels}:
            self._write(file)
        for _ in range(8):
            done = self.scratch.compile(tests, keep_going=True)
            if done.returncode == 0:
                return True
            changed = False
            for name, line in set(_ERROR.findall(done.stdout)):
                self._take_constant(name, int(line))
                for file in self.by_file:
                    if name.endswith(file.split("/", 1)[1]):
                        changed |= self._mend(file, int(line))
            if not changed:
                print(done.stdout[-6000:])
                return False
            for file in {*self.by_file, *self.kernels}:
                self._write(file)
        return False

    def _take_constant(self, name, line):
        """A constant of a file without mutants that is computed from one with them must not be constexpr either."""
        file = name[name.rfind("engine/"):] if "engine/" in name else ""
        path = self.scratch.tree / file
        if not file or file in self.by_file or not path.is_file():
            return
        text = path.read_text()
        if "constexpr " in text.split("\n")[line - 1]:
            self.originals.setdefault(file, text)
            self.by_file[file] = []

    def _mend(self, file, line):
        """Makes a constant on a line that does not compile one that is set at the start, or drops the line's mutants.

        Those of the line before, where it has none: a function that must not return and does is an error at its end.
        """
        text = self.originals[file]
        if "constexpr " in text.split("\n")[line - 1] and line not in self.relaxed.setdefault(file, set()):
            self.relaxed[file].add(line)
            return True
        for at in (line, line - 1):
            there = lambda e: text.count("\n", 0, e.begin) + 1 <= at <= text.count("\n", 0, e.end) + 1
            dropped = [mutant for edit, mutant in self.by_file[file] if there(edit)]
            for mutant in dropped:
                print(f"does not compile so: {mutant.name}", flush=True)
            self.by_file[file] = [(edit, mutant) for edit, mutant in self.by_file[file] if not there(edit)]
            if dropped:
                return True
        return False

    def judge(self, number, mutant, limits, known):
        """(status, by what) of one: first the case that caught it last time, then all quick ones, then the slow."""
        environment = dict(os.environ, CROFTON_MUTANT=str(number))
        last, _, case = known.last(mutant).partition(": ")
        rounds = [(last, {"cases": [case]})] if case and last in mutant.tests else []
        slow = {}
        for test in mutant.tests:
            cases = self.scratch.cases[test]
            slow[test] = [name for name in sorted(cases, key=cases.get) if cases[name] > 0.05 * sum(cases.values())]
            rounds.append((test, {"without": slow[test]}))
        rounds += [(test, {"cases": [name]}) for test in mutant.tests for name in slow[test]]
        for test, which in rounds:
            if failed := self.scratch.run(test, limits[test], environment, **which):
                return "caught", failed
        return "survived", ""


def try_together(scratch, mutants, todo, known, minutes, jobs):
    """Judges those that are left to do of as many mutants as can be put into one build, `jobs` at a time.

    The others are built too: so what is compiled stays the same from run to run.
    """
    started = time.monotonic()
    files = {mutant.file for mutant in todo}
    batch = Together(scratch, [entry for entry in enumerate(mutants, 1) if entry[1].file in files])
    names = {mutant.name for mutant in todo}
    tests = sorted({test for mutant in todo for test in mutant.tests})
    print(f"{len(batch.mutants())} mutants in one build of {', '.join(tests)}; {len(todo)} are to be judged", flush=True)
    try:
        if not tests or not batch.build(tests):
            return
    finally:
        batch.restore()
    print(f"{len(batch.mutants())} built after {time.monotonic() - started:.0f} s", flush=True)
    limits = {}
    for test in tests:
        if failed := scratch.run(test, 1200):
            print(f"the tests fail without a fault: {failed}")
            return
        limits[test] = 30 + 4 * scratch.times[test]
        print(f"test_{test} passes without a fault: {scratch.times[test]:.0f} s", flush=True)

    def one(entry):
        number, mutant = entry
        if time.monotonic() - started > 60 * minutes:
            return
        begun = time.monotonic()
        status, by = batch.judge(number, mutant, limits, known)
        seconds = time.monotonic() - begun
        known.put(mutant, status, by, seconds)
        print(f"{status}: {mutant.name} {by} ({seconds:.0f} s)", flush=True)

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, [entry for entry in sorted(batch.mutants(), key=lambda e: e[0]) if entry[1].name in names]))
