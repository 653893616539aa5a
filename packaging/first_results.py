#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""From a bare Debian 12 to a first result with each package of a release: the commands of docs/install.md, timed.

packaging/first_results.py FOLDER [--root ROOT] [--csv FILE] [SECTION]...

FOLDER is what packaging/release.sh made; SECTIONs are headings of docs/install.md, all of them where none is named. ROOT is a
Debian 12 of debootstrap's variant minbase, build/bare; it is made where it is missing, and never changed: each section
runs in a layer over it. The tools that a section names are installed before the time starts. Needs to run as root.
Prints a table; --csv writes it, as bench/results.py reads it. Exit status 1 where a command fails.
"""
import argparse
import csv
import datetime
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/install.md"
FIELDS = ["package", "commands", "seconds", "of these, processor", "it says"]


class Section:
    """What a section of the page says: tools, commands, and the program to save."""

    def __init__(self, name, text):
        self.name = name
        self.commands = re.search(r"^```sh\n(.*?)^```", text, re.M | re.S)[1].splitlines()
        tools = re.search(r"Tools: (.*?)\.(?:\s|$)", text)
        self.tools = re.findall(r"`([^`]+)`", tools[1]) if tools else []
        self.program = re.search(r"\]\(\.\./([^)#]+)[^)]*\)[^`]* as `([^`]+)`", text)  # page or source, file name

    def save_program(self, folder):
        if not self.program:
            return
        page, name = self.program.groups()
        text = (ROOT / page).read_text(encoding="utf-8")
        if page.endswith(".md"):
            text = re.search(r"^```(?:cpp|python|js|csharp)\n(.*?)^```", text, re.M | re.S)[1]
        (folder / name).write_text(text, encoding="utf-8")


def sections():
    parts = re.split(r"^## (.*)\n", PAGE.read_text(encoding="utf-8"), flags=re.M)[1:]
    return {name: Section(name, text) for name, text in zip(parts[::2], parts[1::2])}


def make_bare(root):
    if not (root / "etc/apt").is_dir():
        subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root], check=True, stdout=sys.stderr)


class Layer:
    """A bare system with a layer of its own over it."""

    def __init__(self, bare, folder):
        self.bare, self.folder = bare, folder
        for name in ("upper", "work", "merged"):
            (folder / name).mkdir()
        self.home = folder / "upper/root"
        self.home.mkdir(mode=0o700)
        (folder / "upper/etc/apt/apt.conf.d").mkdir(parents=True)
        (folder / "upper/etc/apt/apt.conf.d/90yes").write_text('APT::Get::Assume-Yes "true";\nAPT::Install-Recommends "false";\n')
        shutil.copy("/etc/resolv.conf", folder / "upper/etc/resolv.conf")

    def run(self, command):
        """Runs a shell command within; what it printed. Mounts are gone when it ends."""
        root = shlex.quote(str(self.folder / "merged"))
        mounts = (f"mount -t overlay overlay -o lowerdir={self.bare},upperdir={self.folder}/upper,workdir={self.folder}/work {root} && "
                  f"mount -t proc proc {root}/proc && mount --rbind /dev {root}/dev && "
                  f"exec chroot {root} /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "
                  f"bash -c {shlex.quote('cd && ' + command)}")
        done = subprocess.run(["unshare", "--mount", "bash", "-c", mounts], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode:
            raise RuntimeError(f"{command}: status {done.returncode}\n{done.stdout[-3000:]}")
        return [line.strip() for line in done.stdout.splitlines() if line.strip()]


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def attempt(section, products, bare):
    """A row of the table."""
    with tempfile.TemporaryDirectory(dir=bare.parent) as name:
        layer = Layer(bare, pathlib.Path(name))
        for product in products.iterdir():
            if product.is_file():
                shutil.copy(product, layer.home)
        section.save_program(layer.home)
        layer.run("apt update" + (f" && apt install {' '.join(section.tools)}" if section.tools else ""))
        start, used = time.monotonic(), processor_time()
        for command in section.commands:
            lines = layer.run(command.removeprefix("sudo "))
        seconds, processor = time.monotonic() - start, processor_time() - used
        return [section.name, len(section.commands), f"{seconds:.1f}", f"{processor:.1f}", f"`{lines[-1][:70]}`"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("sections", nargs="*")
    parser.add_argument("--root", type=pathlib.Path, default=ROOT / "build/bare")
    parser.add_argument("--csv", type=pathlib.Path)
    options = parser.parse_args()
    known = sections()
    if unknown := [name for name in options.sections if name not in known]:
        sys.exit(f"first_results: {', '.join(unknown)}: not one of {', '.join(known)}")
    bare = options.root.resolve()
    make_bare(bare)
    rows, failed = [], False
    print("| " + " | ".join(FIELDS) + " |\n|" + "---|" * len(FIELDS), flush=True)
    for name in options.sections or known:
        try:
            rows.append(attempt(known[name], options.folder, bare))
            print("| " + " | ".join(map(str, rows[-1])) + " |", flush=True)
        except RuntimeError as error:
            print(f"| {name} | **failed** |")
            print(error, file=sys.stderr)
            failed = True
    if options.csv and not failed:
        with options.csv.open("w", encoding="utf-8", newline="") as file:
            file.write(f"# date: {datetime.date.today()}\n# command: packaging/first_results.py FOLDER --csv {options.csv.name}\n")
            csv.writer(file, lineterminator="\n").writerows(row[:-1] for row in [FIELDS, *rows])
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
