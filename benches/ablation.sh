#!/bin/sh
# Prints the table of docs/search-settings.md: what halving and doubling each tuned number of the
# search does to the answers and to the processor time. Arguments are passed on, such as
# `--jobs 1`, `--seed 7` (the last one counts) or `--ablation rival_share`.
set -eu
cd "$(dirname "$0")/.."
cargo build --release --bin servoscope
exec nice "${CARGO_TARGET_DIR:-target}/release/servoscope" benchmark --seed 24024 \
    --kinds single,pair --levels 50 --draws 1 --pairs 3 --ablation "$@"
