#!/usr/bin/env bash
# Builds the release into the folder OUT: a wheel, a static tarball, a Debian package, a container image, the sources
# that the LGPL requires, a list of all libraries (CycloneDX) with their licences, and checksums.
#   deploy/release.sh OUT                     for x86-64
#   deploy/release.sh OUT --target TRIPLE     for another Linux with musl: aarch64-unknown-linux-musl
#   deploy/release.sh OUT --program FILE      packs this program instead of building one
# The program is built once, static, for musl. This one file runs on every Linux, so all archives hold the same
# bytes. The same revision, Rust and tools (deploy/release/tools.txt) give the same archives in any folder.
# Needs Rust with rustup, git and Python 3.10 or newer with pip.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
say() { printf '\033[1m==>\033[0m %s\n' "$*" >&2; }
fail() { printf 'release: %s\n' "$*" >&2; exit 2; }

out='' target=x86_64-unknown-linux-musl program=''
while [ $# -gt 0 ]; do
  case $1 in
    --target) target=${2:?--target needs a triple}; shift 2 ;;
    --program) program=$(realpath "${2:?--program needs a file}"); shift 2 ;;
    -*) fail "unknown option $1: see the first lines of deploy/release.sh" ;;
    *) [ -z "$out" ] || fail "one folder, please: $out or $1"; out=$1; shift ;;
  esac
done
[ -n "$out" ] || fail "usage: deploy/release.sh OUT [--target TRIPLE] [--program FILE]"
case $target in
  x86_64-unknown-linux-musl | aarch64-unknown-linux-musl) ;;
  *) fail "no release is made for $target: x86_64-unknown-linux-musl or aarch64-unknown-linux-musl" ;;
esac
mkdir -p "$out"
out=$(realpath "$out")
cd "$root"
umask 022

# shellcheck source=deploy/packages.sh
. deploy/packages.sh
[ -x "$(command -v cargo)" ] || [ ! -x "$HOME/.cargo/bin/cargo" ] || PATH="$HOME/.cargo/bin:$PATH"
command -v cargo >/dev/null || fail "Rust is missing: see https://rustup.rs, then run this again"
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)} || fail "no clone: set SOURCE_DATE_EPOCH"
export SOURCE_DATE_EPOCH
[ -z "$(git status --porcelain --untracked-files=no)" ] ||
  say "files were changed since the last commit: the sources in $out are those of the commit"

# --- tools -------------------------------------------------------------------------------------------
missing=()
command -v cc >/dev/null || missing+=(gcc libc6-dev)
command -v make >/dev/null || missing+=(make)
command -v m4 >/dev/null || missing+=(m4)
python3 -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3 python3-venv)
[ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}" || fail "what the build needs is missing"
# CARGO_TARGET_DIR is not used, because names in the program contain the folder's place in the clone.
build=$root/target
tools=$build/release-tools
if ! cmp -s deploy/release/tools.txt "$tools/tools.txt"; then
  say "fetching a C compiler for every target"
  rm -rf "$tools"
  python3 -m venv "$tools/python"
  "$tools/python/bin/python" -m pip install --quiet --disable-pip-version-check --requirement deploy/release/tools.txt
  cp deploy/release/tools.txt "$tools/tools.txt"
fi
zig=$("$tools/python/bin/python" -c 'import os, ziglang; print(os.path.dirname(ziglang.__file__))')
libraries=$(rustc --print target-libdir --target "$target")
[ -d "$libraries" ] || rustup target add "$target"

# --- the program -------------------------------------------------------------------------------------
cargo_home=${CARGO_HOME:-$HOME/.cargo}
# Folders of this machine, and the names that replace them in the program.
places=("$cargo_home=/cargo" "$root=/cognate")
sources=$(rustc --print sysroot)/lib/rustlib/src/rust
[ ! -d "$sources" ] || places+=("$sources=/rustc/$(rustc -vV | sed -n 's/^commit-hash: //p')")
flags=(--cfg bundled_libraries "${places[@]/#/--remap-path-prefix=}")
# The environment variable separates its entries by the character 31.
rust_flags=$(IFS=$'\037'; printf %s "${flags[*]}")

if [ -z "$program" ]; then
  wrappers=$tools/$target
  mkdir -p "$wrappers"
  # zig spells targets in another way than the callers of a compiler.
  cat >"$wrappers/cc" <<END
#!/bin/sh
for argument; do
  shift
  case \$argument in --target=*) ;; *) set -- "\$@" "\$argument" ;; esac
done
exec '$zig/zig' cc -target ${target/-unknown/} -fno-sanitize=undefined "\$@" -g0$(printf " '-ffile-prefix-map=%s'" "${places[@]}")
END
  for tool in ar ranlib; do
    printf "#!/bin/sh\nexec '%s/zig' %s \"\$@\"\n" "$zig" "$tool" >"$wrappers/$tool"
  done
  chmod +x "$wrappers"/*
  say "building for $target (ten minutes the first time)"
  linker=CARGO_TARGET_$(printf %s "$target" | tr a-z- A-Z_)_LINKER
  # The build contains no date, and C is not compiled again for every commit.
  env -u RUSTFLAGS -u CFLAGS -u CXXFLAGS SOURCE_DATE_EPOCH=0 \
    CC="$wrappers/cc" AR="$wrappers/ar" RANLIB="$wrappers/ranlib" HOST_CC=cc GMP_MPFR_SYS_CACHE=_ \
    ZIG_GLOBAL_CACHE_DIR="$tools/cache" ZIG_LOCAL_CACHE_DIR="$tools/cache" \
    CARGO_ENCODED_RUSTFLAGS="$rust_flags" CARGO_TARGET_DIR="$build" "$linker=rust-lld" \
    cargo build --release --locked --target "$target" --package cognate-client --bin cognate
  program=$build/$target/release/cognate
fi

# --- what lies beside it -----------------------------------------------------------------------------
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
pages=()
if "$program" --version >/dev/null 2>&1; then
  share=$folder/pages
  mkdir -p "$share/man/man1" "$share/bash-completion/completions" "$share/zsh/vendor-completions" \
    "$share/fish/vendor_completions.d"
  "$program" man --output "$share/man/man1"
  "$program" completions bash >"$share/bash-completion/completions/cognate"
  "$program" completions zsh >"$share/zsh/vendor-completions/_cognate"
  "$program" completions fish >"$share/fish/vendor_completions.d/cognate.fish"
  pages=(--pages "$share")
else
  say "this machine cannot run the program: no manual pages and completions"
fi

say "packing"
env -u RUSTFLAGS CARGO_ENCODED_RUSTFLAGS="$rust_flags" \
  cargo metadata --format-version 1 --locked --filter-platform "$target" >"$folder/metadata.json"
"$tools/python/bin/python" deploy/release/pack.py "$out" --program "$program" --target "$target" \
  --metadata "$folder/metadata.json" --rust "$(rustc -vV | sed -n 's/^release: //p')" \
  --target-libraries "$libraries" --zig "$zig" "${pages[@]}"
say "in $out:"
(cd "$out" && wc -c ./* | sed 's,\./,,') >&2
