# The program that the scripts beside this use; they read this file with `root` set to the repository.
cognate=${COGNATE_PROGRAM:-$root/target/release/cognate}
[ -x "$cognate" ] || { echo "build it first: cargo build --release --bin cognate" >&2; exit 2; }
