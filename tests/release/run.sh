#!/usr/bin/env bash
# What deploy/release.sh makes, each installed where nothing else is, and solving problems there: the tarball and the
# container image in empty folders, the Debian package and the wheel in a fresh Debian.
#   tests/release/run.sh                  builds the release first, into target/release-files (ten minutes)
#   tests/release/run.sh OUT              tries the release in OUT
#   tests/release/run.sh OUT --again      builds the same revision in a clone elsewhere, too, and compares the bytes
# Needs root, since it changes the root folder. Exit code 77, with the reason: it cannot be done here.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Seconds that a recipe may take.
LONGEST=60

skip() {
  echo "skipped: the release: $*" >&2
  exit 77
}
fail() {
  echo "tests/release: $*" >&2
  exit 1
}
[ "$(id -u)" -eq 0 ] || skip "only root may change the root folder"
unshare --mount --pid --fork true 2>/dev/null || skip "no name spaces here"

out=${1:-}
again=${2:-}
if [ -z "$out" ]; then
  out=target/release-files
  rm -rf "$out"
  deploy/release.sh "$out"
fi
out=$(realpath "$out")
place=$(mktemp -d "${TMPDIR:-/tmp}/cognate-release-XXXXXX")
trap 'rm -rf "$place"' EXIT

# bare NAME: an empty root; it has /proc and /dev/null when something runs in it, and /tmp.
bare() {
  mkdir -p "$place/$1"/{dev,proc,tmp}
  touch "$place/$1/dev/null"
  chmod 1777 "$place/$1/tmp"
  echo "$place/$1"
}

# inside ROOT COMMAND...: runs it there, at most LONGEST seconds, without any environment.
inside() {
  # shellcheck disable=SC2016
  env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/tmp AS="${AS:-}" timeout "$LONGEST" unshare --mount --pid --fork --kill-child sh -c '
    root=$1; shift
    mount -t proc proc "$root/proc" && mount --bind /dev/null "$root/dev/null" && exec chroot $AS "$root" "$@"
  ' sh "$@"
}

# holds WHAT EXPRESSION: whether JSON on standard input, `answer` in Python, is as it must be.
holds() {
  python3 -c 'import json, sys; answer = json.load(sys.stdin); sys.exit(not eval(sys.argv[1]))' "$2" ||
    fail "$1: another answer than $2"
  echo "  $1"
}

# recipes ROOT PROGRAM EXAMPLES: four problems, of which the last takes two worker processes.
recipes() {
  local root=$1 program=$2 examples=$3 begin=$SECONDS
  inside "$root" "$program" solve -e "x^2 + y^2 = 5" -e "x*y = 2" --format json |
    holds "equations" 'answer["solutions"]["real"] == 4'
  if [ -n "$examples" ]; then
    inside "$root" "$program" mechanism inverse "$examples/arm_6r.json" --poses "$examples/arm_6r_poses.json" \
      --format json | holds "an arm" 'all(t["configurations"]["complex"] == 16 for t in answer["targets"])'
    inside "$root" "$program" solve "$examples/three_rpr.bertini" \
      --conjugates "p~P,t1~T1,t2~T2,t3~T3,g~G" --format json |
      holds "a platform" 'answer["solutions"]["real"] == 6'
    inside "$root" "$program" solve "$examples/katsura_10.bertini" --format json |
      holds "1024 paths" 'answer["solutions"]["distinct"] == 1024'
  fi
  echo "  $((SECONDS - begin)) s"
}

echo "checksums"
(cd "$out" && sha256sum --check --quiet SHA256SUMS)

echo "the tarball in an empty root"
root=$(bare tarball)
tar -xzf "$out"/cognate-*-x86_64-linux.tar.gz -C "$root"
top=$(basename "$root"/cognate-*)
AS='' recipes "$root" "/$top/cognate" "/$top/examples"

echo "the container image, as its user, with nothing else"
root=$(bare container)
mkdir "$place/image"
tar -xf "$out"/cognate-*-amd64.container.tar -C "$place/image"
python3 - "$place/image" <<'END' | tar -xz -C "$root"
import hashlib, json, pathlib, shutil, sys
image = pathlib.Path(sys.argv[1])
def blob(described):
    path = image / "blobs" / described["digest"].replace(":", "/")
    data = path.read_bytes()
    assert described["digest"] == "sha256:" + hashlib.sha256(data).hexdigest() and described["size"] == len(data)
    return data
(described,) = json.loads((image / "index.json").read_text())["manifests"]
manifest = json.loads(blob(described))
config = json.loads(blob(manifest["config"]))["config"]
assert config["Entrypoint"] == ["cognate"] and config["User"] == "10001" and config["Env"] == ["PATH=/usr/local/bin"]
(layer,) = manifest["layers"]
sys.stdout.buffer.write(blob(layer))
END
AS=--userspec=10001:10001 recipes "$root" /usr/local/bin/cognate ""

echo "a fresh Debian"
command -v debootstrap >/dev/null || skip "debootstrap is not installed: Debian package and wheel were not tried"
# shellcheck disable=SC1091
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-stable}")
# shellcheck disable=SC2016
mirror=$(apt-get indextargets --format '$(SITE) $(RELEASE)' | sed -n "s/ $suite\$//p" | sed -n 1p)
debian=$place/debian
debootstrap --variant=minbase --include=python3,python3-venv "$suite" "$debian" ${mirror:+"$mirror"} \
  >"$place/debootstrap.log" 2>&1 || skip "debootstrap cannot reach $mirror: Debian package and wheel were not tried"
rm -f "$debian/dev/null"
touch "$debian/dev/null"
export AS=''

echo "the wheel, in a new environment"
cp "$out"/cognate_solver-*.whl "$debian/tmp"
inside "$debian" python3 -m venv /venv
inside "$debian" sh -c '/venv/bin/python -m pip install --quiet --no-index --disable-pip-version-check /tmp/*.whl'
inside "$debian" /venv/bin/python -c '
import cognate, json
answer = cognate.solve(["x^2 + y^2 - 5", "x*y - 2"])
print(json.dumps({"distinct": answer.counts.distinct, "real": answer.counts.real, "settled": answer.settled}))
' | holds "import cognate" 'answer == {"distinct": 4, "real": 4, "settled": True}'
recipes "$debian" /venv/bin/cognate ""

echo "the Debian package"
cp "$out"/cognate_*_amd64.deb "$debian/tmp"
inside "$debian" sh -c 'dpkg --install /tmp/*.deb >/dev/null && dpkg --verify cognate'
recipes "$debian" cognate /usr/share/doc/cognate/examples
# minbase leaves manual pages in.
inside "$debian" sh -c 'test -s /usr/share/man/man1/cognate.1.gz && test -s /usr/share/bash-completion/completions/cognate'
inside "$debian" sh -c 'dpkg --purge cognate >/dev/null && ! command -v cognate' || fail "it does not go when it is purged"

if [ "$again" = --again ]; then
  echo "the same revision, built in another place"
  git clone --quiet . "$place/elsewhere/clone"
  "$place/elsewhere/clone/deploy/release.sh" "$place/again"
  diff -r "$out" "$place/again" || fail "the bytes differ"
fi
echo "the release is as it must be"
