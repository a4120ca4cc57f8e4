#!/usr/bin/env bash
# Every four-bar linkage through each of many random sets of nine points, with proofs and open questions.
#
#   deploy/families/sweep.sh FOLDER [SETS [SEED]]
#
# FOLDER gets the sets (sets.csv: coordinates between -1 and 1, of a generator that is the same everywhere),
# the answers as they arrive (answers.jsonl), and the counts of all answers. The script also prints the counts.
set -euo pipefail

folder=${1:?a folder is expected: sweep.sh FOLDER [SETS [SEED]]}
sets=${2:-100}
seed=${3:-1}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/deploy/families/program.sh"
mkdir -p "$folder"

# Lehmer's generator with Park and Miller's modulus: products below 2^53, exact in any awk.
awk -v sets="$sets" -v seed="$seed" 'BEGIN {
  modulus = 2147483647
  state = 48271 * seed % modulus
  for (k = 1; k <= 9; k++) printf "%sx%d,y%d", (k > 1 ? "," : ""), k, k
  print ""
  for (set = 0; set < sets; set++) {
    for (k = 0; k < 18; k++) {
      state = 48271 * state % modulus
      printf "%s%.6f", (k ? "," : ""), 2 * state / modulus - 1
    }
    print ""
  }
}' >"$folder/sets.csv"

status=0
"$cognate" synthesize nine-point --targets "$folder/sets.csv" --certify --format json \
  >"$folder/answers.jsonl" 2>"$folder/progress.log" || status=$?
tail -n 1 "$folder/progress.log"

# One object of each line holds the counts of the classes.
sed 's/.*"classes":{\([^}]*\)}.*/\1/' "$folder/answers.jsonl" | tr ',' '\n' | awk -F: '
  $1 != "\"group_order\"" { gsub(/"/, "", $1); total[$1] += $2 }
  $1 == "complete" && $2 == 1442 { whole++ }
  $1 == "real" && ($2 < least || !sets) { least = $2 }
  $1 == "real" && $2 > most { most = $2 }
  $1 == "real" { sets++ }
  END {
    named = total["finite"] + total["at_infinity"] + total["degenerate"] + total["multiple"] + total["failed"]
    printf "sets                 %9d  all classes complete in %d\n", sets, whole
    printf "classes              %9d  1442 a set\n", total["count"]
    printf "  finite             %9d\n", total["finite"]
    printf "  at infinity        %9d\n", total["at_infinity"]
    printf "  degenerate         %9d\n", total["degenerate"]
    printf "  multiple           %9d\n", total["multiple"]
    printf "  failed             %9d\n", total["failed"]
    printf "  named              %9d\n", named
    printf "  certified          %9d  proved to be there and different\n", total["certified"]
    printf "real                 %9d  %d to %d a set\n", total["real"], least, most
    printf "  certified          %9d  proved real\n", total["certified_real"]
  }' | tee "$folder/counts.txt"
exit "$status"
