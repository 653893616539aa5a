#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes everything that a release publishes, from what is committed, with checksums; see packaging/README.md.
#   packaging/release.sh [FOLDER] [PART]...     FOLDER: build/release_VERSION; parts: source debian python rust csharp web site, or all
# Finished parts are kept: after an error, the same command at the same commit goes on with the part that failed.
# The source parts are the same bytes for the same commit. Each part is installed and runs its first program before it counts.
set -Eeuo pipefail
cd "$(dirname "$0")/.."
[[ -z $(git status --porcelain) ]] || { echo "release: commit or stash your changes: a release is of what is committed" >&2; exit 1; }
version=$(sed -n 's/^project(crofton VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
all_parts=(source debian python rust csharp web site)
folder=build/release_$version
if [[ $# -gt 0 && ! " ${all_parts[*]} " == *" $1 "* ]]; then folder=$1; shift; fi
parts=("$@")
[[ $# -gt 0 ]] || parts=("${all_parts[@]}")
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
folder=$(realpath -m "$folder")
commit=$(git rev-parse HEAD)
[[ ! -f $folder/.made/commit || $(<"$folder/.made/commit") == "$commit" ]] || rm -rf "$folder"
mkdir -p "$folder/.made" build/tmp
echo "$commit" >"$folder/.made/commit"

# The library is compiled once: Debian's packages, the wheel and the tests use the same flags, in build folders at the same place of
# their sources, and ccache, where it is installed, then has their objects. Rust and C# take the library of Debian's package.
export TMPDIR=$PWD/build/tmp LC_ALL=C.UTF-8  # debhelper's, which ccache looks at
if command -v ccache >/dev/null; then
    export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
    export CCACHE_DIR=${CCACHE_DIR:-$PWD/build/ccache} CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD/build} CCACHE_NOHASHDIR=1
fi
as_debian() { (eval "$(make -s -f packaging/debian/rules print_flags)" && CFLAGS="$CFLAGS $CPPFLAGS" CXXFLAGS="$CXXFLAGS $CPPFLAGS" "$@"); }
# The folder of Debian's shared libraries, for the languages that call them.
libraries() {
    ls "$folder"/libcrofton0_*.deb >/dev/null 2>&1 || { echo "release: $part needs the part debian: make it first" >&2; return 1; }
    for package in "$folder"/libcrofton{0,-dev}_*.deb; do dpkg-deb -x "$package" build/release_root; done
    dirname "$PWD"/build/release_root/usr/lib/*/libcrofton.so.0
}
# The last line of a part that lacks a tool says so: then there is no release.
complete() { "$@" 2>&1 | tee "$folder/.made/log" >&2; ! grep -q ": skipped, " "$folder/.made/log" || { echo "release: $1 was skipped" >&2; return 1; }; }

make_part() {
    case "$part" in
        source) git archive --format=tar --prefix="crofton-$version/" HEAD | gzip -n9 >"$folder/crofton-$version-source.tar.gz" ;;
        debian)
            complete packaging/make_deb.sh build/deb
            cp build/deb/*.deb build/deb/*.dsc build/deb/*.tar.* "$folder/" ;;
        python) # the wheel is built of the source package
            python3 packaging/make_sdist.py "$folder"
            rm -rf build/sdist && mkdir build/sdist
            tar xf "$folder/crofton-$version.tar.gz" -C build/sdist --strip-components=1
            as_debian complete bindings/python/test.sh build/sdist
            cp bindings/python/dist/*.whl "$folder/" ;;
        rust)
            CROFTON_LIB_DIR=$(libraries) complete bindings/rust/test.sh
            (cd bindings/rust && CARGO_TARGET_DIR=../../build/rust cargo package --offline --no-verify --allow-dirty --quiet)
            cp build/rust/package/*.crate "$folder/" ;;
        csharp)
            CROFTON_LIB_DIR=$(libraries) complete bindings/csharp/test.sh
            python3 packaging/make_nupkg.py "$folder" "$(libraries)" ;;
        web)
            complete bindings/web/test.sh simd
            (cd "$folder" && npm pack --silent "$OLDPWD/bindings/web") ;;
        site)
            [[ -f bindings/web/wasm/simd.wasm ]] || python3 bindings/web/build.py simd
            python3 bindings/web/site.py --out build/site
            tar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner -C build -c site | gzip -n9 >"$folder/crofton-$version-site.tar.gz" ;;
        *) echo "release: no part is called $part; there are ${all_parts[*]}" >&2; return 2 ;;
    esac
}

exec 3>&2
trap 'echo "release: ${part:-the test} failed; the same command goes on from here" >&3' ERR
TIMEFORMAT='%0R s by the clock, %0U + %0S s of processor'
for part in "${parts[@]}"; do
    if [[ -f $folder/.made/$part ]]; then
        printf '\n== %s is made already\n' "$part" >&2
        continue
    fi
    printf '\n== %s\n' "$part" >&2
    { time make_part 2>&3; } 2>"$folder/.made/time"
    mv "$folder/.made/time" "$folder/.made/$part"
done
part=
(cd "$folder" && sha256sum -- * >SHA256SUMS.new && grep -v SHA256SUMS SHA256SUMS.new >SHA256SUMS && rm SHA256SUMS.new && ls -sh)
for name in "${all_parts[@]}"; do
    [[ ! -f $folder/.made/$name ]] || echo "$name: $(<"$folder/.made/$name")"
done
# With nothing but what has been made, in blank folders.
as_debian packaging/test_release.py "$folder"
