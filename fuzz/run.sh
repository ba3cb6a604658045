#!/bin/sh
# Fuzzes every parser by coverage, on stable Rust:
#
#   fuzz/run.sh [SECONDS of all together] [TARGET…]
#   fuzz/run.sh keep [TARGET…]
#   fuzz/run.sh 0                     builds and runs nothing
#
# What is found ends up in fuzz/found, and inputs that reach something new in fuzz/grown; both stay
# out of the repository. For each target it says how many inputs were run, how many edges they
# reached, how long the slowest took in whole seconds, and how many files were found: crashes,
# inputs that took 120 s or 2 GiB, and those that took 10 s. `keep` puts a small set of inputs that
# reaches the same edges into fuzz/corpus, with which each run begins.
set -eu
cd "$(dirname "$0")"
what=${1:-60}
[ $# -eq 0 ] || shift
host=$(rustc -vV | sed -n 's/^host: //p')
target=${CARGO_TARGET_DIR:-target}/fuzz
RUSTC_WRAPPER=$PWD/rustc CARGO_TARGET_DIR=$target \
  cargo build --release --locked --target "$host"
[ "$what" != 0 ] || exit 0

# Targets that store something do so in memory.
[ ! -d /dev/shm ] || export TMPDIR=/dev/shm
targets=${*:-$(ls corpus)}
rm -rf kept
mkdir -p found
touch found/began
for name in $targets; do
  # `files-tdms` is the target `files` on a corpus of its own.
  program=$target/$host/release/${name%%-*}
  log=found/$name.log
  mkdir -p "grown/$name"
  if [ "$what" = keep ]; then
    # Of the targets of one program each keeps what those before it do not reach.
    all=kept/${name%%-*}
    mkdir -p "$all"
    touch kept/before
    "$program" -use_counters=0 -set_cover_merge=1 "$all" "corpus/$name" "grown/$name" 2>"$log"
    rm -r "corpus/$name"
    mkdir "corpus/$name"
    find "$all" -type f -newer kept/before -exec cp {} "corpus/$name" \;
    continue
  fi
  seconds=$((what / $(echo "$targets" | wc -w)))
  "$program" -seed=1 -max_total_time="$seconds" -max_len=10000 -timeout=120 -rss_limit_mb=2048 \
    -print_final_stats=1 -artifact_prefix="found/$name-" "grown/$name" "corpus/$name" 2>"$log" ||
    echo "$name: something was found, see fuzz/$log"
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  slowest=$(sed -n 's/^stat::slowest_unit_time_sec: *//p' "$log")
  files=$(find found -name "$name-*" -newer found/began | wc -l)
  printf '%-22s %6s s %10s inputs %7s edges %4s s slowest %3s found\n' \
    "$name" "$seconds" "${runs:-?}" "${edges:-?}" "${slowest:-?}" "$files"
done
[ "$what" = keep ] || find found -name '*-*' ! -name '*.log' -newer found/began
