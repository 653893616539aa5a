#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes everything that a release publishes, from what is committed, with checksums; see packaging/README.md.
#   packaging/release.sh [FOLDER] [PART]...     FOLDER: build/release_VERSION; parts: source debian python web rust csharp site, or all
# The source parts are the same bytes for the same commit. Each part is installed and runs its first program before it counts.
set -euo pipefail
cd "$(dirname "$0")/.."
[[ -z $(git status --porcelain) ]] || { echo "release: commit or stash your changes: a release is of what is committed" >&2; exit 1; }
version=$(sed -n 's/^project(crofton VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
parts=(source debian python web rust csharp site)
folder=build/release_$version
if [[ $# -gt 0 && ! " ${parts[*]} " == *" $1 "* ]]; then folder=$1; shift; fi
[[ $# -eq 0 ]] || parts=("$@")
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
folder=$(realpath -m "$folder")
mkdir -p "$folder"
# The last line of a part that lacks a tool says so: then there is no release.
do_part() { "$@" 2>&1 | tee "$folder/.log" >&2; ! grep -q ": skipped, " "$folder/.log" || { echo "release: $1 was skipped" >&2; exit 1; }; }

for part in "${parts[@]}"; do
    printf '\n== %s\n' "$part" >&2
    case "$part" in
        source) git archive --format=tar --prefix="crofton-$version/" HEAD | gzip -n9 >"$folder/crofton-$version-source.tar.gz" ;;
        debian)
            do_part packaging/make_deb.sh build/deb
            cp build/deb/*.deb build/deb/*.dsc build/deb/*.tar.* "$folder/" ;;
        python)
            do_part bindings/python/test.sh
            cp bindings/python/dist/*.whl "$folder/"
            python3 packaging/make_sdist.py "$folder" ;;
        web)
            do_part bindings/web/test.sh simd
            (cd "$folder" && npm pack --silent "$OLDPWD/bindings/web") ;;
        rust)
            do_part bindings/rust/test.sh
            (cd bindings/rust && CARGO_TARGET_DIR=../../build/rust cargo package --offline --no-verify --allow-dirty --quiet)
            cp build/rust/package/*.crate "$folder/" ;;
        csharp)
            do_part bindings/csharp/test.sh
            python3 packaging/make_nupkg.py "$folder" ;;
        site)
            [[ -f bindings/web/wasm/simd.wasm ]] || python3 bindings/web/build.py simd
            python3 bindings/web/site.py --out build/site
            tar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner -C build -c site | gzip -n9 >"$folder/crofton-$version-site.tar.gz" ;;
        *) echo "release: no part is called $part; there are source debian python web rust csharp site" >&2; exit 2 ;;
    esac
done
rm -f "$folder/.log"
(cd "$folder" && sha256sum -- * >SHA256SUMS.new && grep -v SHA256SUMS SHA256SUMS.new >SHA256SUMS && rm SHA256SUMS.new && ls -sh)
# With nothing but what has been made, in blank folders.
packaging/test_release.py "$folder"
