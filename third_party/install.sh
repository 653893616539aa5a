#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the Debian packages that Crofton needs and this machine lacks; says nothing when there are none.
#   third_party/install.sh            what building, running and testing need
#   third_party/install.sh --tests    also a browser, in which the tests open the report page
#   third_party/install.sh --bench    also the benchmarks' framework and the peers measured beside us
#   third_party/install.sh --checks   also clang, its formatter and its linter, and gdb, for .ci/run and .ci/long
#   third_party/install.sh --matrix   also all compilers of .ci/matrix (docs/testing.md, "The matrix")
#   third_party/install.sh --python   also what the Python package needs (bindings/python/README.md)
#   third_party/install.sh --rust     also what the Rust crate needs (bindings/rust/README.md)
#   third_party/install.sh --csharp   also what the C# classes need (bindings/csharp/README.md)
#   third_party/install.sh --web      also what the npm package needs (bindings/web/README.md)
#   third_party/install.sh --packages also what makes and checks packages (packaging/README.md)
#   third_party/install.sh --slurm    also the job system of samples/slurm, whose test starts a cluster on this machine
#   third_party/install.sh --platforms  also compilers and emulators of other targets (docs/testing.md, "Platforms")
#   third_party/install.sh --engines  also the engines, job system and documentation tool that samples and tests use where installed
set -euo pipefail

packages=(
    # build
    g++ cmake ninja-build pkg-config glslang-tools
    # engine
    libglm-dev libhwy-dev libqhull-dev
    # render: loader, headers, lavapipe, validation
    libvulkan-dev libvulkan-volk-dev mesa-vulkan-drivers vulkan-validationlayers
    # samples
    libglfw3-dev libimgui-dev libstb-dev nlohmann-json3-dev libcli11-dev
    # samples: decoders of compressed glTF
    libdraco-dev libmeshoptimizer-dev
    # tests
    doctest-dev libgmp-dev xvfb xauth xdotool libx11-dev
)
test_packages=(chromium)
check_packages=(clang libclang-rt-dev clang-format clang-tidy llvm gdb)
matrix_packages=(clang llvm libclang-rt-dev clang-19 llvm-19 libclang-rt-19-dev)
engine_packages=(libogre-1.12-dev libopenscenegraph-dev libbullet-dev libtbb-dev doxygen)
python_packages=(python3-dev python3-numpy python3-pytest python3-setuptools python3-wheel python3-pip python3-venv pybind11-dev patchelf)
rust_packages=(cargo)
csharp_packages=(mono-mcs mono-runtime libmono-system-core4.0-cil)
web_packages=(emscripten nodejs node-typescript dpkg-dev chromium doxygen doxygen-awesome-css mkdocs mkdocs-material)
packaging_packages=(ccache debhelper debootstrap dpkg-dev help2man lintian abigail-tools unzip)
slurm_packages=(slurm-wlm munge)
platform_packages=(m4 clang libc++-14-dev libc++abi-14-dev g++-i686-linux-gnu g++-riscv64-linux-gnu g++-aarch64-linux-gnu qemu-user
    g++-mingw-w64-x86-64-posix wine64 wine emscripten nodejs dpkg-dev make)
bench_packages=(libbenchmark-dev libcgal-dev libfcl-dev libbullet-dev libembree-dev libode-dev)

for argument in "$@"; do
    case "$argument" in
        --tests) packages+=("${test_packages[@]}") ;;
        --bench) packages+=("${bench_packages[@]}") ;;
        --checks) packages+=("${check_packages[@]}") ;;
        --matrix) packages+=("${matrix_packages[@]}") ;;
        --python) packages+=("${python_packages[@]}") ;;
        --rust) packages+=("${rust_packages[@]}") ;;
        --csharp) packages+=("${csharp_packages[@]}") ;;
        --web) packages+=("${web_packages[@]}") ;;
        --packages) packages+=("${packaging_packages[@]}") ;;
        --slurm) packages+=("${slurm_packages[@]}") ;;
        --platforms) packages+=("${platform_packages[@]}") ;;
        --engines) packages+=("${engine_packages[@]}") ;;
        *) echo "usage: third_party/install.sh [--tests] [--checks] [--bench] [--matrix] [--python] [--rust] [--csharp] [--web] [--packages] [--slurm] [--platforms] [--engines]" >&2; exit 2 ;;
    esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "third_party/install.sh: apt-get is not here, so nothing was installed. Install these (Debian's names) yourself:" >&2
    echo "  ${packages[*]}" >&2
    exit 0
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
    [[ $status == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
        echo "third_party/install.sh: not root and no sudo. Please run as root: apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
echo "Installing ${#missing[@]} packages: ${missing[*]}" >&2
log=$(mktemp)
trap 'rm -f "$log"' EXIT
install() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}" >"$log" 2>&1
}
# Package lists may be absent or stale: refresh them once, and only if needed.
if ! install; then
    if ! { "${as_root[@]}" apt-get update >>"$log" 2>&1 && install; }; then
        echo "third_party/install.sh: apt-get failed:" >&2
        tail -n 20 "$log" >&2
        exit 1
    fi
fi
