//! The one command that people type: server, worker and client.
#![forbid(unsafe_code)]

/// The allocator of the static program; that of musl lets threads wait for one another.
#[cfg(target_env = "musl")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    cognate_client::main()
}
