#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Puts deliberate faults into a copy of the engine, switched on one at a time, and sees whether the tests notice.

tests/mutation/run.py [NAME|MODULE|FILE …]   those that a word selects (all without one); resumes where it was stopped
tests/mutation/run.py --sanitize [WORD …]    the same under the sanitizers, as .ci/run has it: for what writes beyond an array
tests/mutation/run.py --seed 22 [WORD …]     other faults than those of the last draw
tests/mutation/run.py --list                 what there is, nothing run
tests/mutation/run.py --report               the table of what is known, nothing run

Exit status: 0 if every mutant is caught, 1 if one survives (it may be one that no test can tell from the original), 2 if the harness cannot run.
docs/testing.md says how to read it. Python 3.11, nothing else.
"""
import argparse
import hashlib
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

from mutants import by_rule
from together import try_together

ROOT = Path(__file__).resolve().parents[2]
SEED = 21
# By rule: how many of each module, and whose tests must catch them.
RULES = {
    "base/core": (4, ["core"]), "base/geometry": (8, ["geometry"]), "base/sampling": (4, ["sampling"]),
    "bounds/measure": (5, ["measure"]), "bounds/fit": (12, ["fit"]), "bounds/boxtree": (10, ["boxtree", "cull"]),
    "shape/mesh": (10, ["mesh"]), "shape/convex": (10, ["convex"]), "shape/collide": (14, ["collide"]),
    "view/cull": (14, ["cull"]), "view/occlude": (10, ["occlude"]), "view/depth": (20, ["depth"]), "world/scene": (8, ["scene"]), "world/world": (8, ["world"]),
    "c_api": (8, ["capi"]), "bake/triangulate": (12, ["triangulate"]), "bake/lines": (4, ["radiosity"]), "bake/files": (4, ["bake"]),
    "bake/pvs": (10, ["pvs"]), "study/radiosity": (5, ["radiosity"]), "study/study": (6, ["study"]), "render": (5, ["render"]),
}


class Scratch:
    """A copy of the tree with a build of its own."""

    def __init__(self, work, jobs, sanitize):
        self.tree = work / "tree"
        self.sanitize = sanitize
        self.build = self.tree / "build" / ("sanitized" if sanitize else "together")
        self.jobs = jobs
        self.times = {}
        self.processor = {}  # test: seconds
        self.cases = {}  # test: {case: seconds}

    def copy(self):
        """Brings changed files over, and takes away what is no longer there: also what an ended run left mutated."""
        names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, check=True, capture_output=True)
        names = [n for n in names.stdout.decode().split("\0") if n and (ROOT / n).is_file()]
        for name in names:
            source, target = ROOT / name, self.tree / name
            if target.exists() and target.read_bytes() == source.read_bytes():
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, target)
        for folder in ("engine", "tests"):
            for path in (self.tree / folder).rglob("*"):
                if path.is_file() and not (ROOT / path.relative_to(self.tree)).exists():
                    path.unlink()

    def configure(self):
        if (self.build / "build.ninja").exists():
            return
        data = ROOT.parent / "shared" / "data"
        command = ["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                   f"-DCROFTON_SHARED_DATA={data}", "-DCROFTON_DISCOVER_TESTS=OFF", "-DCROFTON_WERROR=ON"]
        if self.sanitize:  # a preset's values give way to those of the command line
            command += ["--preset", "asan", "-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DCROFTON_WERROR=OFF"]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.tree)
        if done.returncode:
            sys.exit(f"cmake cannot configure {self.tree}:\n{done.stdout}{done.stderr}")

    def compile(self, tests, keep_going=False):
        command = ["ninja", "-C", str(self.build), "-j", str(self.jobs)] + ["-k0"] * keep_going
        return subprocess.run(command + [f"test_{t}" for t in tests], capture_output=True, text=True)

    def run(self, test, limit, environment=None, cases=(), without=()):
        """None if the tests pass (those of some names, or all but some), or how they fail. Without an environment it
        also notes how long each case takes."""
        command = [str(self.build / "bin" / f"test_{test}"), "--abort-after=1", "--no-intro=1"]
        for option, names in (("test-case", cases), ("test-case-exclude", without)):
            if names:
                command.append(f"--{option}=" + ",".join(re.sub(r"[,*\\]", "?", name) for name in names))
        if environment is None:
            command.append("--duration=1")
        started, used = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        # The processor's time is a limit that does not depend on what else the machine does; what sleeps meets the other.
        most = 20 + 6 * int(self.processor[test]) if test in self.processor else resource.RLIM_INFINITY
        process = subprocess.Popen(command, cwd=self.build, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, errors="replace", start_new_session=True,
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most)))
        try:
            output, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.communicate()
            return f"{test}: longer than {limit:.0f} s"
        if environment is None:
            self.times[test] = time.monotonic() - started
            self.processor[test] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - used
            seconds = re.findall(r"^([\d.]+) s: (.*)$", output, re.M)
            self.cases[test] = {name.strip(): float(length) for length, name in seconds}
        if process.returncode == 0:
            return None
        return f"{test}: {self.reason(output) or f'ended with {process.returncode}'}"

    @staticmethod
    def reason(output):
        """The case that failed, which is not the first named where others say something, or a sanitizer's words."""
        case = ""
        for line in output.splitlines():
            if line.startswith("TEST CASE:"):
                case = line[10:].strip()
            elif re.search(r": (FATAL )?ERROR: ", line) and case:
                return case
            elif "runtime error:" in line or "ERROR: AddressSanitizer" in line:
                return f"a sanitizer: {line.rpartition('rror: ')[2]}"
        return case


def all_mutants(seed=SEED):
    return [mutant for folder, (count, tests) in RULES.items() for mutant in by_rule(ROOT, folder, count, seed, tests)]


def digest(paths):
    total = hashlib.sha256()
    for path in paths:
        total.update(path.read_bytes())
    return total.hexdigest()[:16]


def short(text):
    return hashlib.sha256(text.encode()).hexdigest()[:8]


class Known:
    """Results of earlier runs. A caught mutant stays caught while its file is the same; a survivor is tried again when
    the tests that should catch it have changed."""

    def __init__(self, work):
        self.path = work / "results.json"
        self.lock = threading.Lock()
        self.all = json.loads(self.path.read_text()) if self.path.exists() else {}
        self.digests = {}  # as of the start: files may be edited while mutants are tried in the copy

    def last(self, mutant):
        """What caught it last time."""
        return self.all.get(mutant.name, {}).get("by", "")

    def file_digest(self, file):
        if file not in self.digests:
            self.digests[file] = digest([ROOT / file])
        return self.digests[file]

    def tests_digest(self, tests):
        key = tuple(tests)
        if key not in self.digests:
            files = [p for p in (ROOT / "tests").rglob("*") if p.is_file() and {*tests, "oracle"} & {q.name for q in p.parents}]
            self.digests[key] = digest(sorted(files))
        return self.digests[key]

    def get(self, mutant):
        result = self.all.get(mutant.name)
        if not result or result["file"] != self.file_digest(mutant.file) or result["replace"] != short(mutant.replace):
            return None
        if result["status"] != "caught" and result["tests"] != self.tests_digest(mutant.tests):
            return None
        return result

    def put(self, mutant, status, by, seconds):
        self.all[mutant.name] = {"status": status, "by": by, "seconds": round(seconds, 1), "replace": short(mutant.replace),
                                 "file": self.file_digest(mutant.file), "tests": self.tests_digest(mutant.tests)}
        with self.lock:
            partial = self.path.with_suffix(".partial")
            partial.write_text(json.dumps(self.all, indent=1))
            partial.replace(self.path)


def report(mutants, known):
    """The table, and whether nothing survives."""
    columns = ("caught", "survived", "untried")
    rows, survivors, stale = {}, [], []
    for mutant in mutants:
        row = rows.setdefault(mutant.module, dict.fromkeys(columns, 0))
        result = known.get(mutant)
        status = result["status"] if result else "untried"
        if status == "survived":
            survivors.append(mutant)
        if status == "untried" and mutant.name in known.all:
            stale.append(mutant.name)
        row[status] += 1
    rows["all"] = {c: sum(r[c] for r in rows.values()) for c in columns}
    print("| module | mutants | caught | survived | score |\n|---|---|---|---|---|")
    for name, row in sorted(rows.items(), key=lambda item: (item[0] == "all", item[0])):
        judged = row["caught"] + row["survived"]
        score = f"{100 * row['caught'] / judged:.1f} %" if judged else "–"
        print(f"| {name} | {judged} | {row['caught']} | {row['survived']} | {score} |")
    total = rows["all"]
    print(f"Not judged: {total['untried']} are not tried yet, or do not compile in the common build.")
    if stale:
        print(f"Of these were judged before their tests or files changed: {', '.join(stale)}")
    for mutant in survivors:
        print(f"survived: {mutant.name} ({mutant.file}): {mutant.why}")
    return not survivors and not stale


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("select", nargs="*", help="modules, files or beginnings of names")
    parser.add_argument("--list", action="store_true", help="print the mutants and end")
    parser.add_argument("--report", action="store_true", help="print what is known and end")
    parser.add_argument("--fresh", action="store_true", help="forget earlier results of those selected")
    parser.add_argument("--sanitize", action="store_true", help="under the sanitizers")
    parser.add_argument("--seed", type=int, default=SEED, help=f"draw others than those of seed {SEED}")
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no mutant after so long")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "mutation", help="folder of the copy and the results")
    parser.add_argument("-j", "--jobs", type=int, default=2, help="compilations, or mutants, at a time")
    options = parser.parse_args()
    mutants = every = all_mutants(options.seed)
    if options.select:
        chosen = lambda m: any(w in (m.module, m.file) or m.name.startswith(w) for w in options.select)
        mutants = [m for m in mutants if chosen(m)]
    for mutant in mutants:
        mutant.apply((ROOT / mutant.file).read_text())  # a place that is gone is an error, not a survivor
    if options.list:
        for mutant in mutants:
            print(f"{mutant.name}: {mutant.file}: {mutant.why}")
        print(f"{len(mutants)} mutants")
        return 0
    options.work.mkdir(parents=True, exist_ok=True)
    known = Known(options.work)
    if options.fresh:
        for mutant in mutants:
            known.all.pop(mutant.name, None)
    if not options.report:
        scratch = Scratch(options.work.resolve(), options.jobs, options.sanitize)
        scratch.copy()
        scratch.configure()
        try_together(scratch, every, [m for m in mutants if known.get(m) is None], known, options.minutes, options.jobs)
    return 0 if report(mutants, known) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (ValueError, OSError) as error:
        print(f"tests/mutation/run.py: {error}", file=sys.stderr)
        sys.exit(2)
