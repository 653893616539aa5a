#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the fuzzers one after another, keeps what they have learnt, and counts their executions.

tests/fuzz/run.py [NAME …] [--build FOLDER] [--seconds S] [--jobs J] [--record]
tests/fuzz/run.py --report     the table of executions so far, nothing run
tests/fuzz/run.py --minimise   keeps of each corpus what reaches something of its own, nothing else run

A fuzzer begins with the seeds of fuzz_seeds and with FOLDER/corpus/NAME, to which it adds. What it finds is left in
FOLDER/found, and the exit status is 1. Executions are added up in FOLDER/executions.json; --record also adds them to
tests/fuzz/executions.csv, from which docs/testing.md has its figure. Python 3.11, nothing else.
"""
import argparse
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "tests" / "fuzz" / "executions.csv"
GOAL = 10**9


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


def fuzz(build, name, options, seeds):
    """(executions, whether nothing was found) of one fuzzer."""
    corpus, found = build / "corpus" / name, build / "found"
    corpus.mkdir(parents=True, exist_ok=True)
    found.mkdir(exist_ok=True)
    command = [build / "bin" / f"fuzz_{name}", f"-max_total_time={options.seconds}", "-timeout=10", "-rss_limit_mb=4096",
               "-max_len=4096", "-print_final_stats=1", f"-artifact_prefix={found}/{name}-", corpus]
    if (seeds / name).is_dir():
        command.append(seeds / name)
    done = subprocess.run(["nice", "-n", "15"] + [str(c) for c in command], capture_output=True, text=True, errors="replace")
    executions = re.search(r"stat::number_of_executed_units:\s*(\d+)", done.stderr)
    count = int(executions.group(1)) if executions else 0
    print(f"fuzz_{name}: {count:,} executions, {'nothing found' if done.returncode == 0 else 'FAILED'}", flush=True)
    if done.returncode:
        print("\n".join(line for line in done.stderr.splitlines()[-60:] if re.search(r"fuzz:|ERROR|SUMMARY|Test unit|#\d|error", line)))
    return count, done.returncode == 0


def minimise(build, name):
    corpus = build / "corpus" / name
    if not corpus.is_dir():
        return
    small = corpus.with_suffix(".small")
    shutil.rmtree(small, ignore_errors=True)
    small.mkdir()
    before = len(list(corpus.iterdir()))
    subprocess.run([build / "bin" / f"fuzz_{name}", "-merge=1", small, corpus], capture_output=True, check=True)
    shutil.rmtree(corpus)
    small.rename(corpus)
    print(f"fuzz_{name}: {before} inputs become {len(list(corpus.iterdir()))}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="fuzzers, without fuzz_; all without one")
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "fuzz", help="folder of the preset fuzz or fuzz_fast")
    parser.add_argument("--seconds", type=int, default=120, help="how long each one runs")
    parser.add_argument("--jobs", type=int, default=1, help="fuzzers at a time")
    parser.add_argument("--record", action="store_true", help="add the executions to tests/fuzz/executions.csv")
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
        return [minimise(build, name) for name in names] and None
    with tempfile.TemporaryDirectory() as seeds:
        if (build / "bin" / "fuzz_seeds").exists():
            subprocess.run([build / "bin" / "fuzz_seeds", seeds], check=True)
        with ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda name: fuzz(build, name, options, Path(seeds)), names))
    ledger = build / "executions.json"
    counts = json.loads(ledger.read_text()) if ledger.exists() else {}
    record, sanitized = read_record(), is_sanitized(build)
    for name, (count, _) in zip(names, results):
        counts[name] = counts.get(name, 0) + count
        record[name, sanitized] = record.get((name, sanitized), 0) + count
    ledger.write_text(json.dumps(counts, indent=1))
    if options.record:
        write_record(record)
    print(f"{sum(c for c, _ in results):,} executions; {sum(counts.values()):,} in {build} so far")
    return 0 if all(good for _, good in results) else 1


if __name__ == "__main__":
    sys.exit(main())
