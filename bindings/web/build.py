#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compiles the package's WebAssembly, bindings/web/wasm/simd.*, and a build without SIMD for the tests, plain.*.

bindings/web/build.py [simd] [plain] [--jobs J]

Builds lie in build/web. Qhull and Highway are compiled from Debian's source packages, as for the other platforms; the
Highway of the build with SIMD is Debian 13's, because that of Debian 12 has no doubles in its WebAssembly target.
`third_party/install.sh --web` installs the compiler.
"""
import argparse
import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/platforms"))
import run as platforms  # noqa: E402

WORK = ROOT / "build/web"
FLAGS = {"simd": "-msimd128", "plain": "-DHWY_COMPILE_ONLY_SCALAR"}
# Emscripten takes `-Os` for `-fno-inline-functions`, whatever level follows. Kernels need calls inlined: they would take
# three times as long.
OPTIMIZE, KERNELS = "-Os", "-O2;-finline-functions"
MODULES = ["core", "geometry", "measure", "mesh", "boxtree", "convex", "collide", "scene", "fit", "cull", "occlude", "depth",
           "triangulate", "world", "capi", "bake_capi"]
EXPORTED = """last_error status_name version_string set_log_hook log default_camera frustum_from_camera
frustum_from_matrix boxes_validate tree_create tree_destroy tree_move tree_remove tree_refit tree_view view_boxes classify
default_fit_options fit_points triangulator_create triangulator_destroy triangulate world_create world_destroy world_add_mesh
world_get_mesh world_find_occluders world_set_occluders world_add world_add_many world_reserve world_set_boxes world_remove world_set world_set_transforms
world_get_object world_get_statistics world_update default_world_options default_mesh_data
default_object_description default_occlusion_options default_view_matrix default_draw_limits default_picture_view
default_shadow_receivers default_view_request world_view world_raycast world_raycast_any world_raycast_all world_overlap
world_closest world_cast world_cast_all world_manifolds world_pairs world_contacts world_set_vertices world_remove_mesh world_add_node world_remove_node world_set_parent
world_set_node_layers world_set_node_transforms default_region_object default_region_options region_prepare region_destroy region_get_info region_mesh_of
region_clusters_of draw_limits_of_camera world_attach world_detach world_object_in world_place_of default_shape_description shape_create shape_destroy
clustered_mesh_create clustered_mesh_destroy clustered_mesh_serialise clustered_mesh_deserialise found_create found_destroy
found_objects found_hits found_shape_hits found_manifolds view_result_create view_result_destroy view_result_ids view_result_list view_result_get_view view_result_depth
view_result_occluders world_replace_mesh shape_get_info shape_get_mass shapes_meet shapes_distance shapes_penetration
shapes_manifold shapes_cast shape_closest_point shape_raycast clustered_mesh_get default_depth_object default_depth_receivers
depth_culler_create depth_culler_destroy depth_culler_find_visible depth_culler_find_casters depth_culler_nearness
web_error_item""".split()


def do(command, log, **more):
    with log.open("a") as file:
        print("$", *command, file=file, flush=True)
        if subprocess.run([str(c) for c in command], stdout=file, stderr=subprocess.STDOUT, env=platforms.ENVIRONMENT,
                          **more).returncode:
            sys.exit(f"web: `{command[0]}` failed, see {log}")


def fetch_sources(name, log):
    """The folder of highway/ and qhull/ to compile."""
    platforms.WORK.mkdir(parents=True, exist_ok=True)
    try:
        platforms.fetch_sources(log)
        return platforms.fetch_newer(log) if name == "simd" else platforms.SOURCES
    except platforms.Failed as failure:
        sys.exit(f"web: {failure}")


def dependencies_digest():
    """Of what says how the libraries are compiled."""
    files = [Path(__file__), ROOT / "tests/platforms/dependencies/CMakeLists.txt", *sorted((ROOT / "bindings/web/native").glob("qhull*"))]
    return hashlib.sha256(b"".join(f.read_bytes() for f in files)).hexdigest()


def build(name, jobs):
    folder = WORK / name
    folder.mkdir(parents=True, exist_ok=True)
    log, prefix = folder / "log.txt", folder / "prefix"
    log.unlink(missing_ok=True)
    flags = f"{FLAGS[name]} -fwasm-exceptions"
    options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_TOOLCHAIN_FILE={platforms.EMSCRIPTEN}",
               "-DEMSCRIPTEN_SYSTEM_PROCESSOR=wasm32", f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_FIND_ROOT_PATH={prefix}",
               "-DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY", f"-DCMAKE_MODULE_PATH={prefix}/lib/cmake/modules",
               f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags} -include {ROOT}/bindings/web/native/missing.hpp"]
    made = prefix / "made"
    if not made.exists() or made.read_text() != dependencies_digest():
        sources = fetch_sources(name, log)
        do(["cmake", "-S", ROOT / "tests/platforms/dependencies", "-B", folder / "dependencies", *options,
            f"-DCMAKE_INSTALL_PREFIX={prefix}", f"-DCROFTON_SOURCES={sources}", f"-DCROFTON_QUIET_QHULL={ROOT}/bindings/web/native",
            "-DCMAKE_C_FLAGS_RELEASE=-Os -DNDEBUG"], log)
        do(["cmake", "--build", folder / "dependencies", "-j", jobs, "--target", "install"], log)
        made.write_text(dependencies_digest())
    do(["cmake", "-S", ROOT, "-B", folder / "build", *options, f"-DCMAKE_CXX_FLAGS_RELEASE={OPTIMIZE} -DNDEBUG",
        f"-DCROFTON_KERNEL_OPTIONS={KERNELS}", "-DCROFTON_RENDER=OFF", "-DCROFTON_SAMPLES=OFF",
        "-DCROFTON_TESTS=OFF", "-DCROFTON_INSTALL=OFF"], log)
    targets = [f"crofton_{module}_objects" for module in MODULES]
    do(["ninja", "-C", folder / "build", f"-j{jobs}", "-k0", *targets], log)
    objects = sorted(p for target in targets for p in (folder / "build/engine").rglob(f"{target}.dir/**/*.o"))
    out = ROOT / "bindings/web/wasm"
    out.mkdir(exist_ok=True)
    names = ",".join(["_malloc", "_free", *(f"_crofton_{name}" for name in EXPORTED)])
    do(["emcc", "-O2", *flags.split(), f"-I{ROOT}/engine/c_api/include", f"-I{ROOT}/engine/bake/c_api/include", ROOT / "bindings/web/native/glue.c", *objects,
        f"-L{prefix}/lib", "-lqhull_r", "-lhwy", "-sMODULARIZE=1", "-sEXPORT_ES6=1", "-sENVIRONMENT=web", "-sFILESYSTEM=0",
        "-sALLOW_MEMORY_GROWTH=1", "-sMAXIMUM_MEMORY=2147483648", "-sINITIAL_MEMORY=16777216", "-sTOTAL_STACK=1048576",
        "-sALLOW_TABLE_GROWTH=1", "-sWASM_BIGINT=1", "-sEXPORTED_RUNTIME_METHODS=addFunction,removeFunction,HEAPU8",
        "-sBINARYEN_EXTRA_PASSES=-Os",  # After -O2: the package is 1 % smaller.
        f"-sEXPORTED_FUNCTIONS={names}", "--no-entry", "-o", out / f"{name}.js"], log)

    # Its bytes are given to it: webpack would look for a file that the package has not.
    script = out / f"{name}.js"
    text, found = re.subn(r'new URL\("\w+\.wasm", ?import\.meta\.url\)\.(toString\(\)|href)', f'"{name}.wasm"', script.read_text())
    if found != 1:
        sys.exit(f"web: {script} names its file in another way than Emscripten 3.1.6 does")
    script.write_text(text)
    # The package has them within JavaScript.
    if name == "simd":
        shutil.copy(ROOT / "LICENSE", ROOT / "bindings/web/LICENSE")
        text = base64.b64encode(zlib.compress((out / "simd.wasm").read_bytes(), 9)).decode()
        (out / "simd.base64.js").write_text(f"export default '{text}';\n")

    # The digests of bindings/web/native/digests.cpp, for node (tests alone: not in the package).
    includes = [f"-I{p}" for kind in ("include", "internal") for p in sorted((ROOT / "engine").glob(f"**/{kind}"))]
    do(["ninja", "-C", folder / "build", f"-j{jobs}", "crofton_sampling_objects"], log)
    more = sorted((folder / "build/engine").rglob("crofton_sampling_objects.dir/**/*.o"))
    do(["em++", "-O2", "-std=c++20", *flags.split(), "-include", ROOT / "bindings/web/native/missing.hpp", *includes,
        f"-isystem{prefix}/include", ROOT / "bindings/web/native/digests.cpp", *more, *objects, f"-L{prefix}/lib", "-lqhull_r",
        "-lhwy", "-sALLOW_MEMORY_GROWTH=1", "-sTOTAL_STACK=1048576", "-sEXIT_RUNTIME=1", "-o", folder / "digests.js"], log)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=list(FLAGS))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    for tool in ("emcc", "node", "cmake", "ninja"):
        if not shutil.which(tool):
            sys.exit(f"web: {tool} is not here; third_party/install.sh --web installs it")
    for name in options.names:
        build(name, str(options.jobs))


if __name__ == "__main__":
    main()
