//! Compiles ../../proto without protoc: protox to a descriptor set, that to Rust.

use prost::Message;
use std::path::PathBuf;

const FILES: [&str; 5] = [
    "problem.proto",
    "solution.proto",
    "path.proto",
    "client_api.proto",
    "worker_api.proto",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?).join("../../proto");
    println!("cargo::rerun-if-changed={}", folder.display());
    println!("cargo::rerun-if-changed=build.rs");
    let descriptors = protox::compile(FILES, [&folder])?;
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    std::fs::write(out.join("cognate.v1.bin"), descriptors.encode_to_vec())?;
    tonic_prost_build::configure()
        .bytes(".")
        .compile_fds(descriptors)?;
    Ok(())
}
