#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the shared library, or takes that in CROFTON_LIB_DIR, then builds, tests and runs the crate. Says so and does nothing
# where there is no cargo.
set -euo pipefail
cd "$(dirname "$0")/../.."
source packaging/need_tools.sh
need_tools rust --rust cargo
if [[ -z ${CROFTON_LIB_DIR:-} ]]; then
    cmake --preset shared >/dev/null
    cmake --build --preset shared
    CROFTON_LIB_DIR=$PWD/build/shared/engine
fi
export CROFTON_LIB_DIR LD_LIBRARY_PATH=$CROFTON_LIB_DIR CARGO_TARGET_DIR=$PWD/build/rust
cd bindings/rust
cargo test --offline --quiet
cargo run --offline --quiet --example first_frame
