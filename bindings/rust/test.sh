#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the shared library, then builds, tests and runs the crate. Says so and does nothing where there is no cargo.
set -euo pipefail
cd "$(dirname "$0")/../.."
source packaging/need_tools.sh
need_tools rust --rust cargo
cmake --preset shared >/dev/null
cmake --build --preset shared
export CROFTON_LIB_DIR=$PWD/build/shared/engine LD_LIBRARY_PATH=$PWD/build/shared/engine CARGO_TARGET_DIR=$PWD/build/rust
cd bindings/rust
cargo test --offline --quiet
cargo run --offline --quiet --example first_frame
