#!/usr/bin/env bash
# Counts the instructions of some work and compares them with those in benches/instructions.txt:
#
#   benches/instructions.sh            fails where a count is more than 5 % above the recorded one
#   benches/instructions.sh --record   writes the counts to that file; commit it with the change
#
# The work is in crates/bench/examples/instructions.rs. It is built as .ci/run builds everything for
# its tests: optimised, with overflow checks. Counts of another compiler, C library or processor
# family are others, so they are not compared.
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_INCREMENTAL=0
recorded=benches/instructions.txt
program=${CARGO_TARGET_DIR:-target}/debug/examples/instructions

# What a count depends on beside the code. Libraries choose among instructions while they run.
setting() {
    local avx2="without AVX2"
    ! grep -qw avx2 /proc/cpuinfo || avx2="with AVX2"
    printf '%s, %s %s, %s, %s\n' "$(rustc --version)" "$(uname -m)" "$avx2" \
        "$(getconf GNU_LIBC_VERSION)" "$(valgrind --version)"
}

count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no \
        --toggle-collect='*work_under_count*' "$program" "$1" 2>&1 |
        sed -n 's/^==[0-9]*== Collected : *//p'
}

# Name and count of each piece of work, one a line.
count_all() {
    local name instructions
    for name in $("$program"); do
        instructions=$(count "$name")
        if [ "${instructions:-0}" -eq 0 ]; then
            echo "no instructions of $name were counted" >&2
            return 1
        fi
        echo "$name $instructions"
    done
}

# Of the lines "name count" that are piped in.
compare() {
    awk -v most=5 -v file="$recorded" '
        FNR == NR { if (!/^#/) recorded[$1] = $2; next }
        !($1 in recorded) { printf "%-22s is not in %s\n", $1, file; wrong = 1; next }
        {
            change = 100 * ($2 / recorded[$1] - 1)
            risen = change > most
            wrong = wrong || risen
            printf "%-22s recorded %13s  now %13s  %+.2f %%%s\n", $1, recorded[$1], $2, change,
                risen ? "  TOO MANY" : ""
        }
        END {
            if (wrong) {
                printf "More than %d %% above the record. If the change is worth it, ", most
                print "run benches/instructions.sh --record and commit " file "."
            }
            exit wrong
        }' "$recorded" -
}

if ! command -v valgrind >/dev/null; then
    echo "SKIPPED: instructions are not counted, there is no valgrind"
    exit 0
fi
setting=$(setting)
if [ "${1:-}" != --record ] && ! grep -qxF "# $setting" "$recorded"; then
    echo "SKIPPED: instructions are not compared, the recorded ones are of another setting"
    echo "  recorded: $(sed -n 's/^# //p' "$recorded")"
    echo "  here:     $setting"
    exit 0
fi
cargo build --locked --quiet --example instructions
counts=$(count_all)
if [ "${1:-}" = --record ]; then
    printf '# %s\n%s\n' "$setting" "$counts" >"$recorded"
    cat "$recorded"
else
    compare <<<"$counts"
fi
