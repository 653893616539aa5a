#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks packaging/vcpkg, packaging/conan and C#'s project against the build, and that all packages tell the same of the project,
without vcpkg, Conan, .NET or a network.

packaging/check_recipes.py [--configure]

Both are run with stand-ins for the functions that they call. The version must be the project's, the dependencies those
that the build looks for, every option one that the project has and every path one that exists. --configure also runs
CMake with the port's options, with this system's libraries. Nothing is compiled. Exit status 1 where something is wrong.
"""
import collections
import importlib.util
import json
import re
import subprocess
import sys
import tempfile
import types
import xml.etree.ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PORT = ROOT / "packaging/vcpkg/crofton"
# What find_package calls them, and what both package managers do.
PACKAGES = {"glm": "glm", "hwy": "highway", "Qhull": "qhull"}
OF_SYSTEM = {"Threads", "PkgConfig"}
problems = []


def expect(right, what):
    if not right:
        problems.append(what)


def project():
    text = (ROOT / "CMakeLists.txt").read_text()
    options = set(re.findall(r"^(?:option|set)\((CROFTON_\w+)", text, re.M)) | {"BUILD_SHARED_LIBS"}
    return re.search(r"VERSION (\d+\.\d+\.\d+) LANGUAGES", text)[1], options


def needed():
    """The packages that the library's build and its users' builds look for."""
    build = (ROOT / "third_party/CMakeLists.txt").read_text().split("if(CROFTON_SAMPLES")[0]
    users = (ROOT / "cmake/crofton-config.cmake.in").read_text()
    found = set(re.findall(r"find_(?:package|dependency)\(([\w-]+)", build + users)) - OF_SYSTEM
    for name in found - set(PACKAGES):
        problems.append(f"{name} is looked for, and PACKAGES does not say what package managers call it")
    return {PACKAGES.get(name, name) for name in found}


STAND_INS = """
cmake_minimum_required(VERSION 3.24)
set(CURRENT_PACKAGES_DIR "{folder}/packages")
set(CURRENT_HOST_INSTALLED_DIR "{folder}/host")
set(FEATURES {features})
set(VCPKG_HOST_EXECUTABLE_SUFFIX "")
function(vcpkg_check_features)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUT_FEATURE_OPTIONS" "FEATURES")
    list(GET arg_FEATURES 0 feature)
    list(GET arg_FEATURES 1 variable)
    set(value OFF)
    if(feature IN_LIST FEATURES)
        set(value ON)
    endif()
    set(${{arg_OUT_FEATURE_OPTIONS}} "-D${{variable}}=${{value}}" PARENT_SCOPE)
endfunction()
function(vcpkg_cmake_configure)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE_PATH" "OPTIONS")
    message("SOURCE ${{arg_SOURCE_PATH}}")
    foreach(option IN LISTS arg_OPTIONS)
        message("OPTION ${{option}}")
    endforeach()
endfunction()
function(vcpkg_cmake_install)
endfunction()
function(vcpkg_fixup_pkgconfig)
endfunction()
function(vcpkg_cmake_config_fixup)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "CONFIG_PATH" "")
    message("CONFIG ${{arg_CONFIG_PATH}}")
endfunction()
function(vcpkg_install_copyright)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
    message("COPYRIGHT ${{arg_FILE_LIST}}")
endfunction()
include("{port}/portfile.cmake")
"""


def said_by_port(features, folder):
    script = Path(folder) / "port.cmake"
    script.write_text(STAND_INS.format(folder=folder, features=features, port=PORT))
    done = subprocess.run(["cmake", "-P", script], capture_output=True, text=True)
    expect(done.returncode == 0, f"portfile.cmake fails: {done.stderr.strip()}")
    said = [line.split(" ", 1) for line in done.stderr.splitlines() if " " in line]
    return {word: [rest for first, rest in said if first == word] for word in ("SOURCE", "OPTION", "CONFIG", "COPYRIGHT")}


def check_vcpkg(version, options, configure):
    port = json.loads((PORT / "vcpkg.json").read_text())
    expect(port["version"] == version, f"vcpkg.json says version {port['version']}, the project {version}")
    names = {entry if isinstance(entry, str) else entry["name"] for entry in port["dependencies"]}
    named = {name for name in names if not name.startswith("vcpkg-cmake")}
    expect(named == needed(), f"vcpkg.json depends on {sorted(named)}, the build on {sorted(needed())}")
    for features in ("core", "core;render"):
        with tempfile.TemporaryDirectory() as folder:
            said = said_by_port(features, folder)
        expect(said["SOURCE"] == [str(ROOT)], f"the port compiles {said['SOURCE']}")
        expect(said["CONFIG"] == ["lib/cmake/crofton"], f"the port takes CMake's files from {said['CONFIG']}")
        expect(all(Path(file).exists() for file in said["COPYRIGHT"]), f"the port's licence is not at {said['COPYRIGHT']}")
        given = dict(option[2:].split("=", 1) for option in said["OPTION"])
        for name in set(given) - options - {"CROFTON_GLSLANG"}:
            problems.append(f"portfile.cmake sets {name}, which the project does not have")
        expect(given.get("CROFTON_RENDER") == ("ON" if "render" in features else "OFF"), "the feature render switches nothing")
        if configure and features == "core":
            run_cmake(said["OPTION"])


def run_cmake(options):
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["cmake", "-S", ROOT, "-B", folder, *options], capture_output=True, text=True)
        expect(done.returncode == 0, f"CMake fails with the port's options: {done.stderr.strip()}")
        expect("not used by the project" not in done.stderr, f"CMake knows not all of the port's options: {done.stderr.strip()}")
        installs = Path(folder, "cmake_install.cmake")
        expect(installs.exists() and "lib/cmake/crofton" in installs.read_text().replace("lib/x86_64-linux-gnu", "lib"),
               "the port's options install no files for CMake")


class Recorder:
    """Stands in for CMakeToolchain, CMakeDeps and CMake."""
    made = []

    def __init__(self, recipe):
        self.cache_variables, self.properties, self.calls = {}, [], []
        Recorder.made.append(self)

    def set_property(self, *words):
        self.properties.append(words)

    def __getattr__(self, name):
        return lambda *_: self.calls.append(name)


def stand_in_modules(copied):
    class Invalid(Exception):
        pass

    modules = {
        "conan": {"ConanFile": object},
        "conan.errors": {"ConanInvalidConfiguration": Invalid},
        "conan.tools": {},
        "conan.tools.build": {"check_min_cppstd": lambda recipe, least: None},
        "conan.tools.cmake": {"CMake": Recorder, "CMakeDeps": Recorder, "CMakeToolchain": Recorder, "cmake_layout": lambda recipe: None},
        "conan.tools.files": {"copy": lambda recipe, pattern, source, to: copied.append((pattern, source)), "rmdir": lambda *_: None},
    }
    for name, content in modules.items():
        module = types.ModuleType(name)
        module.__dict__.update(content)
        sys.modules[name] = module


def load_recipe(copied):
    stand_in_modules(copied)
    sys.dont_write_bytecode = True
    spec = importlib.util.spec_from_file_location("crofton_conanfile", ROOT / "packaging/conan/conanfile.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.CroftonConan()


def check_conan(version, options):
    copied, required = [], []
    recipe = load_recipe(copied)
    expect(recipe.version == version, f"conanfile.py says version {recipe.version}, the project {version}")
    expect(set(recipe.options) == set(recipe.default_options), "conanfile.py: not every option has a default")
    recipe.options = types.SimpleNamespace(**recipe.default_options)
    recipe.settings = types.SimpleNamespace(os="Linux", arch="x86_64", compiler="gcc")
    recipe.recipe_folder, recipe.export_sources_folder = str(ROOT / "packaging/conan"), "/exported"
    recipe.source_folder = recipe.package_folder = "/nowhere"
    recipe.requires = lambda name, **_: required.append(name.split("/")[0])
    make_info = lambda: types.SimpleNamespace(set_property=lambda *_: None, defines=[], system_libs=[], requires=[])
    recipe.cpp_info = make_info()
    recipe.cpp_info.components = components = collections.defaultdict(make_info)
    for method in ("export_sources", "layout", "requirements", "validate", "generate", "build", "package", "package_info"):
        getattr(recipe, method)()
    expect(set(required) == needed(), f"conanfile.py requires {sorted(required)}, the build {sorted(needed())}")
    for pattern, source in copied:
        expect(source == "/nowhere" or any(Path(source).resolve().glob(pattern)), f"conanfile.py exports {pattern}: there is none")
    linked = {name.split("::")[0] for part in components.values() for name in part.requires if "::" in name}
    expect(linked == set(required), f"conanfile.py requires {sorted(required)}, its components link {sorted(linked)}")
    libraries = {"crofton", "crofton_bake", "crofton_study"}
    expect({name for part in components.values() for name in part.libs} == libraries, f"conanfile.py's components are not {sorted(libraries)}")
    given = {name for made in Recorder.made for name in made.cache_variables}
    for name in given - options:
        problems.append(f"conanfile.py sets {name}, which the project does not have")
    expect({"CROFTON_SAMPLES", "CROFTON_TESTS", "CROFTON_RENDER"} <= given, "conanfile.py builds more than the library")
    check_exports({pattern.split("/")[0] for pattern, source in copied if source != "/nowhere"})


def check_csharp(version):
    folder = ROOT / "bindings/csharp"
    project = xml.etree.ElementTree.parse(folder / "Crofton.csproj")
    expect(project.findtext(".//Version") == version, f"Crofton.csproj says version {project.findtext('.//Version')}, the project {version}")
    expect(all(any(folder.glob(part.get("Include"))) for part in project.iter("Compile")), "Crofton.csproj names files that are not there")


# Where each package's metadata tell its version and licence; some take the version from the build.
METADATA = {"bindings/web/package.json": (r'"version": "(.*)"', r'"license": "(.*)"'), "bindings/rust/Cargo.toml": (r'^version = "(.*)"', r'^license = "(.*)"'),
            "bindings/csharp/Crofton.csproj": (r"<Version>(.*)</Version>", r"<PackageLicenseExpression>(.*)<"),
            "bindings/python/setup.py": (None, r'license="(.*)"'), "packaging/make_nupkg.py": (None, None), "bindings/web/mkdocs.yml": (None, None),
            "packaging/vcpkg/crofton/vcpkg.json": (r'"version": "(.*)"', r'"license": "(.*)"'),
            "packaging/conan/conanfile.py": (r'^    version = "(.*)"', r'^    license = "(.*)"'), "packaging/debian/control": (None, None),
            "packaging/debian/changelog": (r"^crofton \((.*)\) ", None), "packaging/debian/copyright": (None, r"^License: (\w+)$")}


def check_metadata(version):
    build = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    description = re.search(r'DESCRIPTION "(.*)"', build)[1]
    for name, patterns in METADATA.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        for pattern, wanted in zip(patterns, (version, "MIT")):
            said = re.search(pattern, text, re.M) if pattern else None
            expect(not pattern or said and said[1] == wanted, f"{name} says {said and said[1]}, not {wanted}")
        if name not in ("packaging/debian/changelog", "packaging/debian/copyright"):
            expect(description.lower() in text.lower(), f"{name} does not describe the project as: {description}")
    done = subprocess.run([ROOT / "packaging/homepage.py"], capture_output=True, text=True)
    expect(done.returncode == 0, f"not all packages name the same page:\n{done.stdout}{done.stderr}")


def check_exports(exported):
    """What the build and the install rules of the library alone read must be exported."""
    rules = (ROOT / "cmake/CroftonInstall.cmake").read_text().split("if(TARGET crofton_cli)")
    text = rules[0] + rules[1].split("endif()", 1)[1]
    read = set(re.findall(r"\$\{PROJECT_SOURCE_DIR\}/([\w.]+)", text)) | {"cmake", "third_party", "engine", "CMakeLists.txt"}
    for name in sorted(read):
        expect(name in exported or (name.endswith(".md") and "*.md" in exported), f"conanfile.py does not export {name}")


def main():
    version, options = project()
    check_vcpkg(version, options, "--configure" in sys.argv[1:])
    check_conan(version, options)
    check_csharp(version)
    check_metadata(version)
    for problem in problems:
        print(f"check_recipes: {problem}", file=sys.stderr)
    return 1 if problems else print("check_recipes: the vcpkg port, the Conan recipe and C#'s project agree with the build, and all packages with each other")


if __name__ == "__main__":
    sys.exit(main())
