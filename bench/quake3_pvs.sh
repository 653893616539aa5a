#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Lines as witnesses beside the visible sets in the levels of Debian's OpenArena: bench/quake3_pvs.sh FOLDER [--lines N]
# Fetches the package into FOLDER, outside the repository, where it holds no levels yet; nothing is installed.
# Needs build/bench/bin/bench_quake3_pvs (cmake --preset bench) and python3.
set -euo pipefail
folder=${1:?usage: bench/quake3_pvs.sh FOLDER [--lines N]}
shift
program=$(cd "$(dirname "$0")/.." && pwd)/build/bench/bin/bench_quake3_pvs
mkdir -p "$folder"
cd "$folder"
if ! compgen -G '*.bsp' >/dev/null; then
    apt-get download openarena-081-maps
    dpkg -x openarena-081-maps_*.deb package
    python3 - <<'PYTHON'
import pathlib
import zipfile
for archive in pathlib.Path("package").rglob("*.pk3"):
    with zipfile.ZipFile(archive) as files:
        for entry in files.infolist():
            if entry.filename.endswith(".bsp"):
                pathlib.Path(pathlib.PurePosixPath(entry.filename).name).write_bytes(files.read(entry))
PYTHON
fi
"$program" "$@" ./*.bsp
