#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Compares the C API's functions and structs with those of the last release: check_abi.sh [--accept]
# A new function, and a new last member of a struct that begins with `size`, are compatible: accept them. Any other change breaks
# programs that are linked already: raise CROFTON_API_VERSION and SOVERSION with it.
set -euo pipefail
cd "$(dirname "$0")/.."
source packaging/need_tools.sh
need_tools check_abi --packages abidw abidiff
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# The types of all functions, in a library that holds nothing else.
{
    echo '#include <crofton/capi/crofton.h>'
    sed 's/.*/__typeof__(\&&) type_of_&;/' engine/capi/symbols.txt
} >"$folder/api.c"
gcc -std=gnu11 -g -shared -fPIC -Iengine/capi/include "$folder/api.c" -o "$folder/api.so"
if [[ ${1:-} == --accept ]]; then
    abidw --no-corpus-path --no-comp-dir-path --no-show-locs "$folder/api.so" >packaging/abi/c_api.xml
elif abidiff packaging/abi/c_api.xml "$folder/api.so"; then
    echo "check_abi: the C API is as it was"
else
    echo "check_abi: the C API has changed; packaging/README.md says what to do" >&2
    exit 1
fi
