#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Installs each product of a release into a blank folder, runs its first program, and prints a table with the times.

packaging/test_release.py FOLDER [source] [debian] [wheel] [sdist] [npm] [crate] [nuget]

FOLDER is what packaging/release.sh made. A product that is not there, or whose tool is not here, is named in the table and is
a failure only where it was asked for by name. The first programs are those of the READMEs. The wheel and the NuGet
package must not use a library of the system that they bring themselves. Exit status 1 where a program fails.
"""
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BROUGHT = r"lib(hwy|qhull|draco|meshoptimizer|stb)"  # what the packages bring


class Missing(Exception):
    pass


def tool(name):
    if not shutil.which(name):
        raise Missing(f"{name} is not here")
    return name


def program_of(readme, language):
    """The first program of a README in a language."""
    return re.search(rf"^```{language}\n(.*?)^```", (ROOT / readme).read_text(encoding="utf-8"), re.M | re.S)[1]


def run(command, folder, **environment):
    """Runs a shell command; the lines that it printed."""
    done = subprocess.run(command, shell=True, cwd=folder, env={**os.environ, **environment}, text=True, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, executable="/bin/bash")
    if done.returncode != 0:
        raise RuntimeError(f"{command}: status {done.returncode}\n{done.stdout[-3000:]}")
    return done.stdout.strip().splitlines()


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Steps:
    """What a user types, one after another."""

    def __init__(self, folder):
        self.folder, self.commands, self.output = folder, [], []
        self.seconds = self.processor = 0.0

    def type(self, command, shown=None, **environment):
        start, used = time.monotonic(), processor_time()
        self.output = run(command, self.folder, **environment)
        self.seconds += time.monotonic() - start
        self.processor += processor_time() - used
        self.commands.append(shown or command)


def wheel(product, steps):
    (steps.folder / "first.py").write_text(program_of("bindings/python/README.md", "python"))
    # NumPy is the system's, so that nothing is downloaded.
    steps.type("/usr/bin/python3 -m venv --system-site-packages here")
    steps.type(f"here/bin/pip install --quiet --no-index {product}", "pip install crofton-*.whl")
    steps.type("here/bin/python first.py", "python first.py")
    check = ("import crofton, re; maps = open('/proc/self/maps').read(); "
             f"print([p for p in re.findall(r'/\\S+', maps) if re.search(r'/{BROUGHT}', p) and 'here/' not in p])")
    if (outside := run(f'here/bin/python -c "{check}"', steps.folder)) != ["[]"]:
        raise RuntimeError(f"the wheel uses libraries of the system: {outside}")


def sdist(product, steps):
    (steps.folder / "first.py").write_text(program_of("bindings/python/README.md", "python"))
    steps.type("/usr/bin/python3 -m venv --system-site-packages here")
    steps.type(f"here/bin/pip install --quiet --no-index --no-build-isolation {product}", "pip install crofton-*.tar.gz")
    steps.type("here/bin/python first.py", "python first.py")


def npm(product, steps):
    tool("npm")
    (steps.folder / "package.json").write_text('{ "name": "blank", "private": true }\n')
    (steps.folder / "first.mjs").write_text(program_of("bindings/web/README.md", "js"))
    steps.type(f"npm install --silent --no-audit --no-fund --offline {product}", "npm install crofton-*.tgz")
    steps.type("node first.mjs")


def native_library(steps):
    """The folder of libcrofton.so, out of the NuGet package, which needs nothing else."""
    (package,) = FOLDER.glob("Crofton.*.nupkg")
    run(f"unzip -q {package} -d native", steps.folder)
    return steps.folder / "native/runtimes/linux-x64/native"


def crate(product, steps):
    tool("cargo")
    run(f"tar xf {product} && mv crofton-*/ crofton", steps.folder)
    library = native_library(steps)
    (steps.folder / "src").mkdir()
    (steps.folder / "Cargo.toml").write_text('[package]\nname = "first"\nversion = "0.1.0"\nedition = "2021"\n\n'
                                             '[dependencies]\ncrofton = { path = "crofton" }\n')
    (steps.folder / "src/main.rs").write_text(program_of("bindings/rust/README.md", "rust"))
    steps.type("cargo run --offline --quiet", "cargo run", CROFTON_LIB_DIR=str(library), LD_LIBRARY_PATH=str(library))


def nuget(product, steps):
    tool("mcs")
    run(f"unzip -q {product} -d package && cp package/lib/netstandard2.0/Crofton.dll .", steps.folder)
    (steps.folder / "First.cs").write_text(program_of("bindings/csharp/README.md", "csharp"))
    libraries = steps.folder / "package/runtimes/linux-x64/native"
    steps.type("mcs -nologo -r:Crofton.dll First.cs")
    steps.type("mono First.exe", LD_LIBRARY_PATH=str(libraries))
    needed = run(f"ldd {libraries}/libcrofton.so", steps.folder, LD_LIBRARY_PATH="")
    if outside := [line for line in needed if re.search(BROUGHT, line) and str(libraries) not in line]:
        raise RuntimeError(f"the package uses libraries of the system: {outside}")


def debian(product, steps):
    tool("dpkg-deb")
    packages = " ".join(str(p) for p in sorted(FOLDER.glob("*.deb")) if "dbgsym" not in p.name)
    steps.type(f"for p in {packages}; do dpkg-deb -x $p root; done", "apt install ./libcrofton*.deb ./crofton-tools*.deb")
    libraries = next(steps.folder.glob("root/usr/lib/*/libcrofton.so.0")).parent
    pages = list(steps.folder.glob("root/usr/share/man/man1/crofton*.1.gz"))
    if not pages:
        raise RuntimeError("there are no manual pages")
    steps.type("root/usr/bin/crofton study measure room --lines 1000", "crofton study measure room", LD_LIBRARY_PATH=str(libraries))


def source(product, steps):
    tool("cmake")
    run(f"tar xf {product} --strip-components=1", steps.folder)
    steps.type("cmake --preset release -DCROFTON_TESTS=OFF -DCROFTON_RENDER=OFF -DCROFTON_WERROR=OFF >configure.txt", "cmake --preset release")
    steps.type("cmake --build --preset release --target hello_world >build.txt", "cmake --build --preset release")
    steps.type("build/release/bin/hello_world")


PRODUCTS = {"source": ("crofton-*-source.tar.gz", source), "debian": ("crofton-tools_*.deb", debian),
            "wheel": ("crofton-*.whl", wheel), "sdist": ("crofton-[0-9.]*[0-9].tar.gz", sdist), "npm": ("crofton-*.tgz", npm),
            "crate": ("crofton-*.crate", crate), "nuget": ("Crofton.*.nupkg", nuget)}


def size_of(path):
    return f"{path.stat().st_size / 1e3:,.0f} kB"


def attempt(name):
    """A row of the table, and whether all went well."""
    pattern, install = PRODUCTS[name]
    found = sorted(FOLDER.glob(pattern))
    if not found:
        return f"| {name} | not there | | | | |", False
    with tempfile.TemporaryDirectory() as folder:
        steps = Steps(pathlib.Path(folder))
        try:
            install(found[-1], steps)
        except Missing as missing:
            return f"| {name} | {size_of(found[-1])} | not tried: {missing} | | | |", False
        except RuntimeError as error:
            print(error, file=sys.stderr)
            return f"| {name} | {size_of(found[-1])} | **failed** | | | |", None
        shown = ", ".join(f"`{command}`" for command in steps.commands)
        return f"| {name} | {size_of(found[-1])} | {shown} | {steps.seconds:.1f} s | {steps.processor:.1f} s | `{(steps.output or [''])[-1][:60]}` |", True


def main():
    named = sys.argv[2:]
    if unknown := [name for name in named if name not in PRODUCTS]:
        sys.exit(f"test_release: {', '.join(unknown)}: not one of {', '.join(PRODUCTS)}")
    failed = False
    print("| product | size | commands | from nothing to a first result | processor | it says |\n|---|---|---|---|---|---|", flush=True)
    for name in named or PRODUCTS:
        row, well = attempt(name)
        print(row, flush=True)
        failed |= well is None or (not well and name in named)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    FOLDER = pathlib.Path(sys.argv[1]).resolve()
    main()
