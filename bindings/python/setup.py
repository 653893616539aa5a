# SPDX-License-Identifier: MIT
"""Builds the wheel: configures and builds the library by CMake, and packs its extension module."""
import os
import pathlib
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

here = pathlib.Path(__file__).resolve().parent
root = here / "source" if (here / "source").is_dir() else here.parents[1]  # of an sdist, or of a checkout


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        build = root / "build" / f"wheel-{sys.implementation.cache_tag}"
        options = ["PYTHON=ON", "RENDER=OFF", "SAMPLES=OFF", "TESTS=OFF", "BENCH=OFF", "INSTALL=OFF"]
        subprocess.check_call(
            ["cmake", "-S", str(root), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
             f"-DPython_EXECUTABLE={sys.executable}"] + [f"-DCROFTON_{option}" for option in options]
        )
        subprocess.check_call(["cmake", "--build", str(build), "--target", "crofton_python", "-j", str(os.cpu_count())])
        (module,) = (build / "bindings" / "python" / "crofton").glob("_crofton*")
        target.parent.mkdir(parents=True, exist_ok=True)
        self.copy_file(str(module), str(target))


version = re.search(r"project\(crofton VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text()).group(1)
setup(
    name="crofton",
    version=version,
    description="Exact culling and collision detection for games",
    author="The Crofton developers",
    long_description=(here / "README.md").read_text(),
    long_description_content_type="text/markdown",
    license="MIT",
    python_requires=">=3.9",
    install_requires=["numpy>=1.20"],
    packages=["crofton"],
    package_data={"crofton": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("crofton._crofton", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
)
