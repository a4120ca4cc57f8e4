# Finds the program for the scripts of this folder. They source this file with `root` set to the repository.
cognate=${COGNATE_PROGRAM:-$root/target/release/cognate}
[ -x "$cognate" ] || { echo "build it first: cargo build --release --bin cognate" >&2; exit 2; }
