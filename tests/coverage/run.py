#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts which way the branches of each engine module go while its tests run, and prints the table of docs/testing.md.

tests/coverage/run.py [TEST …] [--list MODULE] [--jobs J]   builds and runs these tests (all in TESTS), then reports
tests/coverage/run.py --report [--list MODULE]              from what earlier runs have counted; nothing built or run

A branch is one outcome, true or false, of one condition in the source as clang's coverage mapping has them: each operand
of && and ||, each case of a switch. It counts as taken if any test, any instance of a template takes it. What has none:
conditions that the compiler knows (`if constexpr`), what the compiler adds (exceptions), and asserts, which builds of
users leave out. Kernels are compiled for AVX2 alone: where Highway includes a kernel's source for a second target, clang
counts it as a system's header and leaves it out. --list prints what no test takes. Exit status 1 below 95 %.
Python 3.11, clang 14 with its llvm-cov and llvm-profdata.
"""
import argparse
import collections
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "coverage"
COUNTS = BUILD / "counts"
MODULES = "core geometry cull boxtree collide mesh occlude bake capi".split()
TESTS = MODULES + "simd convex fit scene world threads memory".split()
WANTED = 95.0


def tool(name):
    found = shutil.which(name) or shutil.which(f"{name}-14")
    return found or sys.exit(f"tests/coverage/run.py: {name} is not installed (third_party/install.sh --checks)")


def run_tests(tests, jobs):
    subprocess.run(["cmake", "--preset", "coverage"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "-j", str(jobs), "--target", *(f"test_{t}" for t in tests)], check=True)
    for test in tests:
        raw = COUNTS / f"{test}.raw"
        shutil.rmtree(raw, ignore_errors=True)
        raw.mkdir(parents=True)
        # One file for each of four processes at a time: tests that start others write to the same ones.
        environment = dict(os.environ, LLVM_PROFILE_FILE=str(raw / "%4m.profraw"))
        code = subprocess.run([BUILD / "bin" / f"test_{test}", "--minimal"], cwd=BUILD, env=environment).returncode
        if code:
            sys.exit(f"tests/coverage/run.py: test_{test} failed")
        subprocess.run([tool("llvm-profdata"), "merge", "-sparse", "--failure-mode=all", "-o", COUNTS / f"{test}.profdata",
                        *raw.glob("*.profraw")], check=True)
        shutil.rmtree(raw)


def exported(test):
    """The functions of a test, with their regions and branches. Each test by itself: programs differ in functions of one
    name, and llvm-cov leaves those out whose counts do not fit."""
    text = subprocess.run([tool("llvm-cov"), "export", "-skip-expansions", "-instr-profile", COUNTS / f"{test}.profdata",
                           BUILD / "bin" / f"test_{test}"], check=True, stdout=subprocess.PIPE).stdout
    return json.loads(text)["data"][0]["functions"]


def folded(branch, regions):
    """Whether the compiler knew the condition: it was reached, and went neither way."""
    begin, end = tuple(branch[0:2]), tuple(branch[2:4])
    around = [r for r in regions if r[5] == branch[6] and r[7] == 0 and tuple(r[0:2]) <= begin and end <= tuple(r[2:4])]
    inner = max(around, key=lambda r: (tuple(r[0:2]), [-r[2], -r[3]]), default=None)
    return branch[4] == 0 and branch[5] == 0 and inner is not None and inner[4] > 0


def asserts_of(path):
    """Lines that asserts stand on."""
    lines = set()
    text = path.read_text()
    for match in re.finditer(r"CROFTON_ASSERT\(", text):
        depth, at = 1, match.end()
        while depth and at < len(text):
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        first = text.count("\n", 0, match.start()) + 1
        lines.update(range(first, first + text.count("\n", match.start(), at) + 1))
    return lines


def branches_of(tests):
    """{file: {place: [times true, times false]}}"""
    found = collections.defaultdict(dict)
    for function in (f for test in tests for f in exported(test)):
        names = [Path(os.path.normpath(BUILD / n)) for n in function["filenames"]]
        for branch in function["branches"]:
            path = names[branch[6]]
            if not path.is_relative_to(ROOT / "engine") or folded(branch, function["regions"]):
                continue
            counts = found[path].setdefault(tuple(branch[:4]), [0, 0])
            counts[0] += branch[4]
            counts[1] += branch[5]
    for path, places in found.items():
        asserts = asserts_of(path)
        found[path] = {place: counts for place, counts in places.items() if place[0] not in asserts}
    return found


def report(found, listed):
    print("| module | branches | taken | share |\n|---|---|---|---|")
    low = False
    for module in MODULES:
        counts = [c for path, places in found.items() if path.is_relative_to(ROOT / "engine" / module) for c in places.values()]
        all_, taken = 2 * len(counts), sum((c[0] > 0) + (c[1] > 0) for c in counts)
        share = 100.0 * taken / max(1, all_)
        low = low or share < WANTED
        print(f"| {module} | {all_:,} | {taken:,} | {share:.1f} % |")
    for module in listed:
        for path in sorted(p for p in found if p.is_relative_to(ROOT / "engine" / module)):
            lines = path.read_text().splitlines()
            for place, counts in sorted(found[path].items()):
                if 0 in counts:
                    never = "never reached" if counts == [0, 0] else "never true" if counts[0] == 0 else "never false"
                    text = lines[place[0] - 1][place[1] - 1:place[3] - 1 if place[2] == place[0] else None]
                    print(f"{path.relative_to(ROOT)}:{place[0]}:{place[1]}: {never}: {text}")
    return low


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tests", nargs="*", default=TESTS)
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--list", action="append", default=[], metavar="MODULE", choices=MODULES)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    if not options.report:
        run_tests(options.tests, options.jobs)
    counted = [t for t in TESTS if (COUNTS / f"{t}.profdata").exists()]
    return report(branches_of(counted), options.list)


if __name__ == "__main__":
    sys.exit(main())
