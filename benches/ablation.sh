#!/bin/sh
# Measures what other values of the settings of the search do to the answers and to the processor
# time, and prints the table that docs/search-settings.md describes. Arguments are names of
# settings, or their beginnings, to halve and double those alone, NAME=VALUE for another value, and
# options of `servoscope benchmark`:
#
#   benches/ablation.sh                          all settings, one draw a core
#   benches/ablation.sh rival_share --jobs 1     one setting, one draw after the other
#   benches/ablation.sh rival_share=0.02         one setting, one value
#
# DRAWS replaces the draws below.
set -eu
cd "$(dirname "$0")/.."
cargo build --release --bin servoscope
draws="${DRAWS:---seed 24024 --kinds single,pair --levels 60 --orders 0 --effects cogging --draws 1 --pairs 1}"
# The options in $draws are separate words.
# shellcheck disable=SC2086
exec nice "${CARGO_TARGET_DIR:-target}/release/servoscope" benchmark $draws --ablation "$@"
