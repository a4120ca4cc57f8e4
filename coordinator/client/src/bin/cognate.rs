//! The one command that people type: server, worker and client.
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    cognate_client::main()
}
