#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds the digests' tests for every platform that this machine can compile for and run, and compares the digests.

tests/platforms/run.py [CELL …] [--jobs J] [--targets a,b]   all cells, or those whose names contain a word
tests/platforms/run.py --list                                the cells, and why some are left out here
tests/platforms/run.py --report                              the table of docs/testing.md from the last results
tests/platforms/run.py --check                               whether docs/testing.md has that table

A cell is a compiler and a target. Its build lies in build/platforms/CELL, its result in build/platforms/results.json.
`third_party/install.sh --platforms` installs the compilers and emulators. Libraries that a target lacks are compiled
from the system's source packages, which apt-get fetches. A cell that cannot be here says why and counts for nothing.
Exit status 1 where a digest differs or a test fails. Python 3.11, nothing else.
"""
import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "platforms"
SOURCES = WORK / "sources"
TARGETS = ["test_determinism", "test_core", "test_geometry"]
EMSCRIPTEN = "/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake"
# Debian's Emscripten needs its modules of node, which a node from elsewhere does not look for.
ENVIRONMENT = {"NODE_PATH": "/usr/share/nodejs", "WINEDEBUG": "-all", **os.environ}
# A pool of threads must exist before the program waits for one, and exceptions are off unless asked for.
WASM_LINK = "-pthread -fexceptions -sPTHREAD_POOL_SIZE=12 -sINITIAL_MEMORY=1073741824 -sEXIT_RUNTIME=1 -sTOTAL_STACK=4194304"


@dataclass
class Cell:
    name: str
    what: str                      # for the table
    needs: list                    # programs
    options: list = field(default_factory=list)
    toolchain: str = ""            # of a target whose libraries are compiled from source packages
    flags: str = ""                # of both languages, also for the libraries
    link: str = ""
    host: str = ""                 # as GMP's configure calls it
    runner: list = field(default_factory=list)
    suffix: str = ""
    gmp_flags: str = ""

    @property
    def build(self):
        return WORK / self.name

    def missing(self):
        for program in self.needs:
            if not shutil.which(program) and not Path(program).exists():
                return f"{program} is not installed"
        return ""


def toolchain(name):
    return str(ROOT / "cmake" / f"{name}.cmake")


def clang(*more):
    return ["-DCMAKE_C_COMPILER=clang-14", "-DCMAKE_CXX_COMPILER=clang++-14", *more]


def wasm(name, what, flags):
    return Cell(name, what, ["emcc", "node", EMSCRIPTEN], ["-DEMSCRIPTEN_SYSTEM_PROCESSOR=wasm32"], EMSCRIPTEN,
                f"-pthread -fexceptions {flags}".strip(), WASM_LINK, "none", ["node"], ".js")


CELLS = [
    Cell("gcc", "g++ 12, x86-64", ["g++"]),
    Cell("gcc-native", "g++ 12, x86-64, `-march=native`", ["g++"], ["-DCMAKE_CXX_FLAGS=-march=native"]),
    Cell("gcc-flto", "g++ 12, x86-64, `-flto`", ["g++"], ["-DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON"]),
    Cell("gcc-scalar", "g++ 12, x86-64, scalar", ["g++"], ["-DCROFTON_SCALAR=ON"]),
    Cell("gcc-portable", "g++ 12, x86-64, no compiler extensions", ["g++"], ["-DCROFTON_PORTABLE=ON"]),
    Cell("clang", "clang 14, x86-64", ["clang++-14"], clang()),
    Cell("clang-libcxx", "clang 14, x86-64, libc++", ["clang++-14", "/usr/lib/llvm-14/include/c++/v1/vector"],
         clang(), toolchain("clang-libcxx"), host="x86_64-linux-gnu"),
    Cell("i386", "g++ 12, 32-bit x86", ["g++", "/usr/lib/gcc/x86_64-linux-gnu/12/32/libstdc++.a"],
         ["-DCROFTON_SIMD_TARGETS=SSE4"],
         toolchain("i686-linux-gnu"), host="i686-linux-gnu", gmp_flags="-m32 -idirafter /usr/include/x86_64-linux-gnu"),
    Cell("aarch64", "g++ 12, 64-bit ARM, qemu", ["aarch64-linux-gnu-g++", "qemu-aarch64"], [],
         toolchain("aarch64-linux-gnu"), host="aarch64-linux-gnu",
         runner=["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]),
    Cell("riscv64", "g++ 12, 64-bit RISC-V, qemu", ["riscv64-linux-gnu-g++", "qemu-riscv64"], [],
         toolchain("riscv64-linux-gnu"), host="riscv64-linux-gnu",
         runner=["qemu-riscv64", "-L", "/usr/riscv64-linux-gnu"]),
    Cell("mingw", "MinGW g++ 12, 64-bit Windows, Wine", ["x86_64-w64-mingw32-g++-posix", "wine"],
         ["-DCROFTON_SIMD_TARGETS=SSE4"],
         toolchain("x86_64-w64-mingw32"), host="x86_64-w64-mingw32", runner=["wine"], suffix=".exe"),
    wasm("wasm-simd", "Emscripten 3.1, WebAssembly with SIMD, node", "-msimd128"),
    wasm("wasm", "Emscripten 3.1, WebAssembly without SIMD, node", ""),
]


class Failed(Exception):
    pass


def run(command, log, cwd=ROOT, environment=None):
    with log.open("a") as file:
        print("$", shlex.join(map(str, command)), file=file, flush=True)
        done = subprocess.run([str(c) for c in command], cwd=cwd, stdout=file, stderr=subprocess.STDOUT,
                              env={**ENVIRONMENT, **(environment or {})})
    if done.returncode:
        raise Failed(f"`{Path(str(command[0])).name}` failed, see {log.relative_to(ROOT)}")


def fetch_sources(log):
    """Unpacks the source packages of highway, qhull and gmp: the system's own versions, Debian's patches applied."""
    if all((SOURCES / name).exists() for name in ("highway", "qhull", "gmp/doc")):
        return
    release = re.search(r"VERSION_CODENAME=(\w+)", Path("/etc/os-release").read_text())
    if not release:
        raise Failed("this system is no Debian: the libraries' source packages are unknown")
    packages = SOURCES / "packages"
    (packages / "lists" / "partial").mkdir(parents=True, exist_ok=True)
    listed = packages / "sources.list"
    listed.write_text(f"deb-src http://deb.debian.org/debian {release[1]} main\n")
    apt = ["apt-get", "-o", f"Dir::Etc::SourceList={listed}", "-o", "Dir::Etc::SourceParts=/dev/null", "-o",
           f"Dir::State::Lists={packages / 'lists'}", "-o", "Dir::Cache::pkgcache=", "-o", "Dir::Cache::srcpkgcache="]
    run([*apt, "update"], log)
    run([*apt, "source", "--download-only", "highway", "qhull", "gmp"], log, packages)
    for name in ("highway", "qhull", "gmp"):
        description = next(packages.glob(f"{name}_*.dsc"))
        run(["dpkg-source", "--no-check", "-x", description.name, SOURCES / name], log, packages)
    # Debian leaves out GMP's manual, which its configure expects.
    (SOURCES / "gmp" / "doc").mkdir(exist_ok=True)
    (SOURCES / "gmp" / "doc" / "Makefile.in").write_text("all install check clean:\n")


def cmake_options(cell):
    options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *cell.options]
    if cell.toolchain:
        prefix = cell.build / "prefix"
        options += [f"-DCMAKE_TOOLCHAIN_FILE={cell.toolchain}", f"-DCMAKE_PREFIX_PATH={prefix}",
                    f"-DCMAKE_FIND_ROOT_PATH={prefix}", "-DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY",
                    f"-DCMAKE_MODULE_PATH={prefix}/lib/cmake/modules"]
    if cell.flags:
        options += [f"-DCMAKE_C_FLAGS={cell.flags}", f"-DCMAKE_CXX_FLAGS={cell.flags}"]
    if cell.link:
        options.append(f"-DCMAKE_EXE_LINKER_FLAGS={cell.link}")
    return options


def gmp_environment(cell):
    flags = f"-O2 {cell.flags} {cell.gmp_flags}".strip()
    if cell.host == "x86_64-w64-mingw32":
        return {"CC": "x86_64-w64-mingw32-gcc-posix", "CXX": "x86_64-w64-mingw32-g++-posix", "CC_FOR_BUILD": "gcc"}
    if cell.host == "none":
        return {"CFLAGS": flags, "CXXFLAGS": flags, "CC_FOR_BUILD": "gcc"}
    if cell.name == "clang-libcxx":
        return {"CC": "clang-14", "CXX": "clang++-14 -stdlib=libc++", "CC_FOR_BUILD": "gcc"}
    if cell.gmp_flags:
        return {"CC": f"gcc {cell.gmp_flags}", "CXX": f"g++ {cell.gmp_flags}", "CC_FOR_BUILD": "gcc", "ABI": "32"}
    return {"CC_FOR_BUILD": "gcc"}


def build_libraries(cell, jobs, log):
    prefix, done = cell.build / "prefix", cell.build / "prefix" / "done"
    if done.exists():
        return
    fetch_sources(log)
    run(["cmake", "-S", ROOT / "tests/platforms/dependencies", "-B", cell.build / "dependencies", *cmake_options(cell),
         f"-DCMAKE_INSTALL_PREFIX={prefix}", f"-DCROFTON_SOURCES={SOURCES}"], log)
    run(["cmake", "--build", cell.build / "dependencies", "-j", jobs, "--target", "install"], log)
    gmp = cell.build / "gmp"
    shutil.rmtree(gmp, ignore_errors=True)
    gmp.mkdir()
    wrapper = ["emconfigure"] if cell.host == "none" else []
    run([*wrapper, SOURCES / "gmp/configure", f"--host={cell.host}", f"--prefix={prefix}", "--enable-cxx",
         "--disable-shared", "--disable-assembly"], log, gmp, gmp_environment(cell))
    run([*(["emmake"] if wrapper else []), "make", f"-j{jobs}", "install", "MAKEINFO=true"], log, gmp)
    done.touch()


def test(cell, target, log):
    """The numbers of passed, failed and skipped test cases of one program, and its digests' tests that failed."""
    program = cell.build / "build" / "bin" / (target + cell.suffix)
    done = subprocess.run([*cell.runner, str(program)], cwd=cell.build, capture_output=True, text=True, errors="replace",
                          env=ENVIRONMENT)
    with log.open("a") as file:
        print(f"$ {target}", done.stdout, done.stderr, sep="\n", file=file)
    found = re.findall(r"test cases:\s+(\d+) \|\s+(\d+) passed \|\s+(\d+) failed", done.stdout)
    if not found:
        raise Failed(f"{target} ended with status {done.returncode}, see {log.relative_to(ROOT)}")
    return int(found[-1][1]), int(found[-1][2])


def try_cell(cell, targets, jobs):
    cell.build.mkdir(parents=True, exist_ok=True)
    log, started = cell.build / "log.txt", time.monotonic()
    log.unlink(missing_ok=True)
    try:
        options = cmake_options(cell)
        if cell.toolchain:
            build_libraries(cell, jobs, log)
            options.append(f"-DCROFTON_TEST_LIBRARIES={cell.build / 'prefix'}")
        run(["cmake", "-S", ROOT, "-B", cell.build / "build", *options, "-DCROFTON_RENDER=OFF", "-DCROFTON_SAMPLES=OFF",
             "-DCROFTON_INSTALL=OFF", "-DCROFTON_DISCOVER_TESTS=OFF"], log)
        run(["cmake", "--build", cell.build / "build", "-j", jobs, "--target", *targets], log)
        result = {target: test(cell, target, log) for target in targets}
    except Failed as failure:
        return {"broken": str(failure)}
    return {"tests": result, "seconds": round(time.monotonic() - started)}


def failed(result):
    return "broken" in result or any(count for _, count in result["tests"].values())


def digests_of(result):
    if "broken" in result:
        return f"**{result['broken']}**"
    passed, wrong = result["tests"].get("test_determinism", (0, 0))
    return "not run" if passed + wrong == 0 else f"equal, {passed} tests" if wrong == 0 else f"**{wrong} tests differ**"


def others_of(result):
    cells = [f"{name.removeprefix('test_')} {passed}" + (f", **{wrong} fail**" if wrong else "")
             for name, (passed, wrong) in result.get("tests", {}).items() if name != "test_determinism"]
    return "; ".join(cells) or "–"


def report(results):
    lines = ["| platform | digests | other tests passed |", "|---|---|---|"]
    for cell in CELLS:
        result = results.get(cell.name)
        row = ("not run", "–") if result is None else (digests_of(result), others_of(result))
        lines.append(f"| {cell.what} | {row[0]} | {row[1]} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cells", nargs="*")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--targets", default=",".join(TARGETS))
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    path = WORK / "results.json"
    results = json.loads(path.read_text()) if path.exists() else {}
    if options.report:
        return print(report(results))
    if options.check:
        return 0 if report(results) in (ROOT / "docs/testing.md").read_text() else 1
    chosen = [c for c in CELLS if not options.cells or any(word == c.name for word in options.cells)
              or not any(word == c.name for word in options.cells for c in CELLS)
              and any(word in c.name for word in options.cells)]
    if not chosen:
        sys.exit("no cell has such a name: see --list")
    bad = False
    for cell in chosen:
        if reason := cell.missing():
            print(f"{cell.name}: left out: {reason}")
            continue
        if options.list:
            print(f"{cell.name}: {cell.what}")
            continue
        result = results[cell.name] = try_cell(cell, options.targets.split(","), options.jobs)
        path.write_text(json.dumps(results, indent=1))
        print(f"{cell.name}: digests {digests_of(result)}; {others_of(result)}", flush=True)
        bad = bad or failed(result)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
