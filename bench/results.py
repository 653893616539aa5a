#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measurements as CSV in bench/results/<processor>/, and the docs' tables made from them.

  bench/results.py measure BENCH [--targets AVX2,AVX3_DL] [--build build/bench] [--name NAME] [benchmark options …]
      runs bench_<BENCH> once for each instruction set and writes bench/results/<processor>/<NAME>.csv, NAME being BENCH
      unless given; "best" means the processor's own. Where no --benchmark_filter is given, those benchmarks are run that
      a table takes from that CSV.
  bench/results.py tables
      writes each table of bench/results/tables.json into its page, between the markers
      <!-- table NAME --> and <!-- end -->.
      A table with "plain": true shows its CSV's own rows, which another command has written. One with "columns" has a
      CSV and an instruction set for each column; "cold": true takes each row's benchmark with cold caches. A row's "scene"
      is added to the name of the CSV: cull_city.csv. "texts" are the heads of columns whose cells the rows give.
  bench/results.py check
      as tables, but writes nothing and exits with 1 where a page would change: the test of the docs.

A CSV begins with lines "# key: value" that say what was run where. Then a row for each benchmark and instruction set:
benchmark, instruction_set, least_ns, median_ns, repetitions. Times are of one iteration, elapsed.
"""
import csv
import datetime
import json
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench" / "results"
NAMES = {"AVX3": "AVX-512", "AVX3_DL": "AVX-512", "AVX3_ZEN4": "AVX-512"}  # Highway's names to the world's
FIELDS = ["benchmark", "instruction_set", "least_ns", "median_ns", "repetitions"]
NANOSECONDS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}


def processor():
    """The processor's name, fit for a folder."""
    info = pathlib.Path("/proc/cpuinfo")
    model = re.search(r"model name\s*:\s*(.*)", info.read_text(encoding="utf-8")) if info.exists() else None
    return re.sub(r"[^a-z0-9]+", "-", (model[1] if model else platform.machine()).lower()).strip("-")


def specifications():
    return json.loads((RESULTS / "tables.json").read_text(encoding="utf-8"))


def csv_of(table, row, column=None):
    """The name of the CSV that a row's benchmark is in."""
    name = (column or {}).get("csv", table["csv"])
    return f"{name}_{row['scene']}" if "scene" in row else name


def names_in(table, csv_name):
    """All benchmarks that a table needs of a CSV."""
    names = set()
    for row in table.get("rows", []):
        for column in table.get("columns", [{}]):
            if csv_of(table, row, column) == csv_name:
                names |= {row.get("cold")} if column.get("cold") else {row["benchmark"], row.get("beside")}
    return names - {None}


def times_of(report):
    """{benchmark: [nanoseconds of each repetition]} from Google Benchmark's JSON."""
    times = {}
    for run in report["benchmarks"]:
        if run.get("run_type", "iteration") == "iteration":
            name = re.sub(r"/(iterations|repeats):.*", "", run["run_name"])
            times.setdefault(name, []).append(run["real_time"] * NANOSECONDS[run["time_unit"]])
    return times


def measure(bench, arguments):
    targets, build, name, options, given = ["AVX2", "best"], "build/bench", bench, [], " ".join(arguments)
    while arguments:
        argument = arguments.pop(0)
        if argument == "--name":
            name = arguments.pop(0)
        elif argument == "--targets":
            targets = arguments.pop(0).split(",")
        elif argument == "--build":
            build = arguments.pop(0)
        else:
            options.append(argument)
    if not any(option.startswith("--benchmark_filter") for option in options):
        wanted = {one for table in specifications().values() for one in names_in(table, name)}
        options.append("--benchmark_filter=^(" + "|".join(sorted(re.sub(r"([^\w ,/-])", r"\\\1", one) for one in wanted)) + ")(/iterations:.*)?$")
    if not any(option.startswith("--benchmark_repetitions") for option in options):
        options.append("--benchmark_repetitions=5")
    rows = []
    for target in targets:
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out.json"
            command = [str(ROOT / build / "bin" / f"bench_{bench}"), f"--benchmark_out={out}", "--benchmark_out_format=json"]
            command += options + ([] if target == "best" else [f"--target={target}"])
            subprocess.run(command, check=True, stdout=sys.stderr)
            report = json.loads(out.read_text(encoding="utf-8"))
        used = report["context"].get("instruction_set", target)
        for benchmark, times in sorted(times_of(report).items()):
            rows.append([benchmark, NAMES.get(used, used), f"{min(times):.6g}", f"{statistics.median(times):.6g}", len(times)])
    commit = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], capture_output=True, text=True, check=False)
    path = RESULTS / processor() / f"{name}.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# command: bench/results.py measure {bench} {given}".rstrip() + "\n")
        file.write(f"# commit: {commit.stdout.strip() or 'unknown'}\n")
        file.write(f"# date: {datetime.date.today().isoformat()}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        writer.writerows(rows)
    print(path.relative_to(ROOT))


def read(path):
    """{(benchmark, instruction set): (least, median)} in nanoseconds."""
    with path.open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(row["benchmark"], row["instruction_set"]): (float(row["least_ns"]), float(row["median_ns"])) for row in rows}


def number(value):
    """Two digits, or all before the point."""
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}" if value >= 1 else f"{value:.2f}"


def span(low, high):
    return number(low) if number(low) == number(high) else f"{number(low)} to {number(high)}"


def plain_table(path):
    """The lines of a table: a CSV's own rows."""
    with path.open(encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return lines[:1] + ["|" + "---|" * len(rows[0])] + lines[1:]


def table_of(table, times):
    """The lines of a table: least to median of each row, per instruction set, and how many times as long the other takes."""
    sets = table["instruction_sets"]
    others = any(row.get("beside") for row in table["rows"])
    texts = table.get("texts", [])
    head = [table["title"]] + [f"{table['unit']}, {name}" for name in sets] + ([table["beside"]] if others else []) + texts
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for row in table["rows"]:
        scale = 1.0 / row["divide_by"]
        cells = [row["text"]] + [span(*(time * scale for time in times[row["benchmark"], name])) for name in sets]
        if others:
            beside = row.get("beside")
            ratios = [times[beside, name][0] / times[row["benchmark"], name][0] for name in sets] if beside else []
            shown = (lambda ratio: f"{ratio:.2f}") if table.get("fine_ratios") else number
            cells.append(f"{' / '.join(shown(ratio) for ratio in ratios)} ×" if ratios else "")
        cells += row.get("texts", [""] * len(texts))
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def columns_table(table, folder):
    """The lines of a table that has a CSV and an instruction set for each column."""
    heads = [table["title"]] + [column["head"] for column in table["columns"]]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    files = {}
    for row in table["rows"]:
        cells = [row["text"]]
        for column in table["columns"]:
            name = row.get("cold") if column.get("cold") else row["benchmark"]
            path = folder / f"{csv_of(table, row, column)}.csv"
            if path not in files:
                files[path] = read(path) if path.exists() else {}
            found = files[path].get((name, column["instruction_set"]))
            cells.append(span(*(time / row["divide_by"] for time in found)) if found else "")
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def write_tables(check):
    changed = []
    for name, table in specifications().items():
        path = ROOT / table["page"]
        page = path.read_text(encoding="utf-8")
        folder = RESULTS / table["processor"]
        path_of_csv = folder / f"{table['csv']}.csv"
        if "columns" in table:
            lines = columns_table(table, folder)
        else:
            lines = plain_table(path_of_csv) if table.get("plain") else table_of(table, read(path_of_csv))
        marked = re.compile(rf"(<!-- table {re.escape(name)} -->\n).*?(<!-- end -->)", re.S)
        if len(marked.findall(page)) != 1:
            sys.exit(f"{table['page']} must have the markers of the table {name} once")
        new = marked.sub(lambda match: match[1] + "\n".join(lines) + "\n" + match[2], page)
        if new != page:
            changed.append(f"{table['page']}: table {name}")
            if not check:
                path.write_text(new, encoding="utf-8")
    print("\n".join(changed) or "all tables are as measured")
    return 1 if check and changed else 0


if __name__ == "__main__":
    if len(sys.argv) > 2 and sys.argv[1] == "measure":
        measure(sys.argv[2], sys.argv[3:])
    elif len(sys.argv) == 2 and sys.argv[1] in ("tables", "check"):
        sys.exit(write_tables(sys.argv[1] == "check"))
    else:
        sys.exit(__doc__)
