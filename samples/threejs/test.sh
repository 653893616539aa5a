#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs three.js here and tests the sample in a headless Chromium; says so and does nothing where a tool is missing.
set -euo pipefail
cd "$(dirname "$0")"
for tool in node npm; do
    command -v "$tool" >/dev/null || { echo "threejs: skipped, no $tool here"; exit 0; }
done
[[ $(node -p "require('three/package.json').version" 2>/dev/null) == $(node -p "require('./package.json').dependencies.three") ]] || npm install --ignore-scripts --no-audit --no-fund --no-package-lock || { echo "threejs: skipped, npm could not install three.js"; exit 0; }
node test.mjs
