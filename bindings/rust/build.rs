// SPDX-License-Identifier: MIT
//! Finds the shared library: in the folder CROFTON_LIB_DIR, or where pkg-config says.
use std::{env, process::Command};

fn main() {
    println!("cargo:rerun-if-env-changed=CROFTON_LIB_DIR");
    println!("cargo:rerun-if-env-changed=PKG_CONFIG_PATH");
    if let Ok(folder) = env::var("CROFTON_LIB_DIR") {
        link(&folder);
        return;
    }
    let answer = Command::new("pkg-config").args(["--variable=libdir", "crofton"]).output();
    let folder = match answer {
        Ok(out) if out.status.success() => String::from_utf8_lossy(&out.stdout).trim().to_owned(),
        _ => {
            eprintln!("crofton: the library was not found. Install it (cmake --install) and set PKG_CONFIG_PATH to");
            eprintln!("its lib/pkgconfig, or set CROFTON_LIB_DIR to the folder that holds libcrofton.so and libcrofton_bake.so.");
            std::process::exit(1);
        }
    };
    link(&folder);
}

fn link(folder: &str) {
    println!("cargo:rustc-link-search=native={folder}");
    println!("cargo:rustc-link-lib=dylib=crofton");
    println!("cargo:rustc-link-lib=dylib=crofton_bake");
    println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
}
