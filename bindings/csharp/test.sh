#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the shared library, or takes that in CROFTON_LIB_DIR, then builds and tests the classes and runs the example. Says so and
# does nothing where there is no Mono.
set -euo pipefail
cd "$(dirname "$0")/../.."
source packaging/need_tools.sh
need_tools csharp --csharp mcs mono
if [[ -z ${CROFTON_LIB_DIR:-} ]]; then
    cmake --preset shared >/dev/null
    cmake --build --preset shared
    CROFTON_LIB_DIR=$PWD/build/shared/engine
fi
out=$PWD/build/csharp
mkdir -p "$out"
compile() { mcs -nologo -warnaserror -debug "$@"; }
compile -target:library -out:"$out/Crofton.dll" bindings/csharp/src/*.cs
compile -r:"$out/Crofton.dll" -out:"$out/Tests.exe" bindings/csharp/tests/*.cs
compile -r:"$out/Crofton.dll" -out:"$out/FirstFrame.exe" bindings/csharp/example/FirstFrame.cs
sed -n '/^```csharp$/,/^```$/{/^```/d;p}' bindings/csharp/README.md >"$out/Readme.cs"
compile -r:"$out/Crofton.dll" -out:"$out/Readme.exe" "$out/Readme.cs"
export LD_LIBRARY_PATH=$CROFTON_LIB_DIR CROFTON_ROOT=$PWD
mono --debug "$out/Tests.exe"
mono "$out/FirstFrame.exe"
mono "$out/Readme.exe"
