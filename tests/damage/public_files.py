#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the command line on public test files, and compares what it says with what their makers say.

public_files.py CROFTON FOLDER [--seconds S] [--megabytes M] [--list]

FOLDER lies outside the repository. Where it holds no models, Debian's assimp-testmodels is fetched into it by apt-get,
and Khronos' glTF-Validator by git; nothing is installed. Any folder with .gltf, .glb and .obj files will do.

A file of the validator has its report beside it (NAME.report.json): its errors, and its number of triangles. The table
has a row for each verdict of the maker and a column for each answer of the command line. --list prints each file with
both reasons. Exits with 1 if a run ends by a signal or another status than 0, 1 and 2, takes longer than S seconds or
more than M megabytes, or refuses a file without a reason. What the table compares is for a reader to judge.
"""
import argparse
import collections
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

PACKAGE = "assimp-testmodels"
VALIDATOR = "https://github.com/KhronosGroup/glTF-Validator"
FAULTS = ("crash", "hang", "memory", "no reason")
ANSWERS = ("loads", "loads in part", "no triangles", "refused") + FAULTS


def models(folder):
    return sorted(p for p in folder.rglob("*") if p.is_file() and p.suffix.lower() in (".gltf", ".glb", ".obj"))


def fetch(folder):
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run(["apt-get", "download", PACKAGE], cwd=folder, check=True)
    for package in folder.glob(f"{PACKAGE}_*.deb"):
        subprocess.run(["dpkg", "-x", str(package), str(folder / "assimp")], check=True)
    subprocess.run(["git", "clone", "--depth", "1", VALIDATOR, str(folder / "validator")], check=True)


def maker_says(path):
    """(row of the table, the maker's errors)"""
    report = path.with_name(path.name + ".report.json")
    if not report.exists():
        return f"{path.suffix.lower()[1:]} without a report", ""
    said = json.loads(report.read_text(encoding="utf-8"))
    codes = sorted({m["code"] for m in said["issues"].get("messages", []) if m["severity"] == 0})
    if said["issues"]["numErrors"]:
        return "errors", " ".join(codes)
    triangles = said.get("info", {}).get("totalTriangleCount")
    if triangles is None:
        return "no errors, triangles not counted", ""
    return ("no errors, triangles" if triangles else "no errors, no triangles"), ""


def command_line_says(options, path):
    """(answer, what it printed to stderr)"""
    command = [options.crofton, "frames", str(path), "--no-draw", "--frames", "1"]
    with tempfile.TemporaryFile() as said:
        begin = time.monotonic()
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said)
        killed = False
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if not killed and time.monotonic() - begin > options.seconds:
                process.kill()
                killed = True
            time.sleep(0.001)
        code = process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().decode(errors="replace").strip()
    if killed:
        return "hang", text
    if code not in (0, 1, 2):
        return "crash", f"status {code}: {text}"
    if usage.ru_maxrss > options.megabytes * 1024:
        return "memory", text
    if code == 0:
        return ("loads in part" if text else "loads"), text
    if not text:
        return "no reason", text
    return ("no triangles" if "shows no triangles" in text else "refused"), text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crofton")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--megabytes", type=int, default=1024)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    if not models(options.folder):
        fetch(options.folder)
    table, faults = collections.defaultdict(collections.Counter), 0
    files = models(options.folder)
    for path in files:
        row, codes = maker_says(path)
        answer, text = command_line_says(options, path)
        table[row][answer] += 1
        faults += answer in FAULTS
        if options.list or answer in FAULTS:
            reason = " / ".join(text.replace(str(path), "FILE").splitlines()[:3])
            print(f"{row}\t{answer}\t{path.relative_to(options.folder)}\t{codes}\t{reason}")
    print("| maker's verdict | files | " + " | ".join(ANSWERS) + " |")
    print("|---" * (len(ANSWERS) + 2) + "|")
    for row, answers in sorted(table.items()):
        print(f"| {row} | {sum(answers.values())} | " + " | ".join(str(answers[a]) for a in ANSWERS) + " |")
    print(f"{len(files)} files, {faults} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
