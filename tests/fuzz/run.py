#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the fuzzers one after another, keeps what they have learnt, and counts their executions.

tests/fuzz/run.py [NAME …] [--build FOLDER] [--seconds S] [--rounds R] [--jobs J]
tests/fuzz/run.py --report     executions of this build so far, nothing run
tests/fuzz/run.py --minimise   keeps of each corpus what reaches something of its own, nothing else run

A fuzzer begins with the seeds of fuzz_seeds and with FOLDER/corpus/NAME, to which it adds. What it finds is left in
FOLDER/found, and the exit status is 1: make it a small literal input in the module's own tests. Executions are added up
in FOLDER/executions.json, after each fuzzer and when the run is interrupted or terminated. Python 3.11, nothing else.
"""
import argparse
import fcntl
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# The longest input, in bytes: what a target can read of one small scene.
LONGEST = {"boxes": 96, "triangles": 96, "classify": 128, "convex": 160, "fit": 96, "triangulate": 96, "casts": 160, "mesh": 192,
           "scene_graph": 256, "broadphase": 256, "occlusion": 192, "moving": 256, "tree_life": 384, "world": 256,
           "capi_world": 256, "bake_round_trip": 256}
running, stopping, bookkeeping = set(), threading.Event(), threading.Lock()


def fuzzers(build):
    return sorted(p.name[5:] for p in (build / "bin").glob("fuzz_*") if p.name != "fuzz_seeds" and os.access(p, os.X_OK))


def report(build):
    ledger = build / "executions.json"
    counts = json.loads(ledger.read_text()) if ledger.exists() else {}
    print("| fuzzer | executions |\n|---|---|")
    for name, count in sorted(counts.items()):
        print(f"| `fuzz_{name}` | {count:,} |")
    print(f"| all | {sum(counts.values()):,} |")


def stop(*_):
    """libFuzzer prints its statistics and ends."""
    stopping.set()
    for process in list(running):
        process.send_signal(signal.SIGUSR1)


def fuzz(build, name, options, seeds):
    """(executions, whether nothing was found) of one fuzzer."""
    if stopping.is_set():
        return 0, True
    corpus, found = build / "corpus" / name, build / "found"
    corpus.mkdir(parents=True, exist_ok=True)
    found.mkdir(exist_ok=True)
    command = ["nice", "-n", "19", build / "bin" / f"fuzz_{name}", f"-max_total_time={options.seconds}", "-timeout=10", "-reload=0",
               # What libFuzzer itself costs beside a short execution: half of it without these.
               "-entropic=0", "-use_counters=0", "-reduce_inputs=0",
               "-rss_limit_mb=4096", f"-max_len={LONGEST.get(name, 4096)}", "-print_final_stats=1",
               f"-artifact_prefix={found}/{name}-", corpus]
    if (seeds / name).is_dir():
        command.append(seeds / name)
    count, told, last = 0, "", []
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    running.add(process)
    for line in process.stderr:
        last = last[-59:] + [line.rstrip()]
        # Each new input's line has the count so far, which is what is left where the fuzzer itself is killed.
        if number := re.match(r"(?:#|stat::number_of_executed_units:\s*)(\d+)", line):
            count = max(count, int(number.group(1)))
        if tally := re.match(r"fuzz: \d+ executions, (.*)", line):
            told = f", {tally.group(1)}"
    good = process.wait() == 0 or stopping.is_set()
    running.discard(process)
    print(f"fuzz_{name}: {count:,} executions{told}, {'nothing found' if good else 'FAILED'}", flush=True)
    if not good:
        print("\n".join(line for line in last if re.search(r"fuzz:|ERROR|SUMMARY|Test unit|#\d|error", line)))
    keep_count(build, name, count)
    return count, good


def keep_count(build, name, count):
    ledger = build / "executions.json"
    with bookkeeping, (build / "executions.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        counts = json.loads(ledger.read_text()) if ledger.exists() else {}
        counts[name] = counts.get(name, 0) + count
        ledger.write_text(json.dumps(counts, indent=1))


def minimise(build, name):
    corpus = build / "corpus" / name
    if not corpus.is_dir():
        return
    small = corpus.with_suffix(".small")
    shutil.rmtree(small, ignore_errors=True)
    small.mkdir()
    before = len(list(corpus.iterdir()))
    subprocess.run([build / "bin" / f"fuzz_{name}", "-merge=1", "-use_counters=0", small, corpus], capture_output=True, check=True)
    shutil.rmtree(corpus)
    small.rename(corpus)
    print(f"fuzz_{name}: {before} inputs become {len(list(corpus.iterdir()))}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="fuzzers, without fuzz_; all without one")
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "fuzz", help="folder of the preset fuzz or fuzz_fast")
    parser.add_argument("--seconds", type=int, default=120, help="how long each one runs")
    parser.add_argument("--rounds", type=int, default=1, help="how often all of them run, one after another")
    parser.add_argument("--jobs", type=int, default=1, help="fuzzers at a time")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--minimise", action="store_true")
    options = parser.parse_args()
    if options.report:
        return report(options.build.resolve())
    build = options.build.resolve()
    names = options.names or fuzzers(build)
    unknown = set(names) - set(fuzzers(build))
    if unknown or not names:
        sys.exit(f"no such fuzzers in {build}/bin: {', '.join(sorted(unknown)) or 'none is built'}")
    if options.minimise:
        return [minimise(build, name) for name in names] and None
    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)
    with tempfile.TemporaryDirectory() as seeds:
        if (build / "bin" / "fuzz_seeds").exists():
            subprocess.run([build / "bin" / "fuzz_seeds", seeds], check=True)
        with ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda name: fuzz(build, name, options, Path(seeds)), names * options.rounds))
    counts = json.loads((build / "executions.json").read_text())
    print(f"{sum(c for c, _ in results):,} executions; {sum(counts.values()):,} in {build} so far")
    return 0 if all(good for _, good in results) else 1


if __name__ == "__main__":
    sys.exit(main())
