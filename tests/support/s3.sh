#!/usr/bin/env bash
# A server of S3 for tests, on loopback: s3s-fs, which keeps objects as files, so that they outlive it.
#   tests/support/s3.sh install         builds it where it is not there, and keeps it in the user's cache
#   tests/support/s3.sh start FOLDER    makes it where it is not there, and waits until it answers
#   tests/support/s3.sh kill FOLDER     kill -9; `start` brings it up again
#   tests/support/s3.sh stop FOLDER     stops it and removes the folder
# `start` takes the program COGNATE_S3_SERVER, s3s-fs on the PATH, or the one that `install` kept in the user's cache.
# FOLDER/environment has what clients need, as lines of NAME=VALUE. Exit code 77: it is not installed.
set -euo pipefail
verb=$1
folder=${2:-}
version=0.14.1
installed=${XDG_CACHE_HOME:-$HOME/.cache}/cognate/tools/s3s-fs-$version/bin/s3s-fs

program=${COGNATE_S3_SERVER:-$(command -v s3s-fs || echo "$installed")}
if [ "$verb" = start ] && [ ! -x "$program" ]; then
  echo "s3s-fs is not installed" >&2
  exit 77
fi

pid() { cat "$folder/pid" 2>/dev/null || true; }

end() {
  local signal=$1 of
  of=$(pid)
  if [ -n "$of" ] && kill "-$signal" "$of" 2>/dev/null; then
    while kill -0 "$of" 2>/dev/null; do sleep 0.05; done
  fi
  rm -f "$folder/pid"
}

# A server at this port, which may be another's.
serve() {
  local port=$1
  # shellcheck disable=SC1091
  . "$folder/keys"
  setsid "$program" --host 127.0.0.1 --port "$port" --access-key "$key" --secret-key "$secret" \
    "$folder/data" >>"$folder/log" 2>&1 </dev/null &
  local server=$!
  for _ in $(seq 100); do
    kill -0 "$server" 2>/dev/null || return 1
    if (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then
      sleep 0.1
      kill -0 "$server" 2>/dev/null || return 1
      echo "$server" >"$folder/pid"
      echo "$port" >"$folder/port"
      return 0
    fi
    sleep 0.1
  done
  return 1
}

case $verb in
  install)
    [ -x "$program" ] && exit 0
    cargo install --quiet --debug --locked s3s-fs --version "$version" --features binary \
      --root "$(dirname "$(dirname "$installed")")"
    ;;
  start)
    of=$(pid)
    if [ -n "$of" ] && kill -0 "$of" 2>/dev/null; then exit 0; fi
    mkdir -p "$folder/data/tests"
    if [ ! -f "$folder/keys" ]; then
      (umask 077 && printf 'key=%s\nsecret=%s\n' "$(cat /proc/sys/kernel/random/uuid)" \
        "$(cat /proc/sys/kernel/random/uuid)" >"$folder/keys")
    fi
    if [ -f "$folder/port" ]; then
      tries=("$(cat "$folder/port")")
    else
      mapfile -t tries < <(shuf -i 20000-29999 -n 20)
    fi
    for port in "${tries[@]}"; do
      serve "$port" || continue
      # shellcheck disable=SC1091
      . "$folder/keys"
      printf '%s\n' "AWS_ENDPOINT_URL=http://127.0.0.1:$port" "AWS_ACCESS_KEY_ID=$key" \
        "AWS_SECRET_ACCESS_KEY=$secret" AWS_REGION=us-east-1 COGNATE_TEST_S3_BUCKET=tests >"$folder/environment"
      exit 0
    done
    echo "the server does not answer; its log:" >&2
    tail -n 20 "$folder/log" >&2
    exit 1
    ;;
  kill) end KILL ;;
  stop)
    [ -d "$folder" ] || exit 0
    end INT
    rm -rf "$folder"
    ;;
  *)
    echo "usage: tests/support/s3.sh install|start|kill|stop [FOLDER]" >&2
    exit 2
    ;;
esac
