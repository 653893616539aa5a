#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Lines as witnesses beside the REJECT lumps of Debian's Freedoom: bench/reject_pvs.sh FOLDER [--lines N] [MAP01 …]
# Fetches the package into FOLDER, outside the repository, where it holds no level yet; nothing is installed.
# Needs build/bench/bin/bench_reject_pvs (cmake --preset bench).
set -euo pipefail
folder=${1:?usage: bench/reject_pvs.sh FOLDER [--lines N] [MAP01 …]}
shift
program=$(cd "$(dirname "$0")/.." && pwd)/build/bench/bin/bench_reject_pvs
mkdir -p "$folder"
cd "$folder"
if [ ! -f freedoom2.wad ]; then
    apt-get download freedoom
    dpkg -x freedoom_*.deb package
    cp package/usr/share/games/doom/freedoom2.wad .
fi
options=()
if [ "${1:-}" = --lines ]; then
    options=(--lines "$2")
    shift 2
fi
[ $# -gt 0 ] || set -- MAP01 MAP02 MAP04 MAP05 MAP06 MAP07 MAP21 MAP29 MAP30 MAP31
"$program" "${options[@]}" freedoom2.wad "$@"
