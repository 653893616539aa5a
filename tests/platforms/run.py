#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds the digests' tests for every platform that this machine can compile for and run, and compares the digests.

tests/platforms/run.py [CELL …] [--jobs J] [--modules a,b] [--limit S] [--nice N]   all cells, or those named
tests/platforms/run.py --libraries [CELL …]                  compiles only the libraries that the targets' presets need
tests/platforms/run.py --list                                the cells, and why some are left out here
tests/platforms/run.py --report                              the table of docs/testing.md from the results so far
tests/platforms/run.py --write                               puts that table into docs/testing.md
tests/platforms/run.py --check                               whether docs/testing.md has that table

A cell is a compiler and a target, set as a preset of CMakePresets.json says. Its build lies in build/platforms/CELL; the
results of all are in build/platforms/results.json. Two runs may try different cells at a time. Cells are made cheap:
little optimisation, one instruction set, ccache where it is installed, least priority. The digests come first, one file
of tests after another; then the tests of the modules (core and geometry unless told). What is left of a cell that was
stopped is done by the next run: a part is done again only where its program has changed. A part that takes longer than
the limit (900 s) is stopped, and the table says so. In cells that are slow each file of tests is a part.
`third_party/install.sh --platforms` installs the compilers and emulators. Libraries that a target lacks are compiled
from the system's source packages, which apt-get fetches. A cell that cannot be here says why and counts for nothing.
Exit status 1 where a digest differs or a test fails. Python 3.11, nothing else.
"""
import argparse
import fcntl
import hashlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "platforms"
SOURCES = WORK / "sources"
RESULTS = ROOT / "build" / "platforms" / "results.json"
DIGESTS = "test_determinism"
MODULES = "core,geometry"
PRESETS = json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
EMSCRIPTEN = "/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake"
# Debian's Emscripten needs its modules of node, which a node from elsewhere does not look for.
ENVIRONMENT = {"NODE_PATH": "/usr/share/nodejs", "WINEDEBUG": "-all", **os.environ}


@dataclass
class Cell:
    name: str
    what: str                      # for the table
    needs: list                    # programs
    preset: str = ""               # where it is not named as the cell
    options: list = field(default_factory=list)   # what makes a cell cheap
    host: str = ""                 # as GMP's configure calls it; of a target whose libraries are compiled from source packages
    runner: list = field(default_factory=list)
    suffix: str = ""
    optimize: str = "-O1"          # the quickest in all: what the tests lose, the compiler gains several times
    newer_highway: bool = False    # that of Debian 13
    by_file: bool = False          # slow, by emulation or by GMP without assembly: each file of tests has the limit to itself
    own_libcxx: bool = False       # a C++ library compiled for the memory sanitizer

    @property
    def build(self):
        return WORK / self.name

    def missing(self):
        for program in self.needs:
            if not shutil.which(program) and not Path(program).exists():
                return f"{program} is not installed"
        return ""


def wasm(name, what, **more):
    return Cell(name, what, ["emcc", "node", EMSCRIPTEN], host="none", runner=["node", "--no-experimental-fetch"],
                suffix=".js", **more)


def one_set(name):
    """Kernels for the baseline and one more instruction set."""
    return f"-DCROFTON_SIMD_TARGETS={name}"


CELLS = [
    Cell("gcc", "g++ 12, x86-64", ["g++"], "release", [one_set("AVX2")]),
    Cell("gcc-native", "g++ 12, x86-64, `-march=native`", ["g++"], "native"),
    Cell("gcc-flto", "g++ 12, x86-64, `-flto`", ["g++"], "lto", [one_set("AVX2")], optimize="-O2"),
    Cell("gcc-scalar", "g++ 12, x86-64, scalar", ["g++"], "scalar"),
    Cell("gcc-portable", "g++ 12, x86-64, no compiler extensions", ["g++"], "portable", [one_set("AVX2")]),
    Cell("clang", "clang 14, x86-64", ["clang++-14"], options=["-DCROFTON_UNITY=ON", one_set("AVX2")]),
    Cell("clang-libcxx", "clang 14, x86-64, libc++", ["clang++-14", "/usr/lib/llvm-14/include/c++/v1/vector"],
         options=[one_set("AVX2")], host="x86_64-linux-gnu"),
    Cell("clang-msan", "clang 14, x86-64, libc++, memory sanitizer", ["clang++-14", "/usr/lib/llvm-14/include/c++/v1/vector"],
         # What the sanitizer knows of a vector's lanes does not move with them, where they are put into another order.
         options=["-DCROFTON_SCALAR=ON"], host="x86_64-linux-gnu", by_file=True, own_libcxx=True),
    Cell("i386", "g++ 12, 32-bit x86", ["i686-linux-gnu-g++"], host="i686-linux-gnu", by_file=True),
    Cell("aarch64", "g++ 12, 64-bit ARM, qemu", ["aarch64-linux-gnu-g++", "qemu-aarch64"], host="aarch64-linux-gnu",
         runner=["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], by_file=True),
    Cell("riscv64", "g++ 12, 64-bit RISC-V, qemu", ["riscv64-linux-gnu-g++", "qemu-riscv64"], host="riscv64-linux-gnu",
         runner=["qemu-riscv64", "-L", "/usr/riscv64-linux-gnu"], by_file=True),
    Cell("mingw", "MinGW g++ 12, 64-bit Windows, Wine", ["x86_64-w64-mingw32-g++-posix", "wine"],
         host="x86_64-w64-mingw32", runner=["wine"], suffix=".exe"),
    wasm("wasm-simd", "Emscripten 3.1, WebAssembly with SIMD, node", newer_highway=True),
    wasm("wasm", "Emscripten 3.1, WebAssembly without SIMD, node"),
]


class Failed(Exception):
    pass


def environment_of(cell):
    """For cmake: ccache, where it is installed and nothing else was chosen. It does not know Emscripten's compiler."""
    launcher = shutil.which("ccache")
    if not launcher or cell.host == "none":
        return {}
    return {name: launcher for name in ("CMAKE_C_COMPILER_LAUNCHER", "CMAKE_CXX_COMPILER_LAUNCHER") if name not in os.environ}


def run(command, log, cwd=ROOT, environment=None):
    with log.open("a") as file:
        print("$", shlex.join(map(str, command)), file=file, flush=True)
        done = subprocess.run([str(c) for c in command], cwd=cwd, stdout=file, stderr=subprocess.STDOUT,
                              env={**ENVIRONMENT, **(environment or {})})
    if done.returncode:
        raise Failed(f"`{Path(str(command[0])).name}` failed, see {log.relative_to(ROOT)}")


def download(release, names, sources, log):
    """Source packages of a release of Debian, in a folder that is returned."""
    packages = sources / "packages"
    (packages / "lists" / "partial").mkdir(parents=True, exist_ok=True)
    listed = packages / "sources.list"
    listed.write_text(f"deb-src http://deb.debian.org/debian {release} main\n")
    apt = ["apt-get", "-o", f"Dir::Etc::SourceList={listed}", "-o", "Dir::Etc::SourceParts=/dev/null", "-o",
           f"Dir::State::Lists={packages / 'lists'}", "-o", "Dir::Cache::pkgcache=", "-o", "Dir::Cache::srcpkgcache="]
    run([*apt, "update"], log)
    run([*apt, "source", "--download-only", *names], log, packages)
    return packages


def fetch(release, names, sources, log):
    """Unpacks source packages of a release of Debian, its patches applied, into a folder each."""
    packages = download(release, names, sources, log)
    for name in names:
        description = next(packages.glob(f"{name}_*.dsc"))
        run(["dpkg-source", "--no-check", "-x", description.name, sources / name], log, packages)


def fetch_sources(log):
    """Highway, Qhull and GMP as this system has them."""
    if all((SOURCES / name).exists() for name in ("highway", "qhull", "gmp/doc")):
        return
    release = re.search(r"VERSION_CODENAME=(\w+)", Path("/etc/os-release").read_text())
    if not release:
        raise Failed("this system is no Debian: the libraries' source packages are unknown")
    fetch(release[1], ["highway", "qhull", "gmp"], SOURCES, log)
    # Debian leaves out GMP's manual, which its configure expects.
    (SOURCES / "gmp" / "doc").mkdir(exist_ok=True)
    (SOURCES / "gmp" / "doc" / "Makefile.in").write_text("all install check clean:\n")


def fetch_llvm(folder, log):
    """What of LLVM's source package the C++ library needs: the whole is a gigabyte."""
    packages = download("bookworm", ["llvm-toolchain-14"], folder, log)
    (archive,) = packages.glob("llvm-toolchain-14_*.orig.tar.*")
    run(["tar", "xf", archive, "-C", folder, "--strip-components=1", "--wildcards", "*/libcxx/*", "*/libcxxabi/*",
         "*/runtimes/*", "*/llvm-lit/*", "*/cmake/*"], log)


def fetch_newer(log):
    """The same folder with Debian 13's Highway: that of Debian 12 has no doubles in its WebAssembly target."""
    newer = WORK / "newer_sources"
    newer.mkdir(exist_ok=True)
    if not (newer / "highway").exists():
        fetch("trixie", ["highway"], newer, log)
    if not (newer / "qhull").exists():
        (newer / "qhull").symlink_to(SOURCES / "qhull")
    return newer


def build_libcxx(cell, jobs, log):
    """The C++ library, compiled for the memory sanitizer: what another one writes would look uninitialised."""
    prefix, source = cell.build / "libcxx", WORK / "llvm"
    if (prefix / "done").exists():
        return
    if not (source / "runtimes").exists():
        fetch_llvm(source, log)
    run(["cmake", "-S", source / "runtimes", "-B", cell.build / "libcxx_build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
         "-DCMAKE_C_COMPILER=clang-14", "-DCMAKE_CXX_COMPILER=clang++-14", f"-DCMAKE_INSTALL_PREFIX={prefix}",
         "-DLLVM_ENABLE_RUNTIMES=libcxx;libcxxabi", "-DLLVM_USE_SANITIZER=Memory", "-DLIBCXXABI_USE_LLVM_UNWINDER=OFF",
         *(f"-D{library}_{option}=OFF" for library in ("LIBCXX", "LIBCXXABI") for option in ("ENABLE_STATIC", "INCLUDE_TESTS")),
         "-DLIBCXX_INCLUDE_BENCHMARKS=OFF", "-DLIBCXX_ENABLE_EXPERIMENTAL_LIBRARY=OFF"], log, environment=environment_of(cell))
    run(["cmake", "--build", cell.build / "libcxx_build", "-j", jobs, "--target", "install-cxx", "install-cxxabi"], log)
    (prefix / "done").touch()


def settings_of(preset, name):
    """The options of a configure preset and those it inherits, where it is called `name`."""
    (found,) = [p for p in PRESETS if p["name"] == preset]
    inherited = found.get("inherits", [])
    settings = {}
    # The first of several wins.
    for parent in reversed([inherited] if isinstance(inherited, str) else inherited):
        settings |= settings_of(parent, name)
    settings |= found.get("cacheVariables", {})
    if "toolchainFile" in found:
        settings["CMAKE_TOOLCHAIN_FILE"] = found["toolchainFile"]
    return {key: value.replace("${sourceDir}", str(ROOT)).replace("${presetName}", name) for key, value in settings.items()}


def cmake_options(cell):
    settings = settings_of(cell.preset or cell.name, cell.name)
    if cell.host:
        settings |= settings_of("libraries", cell.name)
    # Not the build type Release, for which the tests choose an optimisation of their own.
    flags = f"_FLAGS_RELWITHDEBINFO={cell.optimize} -DNDEBUG"
    return ["-G", "Ninja", *(f"-D{key}={value}" for key, value in settings.items()), "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
            f"-DCMAKE_C{flags}", f"-DCMAKE_CXX{flags}", *cell.options]


def flags_of(cell, name="CMAKE_C_FLAGS"):
    """What the toolchain file compiles C with, or others of its flags."""
    cache = (cell.build / "dependencies" / "CMakeCache.txt").read_text()
    return re.search(rf"^{name}:\w+=(.*)$", cache, re.MULTILINE)[1]


def gmp_environment(cell):
    flags = f"-O2 {flags_of(cell)}".strip()
    if cell.host == "x86_64-w64-mingw32":
        return {"CC": "x86_64-w64-mingw32-gcc-posix", "CXX": "x86_64-w64-mingw32-g++-posix", "CC_FOR_BUILD": "gcc"}
    if cell.host == "none":
        return {"CFLAGS": flags, "CXXFLAGS": flags, "CC_FOR_BUILD": "gcc"}
    if cell.name == "clang-libcxx":
        return {"CC": "clang-14", "CXX": "clang++-14 -stdlib=libc++", "CC_FOR_BUILD": "gcc"}
    if cell.own_libcxx:
        linked = flags_of(cell, "CMAKE_EXE_LINKER_FLAGS")
        return {"CC": "clang-14", "CXX": f"clang++-14 -Wno-unused-command-line-argument {linked}", "CFLAGS": flags,
                "CXXFLAGS": f"-O2 {flags_of(cell, 'CMAKE_CXX_FLAGS')}", "CC_FOR_BUILD": "gcc"}
    return {"CC_FOR_BUILD": "gcc"}


def build_libraries(cell, jobs, log):
    prefix, done = cell.build / "prefix", cell.build / "prefix" / "done"
    if done.exists():
        return
    fetch_sources(log)
    if cell.own_libcxx:
        build_libcxx(cell, jobs, log)
    sources = fetch_newer(log) if cell.newer_highway else SOURCES
    run(["cmake", "-S", ROOT / "tests/platforms/dependencies", "-B", cell.build / "dependencies", *cmake_options(cell),
         f"-DCMAKE_INSTALL_PREFIX={prefix}", f"-DCROFTON_SOURCES={sources}"], log, environment=environment_of(cell))
    run(["cmake", "--build", cell.build / "dependencies", "-j", jobs, "--target", "install"], log)
    gmp = cell.build / "gmp"
    shutil.rmtree(gmp, ignore_errors=True)
    gmp.mkdir()
    wrapper = ["emconfigure"] if cell.host == "none" else []
    run([*wrapper, SOURCES / "gmp/configure", f"--host={cell.host}", f"--prefix={prefix}", "--enable-cxx",
         "--disable-shared", "--disable-assembly"], log, gmp, gmp_environment(cell))
    run([*(["emmake"] if wrapper else []), "make", f"-j{jobs}", "install", "MAKEINFO=true"], log, gmp)
    done.touch()


def parts_of(target, by_file=False):
    """What of a program is run and remembered alone: {name: doctest's filters}."""
    if target != DIGESTS and not by_file:
        return {target: []}
    module = target.removeprefix("test_")
    files = sorted((ROOT / "tests" / module).glob("*_test.cpp"))
    return {file.stem.removesuffix("_test"): [f"--source-file=*{module}/{file.name}"] for file in files}


def program_of(cell, target):
    return cell.build / "build" / "bin" / (target + cell.suffix)


def hash_of(program):
    """Of a program and, where it is JavaScript, of what that loads."""
    files = [file for file in (program, program.with_suffix(".wasm")) if file.exists()]
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]


def test(cell, target, filters, limit, log):
    """The numbers of passed and failed test cases, the seconds; or what went wrong."""
    started = time.monotonic()
    process = subprocess.Popen([*cell.runner, str(program_of(cell, target)), "--no-colors", *filters], cwd=cell.build, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace", env=ENVIRONMENT,
                               start_new_session=True)
    try:
        said, _ = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        said = process.communicate()[0]
        return {"broken": f"not done in {limit} s", "limit": limit}
    finally:
        with log.open("a") as file:
            print(f"$ {target}", *filters, file=file)
            print(said, file=file)
    found = re.findall(r"test cases:\s+(\d+) \|\s+(\d+) passed \|\s+(\d+) failed", said)
    if not found or (found[-1][0] == "0" and target == DIGESTS):
        return {"broken": f"ended with status {process.returncode}" if not found else "no test ran"}
    return {"passed": int(found[-1][1]), "failed": int(found[-1][2]), "seconds": round(time.monotonic() - started)}


def try_cell(cell, options, results):
    """Does what is left of a cell; results are kept after each part."""
    cell.build.mkdir(parents=True, exist_ok=True)
    log, result = cell.build / "log.txt", results.setdefault(cell.name, {})
    result.pop("broken", None)
    try:
        cmake, jobs = cmake_options(cell), str(options.jobs)
        if cell.host:
            build_libraries(cell, jobs, log)
        if options.libraries:
            return
        run(["cmake", "-S", ROOT, "-B", cell.build / "build", *cmake, "-DCROFTON_WERROR=OFF", "-DCROFTON_RENDER=OFF",
             "-DCROFTON_SAMPLES=OFF", "-DCROFTON_INSTALL=OFF", "-DCROFTON_DISCOVER_TESTS=OFF"], log,
            environment=environment_of(cell))
        for target in [DIGESTS, *(f"test_{module}" for module in options.modules.split(",") if module)]:
            run(["cmake", "--build", cell.build / "build", "-j", jobs, "--target", target], log)
            try_parts(cell, target, options.limit, result, log)
    except Failed as failure:
        result["broken"] = str(failure)
        keep(cell, result)


def try_parts(cell, target, limit, result, log):
    done, program = result.setdefault(target, {}), hash_of(program_of(cell, target))
    parts = parts_of(target, cell.by_file)
    for name in set(done) - set(parts):
        del done[name]
    for name, filters in parts.items():
        known = done.get(name, {})
        settled = "broken" not in known or known.get("limit", 0) >= limit
        if known.get("program") == program and settled:
            continue
        done[name] = {**test(cell, target, filters, limit, log), "program": program}
        keep(cell, result)
        print(f"{cell.name}: {name}: {text_of(done[name])}", flush=True)


def known_results():
    return json.loads(RESULTS.read_text()) if RESULTS.exists() else {}


def keep(cell, result):
    """Of this cell alone: other cells may be tried by other runs meanwhile."""
    WORK.mkdir(parents=True, exist_ok=True)
    with (WORK / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        results = {**known_results(), cell.name: result}
        kept = {c.name: results[c.name] for c in CELLS if c.name in results}
        text = json.dumps(kept, indent=1, sort_keys=False)
        # One line a part.
        text = re.sub(r"\{\s+([^{}]*?)\s+\}", lambda found: "{" + re.sub(r"\s+", " ", found[1]) + "}", text)
        RESULTS.with_suffix(".new").write_text(text + "\n")
        RESULTS.with_suffix(".new").replace(RESULTS)


def text_of(part):
    if "broken" in part:
        return part["broken"]
    return f"{part['passed']} passed" + (f", {part['failed']} fail" if part["failed"] else "") + f", {part['seconds']} s"


def wrong(part):
    return "broken" not in part and part["failed"] > 0


def failed(result):
    return "broken" in result or any(wrong(part) for target in result.values() for part in target.values())


def digests_of(result):
    parts, all_parts = result.get(DIGESTS, {}), parts_of(DIGESTS)
    if bad := [name for name, part in parts.items() if wrong(part)]:
        return f"**differ: {', '.join(bad)}**"
    equal = [name for name, part in parts.items() if "broken" not in part]
    if not equal:
        return f"**{result['broken']}**" if "broken" in result else "not run"
    missing = [f"{name} {parts.get(name, {}).get('broken', 'not run')}" for name in all_parts if name not in equal]
    tests = sum(parts[name]["passed"] for name in equal)
    return f"equal, {tests} tests" + (f" of {len(equal)} modules; {', '.join(missing)}" if missing else "")


def others_of(result):
    said = []
    if "broken" in result and result.get(DIGESTS):
        said.append(f"**{result['broken']}**")
    for target, parts in result.items():
        if target in (DIGESTS, "broken"):
            continue
        passed, wrongs = (sum(part.get(key, 0) for part in parts.values()) for key in ("passed", "failed"))
        words = [str(passed)] if passed else []
        words += [f"**{wrongs} fail**"] if wrongs else []
        words += [part["broken"] if name == target else f"{name} {part['broken']}" for name, part in parts.items() if "broken" in part]
        said.append(f"{target.removeprefix('test_')} {', '.join(words)}")
    return "; ".join(said) or "–"


HEAD = ["| platform | digests | other tests passed |", "|---|---|---|"]


def report(results):
    lines = list(HEAD)
    for cell in CELLS:
        result = results.get(cell.name)
        row = ("not run", "–") if result is None else (digests_of(result), others_of(result))
        lines.append(f"| {cell.what} | {row[0]} | {row[1]} |")
    return "\n".join(lines)


def write(results):
    page = ROOT / "docs" / "testing.md"
    text = page.read_text()
    begin = text.index("\n".join(HEAD))
    page.write_text(text[:begin] + report(results) + text[text.index("\n\n", begin):])


def chosen_by(words):
    named = [cell for cell in CELLS if not words or cell.name in words]
    return named or [cell for cell in CELLS if any(word in cell.name for word in words)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cells", nargs="*")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--modules", default=MODULES)
    parser.add_argument("--limit", type=int, default=900)
    parser.add_argument("--nice", type=int, default=15)
    for mode in ("--libraries", "--list", "--report", "--write", "--check"):
        parser.add_argument(mode, action="store_true")
    options = parser.parse_args()
    results = known_results()
    if options.report:
        return print(report(results))
    if options.write:
        return write(results)
    if options.check:
        return 0 if report(results) in (ROOT / "docs/testing.md").read_text() else 1
    chosen = chosen_by(options.cells)
    if not chosen:
        sys.exit("no cell has such a name: see --list")
    os.nice(options.nice)
    bad = False
    for cell in chosen:
        if reason := cell.missing():
            print(f"{cell.name}: left out: {reason}")
            continue
        if options.list:
            print(f"{cell.name}: {cell.what}")
            continue
        try_cell(cell, options, results)
        result = results[cell.name]
        if options.libraries:
            here = cell.build.relative_to(ROOT) / "prefix" if cell.host else "those of this system"
            print(f"{cell.name}: libraries: {result.get('broken', here)}", flush=True)
            bad = bad or "broken" in result
            continue
        print(f"{cell.name}: digests {digests_of(result)}; {others_of(result)}", flush=True)
        bad = bad or failed(result)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
