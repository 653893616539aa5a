# SPDX-License-Identifier: MIT
"""Conan 2: compiles this checkout. packaging/conan/README.md says how to use it."""
import os

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, rmdir

required_conan_version = ">=2.0"


class CroftonConan(ConanFile):
    name = "crofton"
    version = "0.3.0"
    description = "Exact culling and collision detection for games"
    author = "The Crofton developers"
    license = "MIT"
    topics = ("culling", "collision-detection", "geometry", "games")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "statistics": [True, False], "portable": [True, False]}
    default_options = {"shared": False, "fPIC": True, "statistics": True, "portable": False}
    implements = ["auto_shared_fpic"]

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..")
        for pattern in ("CMakeLists.txt", "*.md", "LICENSE", "cmake/*", "engine/*", "third_party/*", "docs/*"):
            copy(self, pattern, root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def requirements(self):
        # Its headers are included by ours.
        self.requires("glm/0.9.9.8", transitive_headers=True)
        self.requires("highway/1.0.3")
        self.requires("qhull/8.0.2")

    def validate(self):
        check_min_cppstd(self, 20)
        if self.settings.os == "Windows" and self.settings.compiler == "msvc":
            raise ConanInvalidConfiguration("Visual C++ has not been tried: use g++ or clang")

    def generate(self):
        toolchain = CMakeToolchain(self)
        for name in ("RENDER", "SAMPLES", "TESTS"):
            toolchain.cache_variables[f"CROFTON_{name}"] = False
        toolchain.cache_variables["CROFTON_INSTALL"] = True
        toolchain.cache_variables["CROFTON_STATISTICS"] = bool(self.options.statistics)
        toolchain.cache_variables["CROFTON_PORTABLE"] = bool(self.options.portable)
        toolchain.generate()
        dependencies = CMakeDeps(self)
        # The names that our find_package uses.
        dependencies.set_property("highway", "cmake_file_name", "hwy")
        dependencies.set_property("highway", "cmake_target_name", "hwy::hwy")
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        # Conan writes its own for its users.
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "crofton")
        self.cpp_info.set_property("cmake_target_name", "crofton::all")
        outside = [f"{name}::{name}" for name in ("glm", "highway", "qhull")]
        for name, library, requires in (("crofton", "crofton", outside), ("bake", "crofton_bake", ["crofton"]), ("study", "crofton_study", ["bake"])):
            component = self.cpp_info.components[name]
            component.set_property("cmake_target_name", f"crofton::{name}")
            component.set_property("pkg_config_name", library.replace("_", "-"))
            component.libs, component.requires = [library], requires
        library = self.cpp_info.components["crofton"]
        if not self.options.statistics:
            library.defines.append("CROFTON_NO_STATISTICS=1")
        if self.settings.os in ("Linux", "FreeBSD"):
            library.system_libs.extend(["m", "pthread"])
        if "riscv" in str(self.settings.arch):
            library.system_libs.append("atomic")
