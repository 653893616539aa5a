#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the fuzzers one after another, keeps what they have learnt, and counts their executions.

tests/fuzz/run.py [NAME …] [--build FOLDER] [--seconds S] [--rounds R] [--jobs J] [--record]
tests/fuzz/run.py --report     the table of executions so far, nothing run
tests/fuzz/run.py --minimise   keeps of each corpus what reaches something of its own, nothing else run;
                               --record writes what is left into tests/fuzz/corpora

A fuzzer begins with the seeds of fuzz_seeds, with tests/fuzz/corpora/NAME.txt, and with FOLDER/corpus/NAME, to which it
adds. What it finds is left in FOLDER/found, and the exit status is 1. Executions are added up in FOLDER/executions.json;
--record also adds them to tests/fuzz/executions.csv, from which docs/testing.md has its figure. Both are written after
each fuzzer, and when the run is interrupted or terminated. A line of a corpus in tests/fuzz/corpora is an input in
base64; the readers of files have none, as theirs are long. Python 3.11, nothing else.
"""
import argparse
import base64
import csv
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
RECORD = ROOT / "tests" / "fuzz" / "executions.csv"
CORPORA = ROOT / "tests" / "fuzz" / "corpora"
GOAL = 10**9
# The longest input, in bytes: what a target can read of one small scene.
LONGEST = {"boxes": 96, "triangles": 96, "classify": 128, "convex": 160, "fit": 96, "triangulate": 96, "casts": 160, "mesh": 192,
           "scene_graph": 256, "broadphase": 256, "occlusion": 192, "moving": 256, "tree_life": 384, "world": 256,
           "capi_world": 256, "bake_round_trip": 256}
running, stopping, bookkeeping = set(), threading.Event(), threading.Lock()


def fuzzers(build):
    return sorted(p.name[5:] for p in (build / "bin").glob("fuzz_*") if p.name != "fuzz_seeds" and os.access(p, os.X_OK))


def read_record():
    """Executions by (fuzzer, sanitized)."""
    if not RECORD.exists():
        return {}
    with RECORD.open() as file:
        return {(row["fuzzer"], row["sanitized"]): int(row["executions"]) for row in csv.DictReader(file)}


def write_record(counts):
    with RECORD.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["fuzzer", "sanitized", "executions"])
        for (name, sanitized), count in sorted(counts.items()):
            writer.writerow([name, sanitized, count])


def report():
    counts = read_record()
    print("| fuzzer | under the sanitizers | without |\n|---|---|---|")
    for name in sorted({name for name, _ in counts}):
        print(f"| `fuzz_{name}` | {counts.get((name, 'yes'), 0):,} | {counts.get((name, 'no'), 0):,} |")
    total = sum(counts.values())
    print(f"| all | {sum(c for (_, s), c in counts.items() if s == 'yes'):,} | {sum(c for (_, s), c in counts.items() if s == 'no'):,} |")
    print(f"{total:,} executions of {GOAL:,}: {100 * total / GOAL:.2f} %")


def is_sanitized(build):
    cache = (build / "CMakeCache.txt").read_text()
    return "yes" if re.search(r"^CROFTON_SANITIZE:\w+=.+", cache, re.M) else "no"


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
    keep_count(build, name, count, options.record)
    return count, good


def keep_count(build, name, count, record):
    ledger, sanitized = build / "executions.json", is_sanitized(build)
    with bookkeeping, (build / "executions.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        counts = json.loads(ledger.read_text()) if ledger.exists() else {}
        counts[name] = counts.get(name, 0) + count
        ledger.write_text(json.dumps(counts, indent=1))
        if record:
            known = read_record()
            known[name, sanitized] = known.get((name, sanitized), 0) + count
            write_record(known)


def unpack(name, folder):
    """Writes the inputs of tests/fuzz/corpora into a folder, a file each."""
    packed = CORPORA / f"{name}.txt"
    if not packed.exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    for number, line in enumerate(packed.read_text().split()):
        (folder / f"kept_{number}").write_bytes(base64.b64decode(line))


def pack(name, folder):
    CORPORA.mkdir(exist_ok=True)
    inputs = sorted((path.read_bytes() for path in folder.iterdir()), key=lambda bytes_: (len(bytes_), bytes_))
    (CORPORA / f"{name}.txt").write_text("".join(base64.b64encode(bytes_).decode() + "\n" for bytes_ in inputs if bytes_))


def minimise(build, name, record):
    corpus = build / "corpus" / name
    unpack(name, corpus)  # a new build has none of them in its own corpus
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
    if record and name in LONGEST:
        pack(name, corpus)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="fuzzers, without fuzz_; all without one")
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "fuzz", help="folder of the preset fuzz or fuzz_fast")
    parser.add_argument("--seconds", type=int, default=120, help="how long each one runs")
    parser.add_argument("--rounds", type=int, default=1, help="how often all of them run, one after another")
    parser.add_argument("--jobs", type=int, default=1, help="fuzzers at a time")
    parser.add_argument("--record", action="store_true", help="add executions, or minimised corpora, to the repository's")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--minimise", action="store_true")
    options = parser.parse_args()
    if options.report:
        return report()
    build = options.build.resolve()
    names = options.names or fuzzers(build)
    unknown = set(names) - set(fuzzers(build))
    if unknown or not names:
        sys.exit(f"no such fuzzers in {build}/bin: {', '.join(sorted(unknown)) or 'none is built'}")
    if options.minimise:
        return [minimise(build, name, options.record) for name in names] and None
    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)
    with tempfile.TemporaryDirectory() as seeds:
        if (build / "bin" / "fuzz_seeds").exists():
            subprocess.run([build / "bin" / "fuzz_seeds", seeds], check=True)
        for name in names:
            unpack(name, Path(seeds) / name)
        with ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda name: fuzz(build, name, options, Path(seeds)), names * options.rounds))
    counts = json.loads((build / "executions.json").read_text())
    print(f"{sum(c for c, _ in results):,} executions; {sum(counts.values()):,} in {build} so far")
    return 0 if all(good for _, good in results) else 1


if __name__ == "__main__":
    sys.exit(main())
