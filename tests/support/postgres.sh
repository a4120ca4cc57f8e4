#!/usr/bin/env bash
# A PostgreSQL server for tests, on a Unix socket in a folder and nowhere else.
#   tests/support/postgres.sh start FOLDER   makes it where it is not there, and waits until it answers
#   tests/support/postgres.sh kill FOLDER    kill -9; `start` brings it up again
#   tests/support/postgres.sh stop FOLDER    stops it and removes the folder
# Clients: postgres:///DATABASE?host=FOLDER&user=cognate. Exit code 77: PostgreSQL is not installed.
set -euo pipefail
verb=$1
folder=$2

bin=
for candidate in /usr/lib/postgresql/*/bin /usr/pgsql-*/bin /usr/local/pgsql/bin /usr/bin; do
  if [ -x "$candidate/initdb" ] && [ -x "$candidate/postgres" ]; then bin=$candidate; fi
done
if [ -z "$bin" ]; then
  echo "PostgreSQL is not installed" >&2
  exit 77
fi

# The server refuses to run as root.
as_user=()
if [ "$(id -u)" -eq 0 ]; then
  if ! id postgres >/dev/null 2>&1 || ! command -v runuser >/dev/null; then
    echo "there is no user postgres to run the server as" >&2
    exit 77
  fi
  as_user=(runuser -u postgres --)
fi

postmaster() { head -n 1 "$folder/data/postmaster.pid" 2>/dev/null || true; }

case $verb in
  start)
    if [ ! -d "$folder/data" ]; then
      mkdir -p "$folder"
      chmod 755 "$folder"
      if [ "$(id -u)" -eq 0 ]; then chown postgres "$folder"; fi
      "${as_user[@]}" "$bin/initdb" --pgdata="$folder/data" --username=cognate --auth=trust \
        --encoding=UTF8 >"$folder.log" 2>&1
    fi
    cd /
    for _ in $(seq 30); do
      # A session of its own: it outlives this script.
      setsid "${as_user[@]}" "$bin/postgres" -D "$folder/data" -k "$folder" -c listen_addresses= \
        -c shared_buffers=16MB -c max_connections=60 >>"$folder.log" 2>&1 </dev/null &
      while kill -0 $! 2>/dev/null; do
        if "$bin/pg_isready" -q -h "$folder"; then exit 0; fi
        sleep 0.1
      done
      # Refused: children of a killed server are not gone yet.
      sleep 0.2
    done
    echo "the server does not answer; its log:" >&2
    tail -n 20 "$folder.log" >&2
    exit 1
    ;;
  kill)
    pid=$(postmaster)
    kill -9 "$pid"
    while kill -0 "$pid" 2>/dev/null; do sleep 0.05; done
    ;;
  stop)
    pid=$(postmaster)
    if [ -n "$pid" ] && kill -INT "$pid" 2>/dev/null; then
      while kill -0 "$pid" 2>/dev/null; do sleep 0.05; done
    fi
    rm -rf "$folder" "$folder.log"
    ;;
  *)
    echo "usage: tests/support/postgres.sh start|kill|stop FOLDER" >&2
    exit 2
    ;;
esac
