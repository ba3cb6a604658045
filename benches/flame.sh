#!/usr/bin/env bash
# Draws where a diagnosis spends its time, as a flame graph, and prints the share of each part:
#
#   benches/flame.sh table/one_hidden      a piece of work of `cargo bench --bench diagnose`
#   benches/flame.sh record/emps OUT.svg
#
# The width of a box is its share of the processor time, what it calls stands above it. Functions of the
# scheduler and of the standard library are left out, and everything runs in one thread of the pool:
# what is handed to that thread stands beside what handed it over.
# It needs `perf` (Debian: linux-perf), inferno (`cargo install inferno`), Python and Perl.
set -euo pipefail
cd "$(dirname "$0")/.."
work=${1:?which piece of work}
drawn=${2:-target/flame-$(basename "$work").svg}
data=$(mktemp -d)
trap 'rm -rf "$data"' EXIT
export RUSTFLAGS="-C force-frame-pointers=yes" CARGO_PROFILE_BENCH_DEBUG=line-tables-only
export RAYON_NUM_THREADS=1
cargo bench --bench diagnose --no-run
perf record -o "$data/perf.data" -F 199 --call-graph fp \
    cargo bench --bench diagnose -- "diagnose_$work" --profile-time 20
perf script -i "$data/perf.data" | inferno-collapse-perf | grep '^diagnose' |
    benches/flame_frames.py >"$data/stacks"
benches/flame_parts.py <"$data/stacks"
inferno-flamegraph --no-javascript --title "Diagnosis of $work" --countname ns \
    --width 1200 --minwidth 0.5 --colors orange --hash <"$data/stacks" |
    # What is left of the tool's script would only serve a browser.
    perl -0pe 's/<script.*?<\/script>|<text id="(search|unzoom|matched)".*?<\/text>//sg; s/ onload="[^"]*"//' \
        >"$drawn"
echo "$drawn"
