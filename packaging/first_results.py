#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""From nothing to a first result in each language: a fresh clone and the first commands of its README, timed.

packaging/first_results.py [c++] [python] [rust] [csharp] [web]     all of them where none is named

Each language has a clone of its own, so nothing is built before. At most three commands count, with `git clone`. A
compiler cache is switched off. Prints a table whose processor time is that of all processes
that a command started. What is missing of Debian's packages is downloaded. Exit status 1 where a command fails, or
ends without its result because a tool is missing; its output is then shown.
"""
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Language: its README, and how many commands of its first block lead to the result.
PATHS = {
    "c++": ("README.md", 1),
    "python": ("bindings/python/README.md", 2),
    "rust": ("bindings/rust/README.md", 2),
    "csharp": ("bindings/csharp/README.md", 2),
    "web": ("bindings/web/README.md", 2),
}


def commands_of(readme, count):
    """The first commands of a README's first block of shell."""
    found = re.search(r"^```sh\n(.*?)^```", (ROOT / readme).read_text(encoding="utf-8"), re.M | re.S)
    lines = [re.sub(r"\s+#.*", "", line).strip() for line in found[1].splitlines()] if found else []
    commands = [line for line in lines if line][:count]
    if len(commands) < count:
        sys.exit(f"first_results: {readme} does not begin with {count} commands")
    return commands


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(command, folder):
    """Seconds by the clock, seconds of processor, and what it printed last."""
    start, used = time.monotonic(), processor_time()
    done = subprocess.run(command, shell=True, cwd=folder, env={**os.environ, "CCACHE_DISABLE": "1"}, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    lines = [line.strip() for line in done.stdout.splitlines() if line.strip()]
    last = lines[-1] if lines else ""
    if done.returncode != 0 or ": skipped, " in last:
        sys.stderr.write(done.stdout)
        sys.exit(f"first_results: {command}: status {done.returncode}")
    return time.monotonic() - start, processor_time() - used, last


def minutes(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.1f} min"


def main():
    chosen = sys.argv[1:] or list(PATHS)
    if unknown := [name for name in chosen if name not in PATHS]:
        sys.exit(f"first_results: {', '.join(unknown)}: not one of {', '.join(PATHS)}")
    print("| language | commands | by the clock | processor | ends with |\n|---|---|---|---|---|", flush=True)
    for name in chosen:
        with tempfile.TemporaryDirectory() as folder:
            clone = pathlib.Path(folder) / "crofton"
            steps = [run(f"git clone --quiet {ROOT} {clone}", folder)]
            commands = commands_of(*PATHS[name])
            steps += [run(command, clone) for command in commands]
        shown = ", ".join(f"`{command}`" for command in ["git clone", *commands])
        clock = " + ".join(minutes(step[0]) for step in steps)
        print(f"| {name} | {shown} | {clock} | {minutes(sum(step[1] for step in steps))} | `{steps[-1][2][:100]}` |", flush=True)


if __name__ == "__main__":
    main()
