#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the package, tests it in node, runs the README's program and checks its types. Says so and does nothing where a
# tool is missing.
#   bindings/web/test.sh [simd] [plain]    which builds; both unless told
set -euo pipefail
cd "$(dirname "$0")/../.."
for tool in emcc node cmake ninja; do
    if ! command -v "$tool" >/dev/null; then
        echo "web: skipped, no $tool here; third_party/install.sh --web installs it"
        exit 0
    fi
done
builds=("$@")
[[ ${#builds[@]} -gt 0 ]] || builds=(simd plain)
python3 bindings/web/build.py "${builds[@]}"
CROFTON_BUILDS=$(IFS=,; echo "${builds[*]}") node --expose-gc --test bindings/web/test/
# The README's program, with the package where npm would put it. It takes the build with SIMD.
[[ " ${builds[*]} " == *" simd "* ]] || exit 0
mkdir -p build/web/readme/node_modules
ln -sfn "$PWD/bindings/web" build/web/readme/node_modules/crofton
sed -n '/^```js$/,/^```$/{/^```/d;p}' bindings/web/README.md >build/web/readme/readme.mjs
node build/web/readme/readme.mjs
# The same program as TypeScript sees it.
if command -v tsc >/dev/null; then
    cp build/web/readme/readme.mjs build/web/readme/readme.mts
    tsc --noEmit --strict --target es2022 --module nodenext --moduleResolution nodenext build/web/readme/readme.mts
else
    echo "web: types are not checked, no tsc here; third_party/install.sh --web installs it"
fi
bindings/web/bundlers/test.sh
