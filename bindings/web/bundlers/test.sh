#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Packs the npm package, installs it with every bundler into a blank project below build/web, and runs test.mjs there. Says so
# and does nothing where a tool or the network is missing. Needs the build with SIMD: bindings/web/build.py simd
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
for tool in node npm; do
    command -v "$tool" >/dev/null || { echo "bundlers: skipped, no $tool here"; exit 0; }
done
[[ -f $root/bindings/web/wasm/simd.base64.js ]] || { echo "bundlers: the package is not built: bindings/web/build.py simd" >&2; exit 1; }
project=$root/build/web/bundlers
mkdir -p "$project"
cp "$here/package.json" "$project/"
cd "$project"
tarball=$(npm pack --silent "$root/bindings/web")
npm install --ignore-scripts --no-audit --no-fund --no-package-lock --no-save --silent "./$tarball" ||
    { echo "bundlers: skipped, npm could not install the bundlers"; exit 0; }
node --test "$here/test.mjs"
