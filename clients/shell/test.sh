#!/usr/bin/env bash
# Tests servoscope.sh against a live server.
#   SERVOSCOPE      the program, which simulates measurements
#   SERVOSCOPE_URL  the server
#   TEST_FOLDER     a folder to write into
set -euo pipefail
script=$(cd "$(dirname "$0")" && pwd)/servoscope.sh
cd "$TEST_FOLDER"
passed=0

# expect CODE PATTERN COMMAND...: the command ends with the code, and prints what matches.
expect() {
    local code=$1 pattern=$2 printed ended=0
    shift 2
    printed=$("$@" 2>&1) || ended=$?
    if [ "$ended" -ne "$code" ] || ! grep -Eq "$pattern" <<<"$printed"; then
        printf 'FAILED: %s\nexit code %d, expected %d and /%s/:\n%s\n' \
            "$*" "$ended" "$code" "$pattern" "$printed" >&2
        exit 1
    fi
    passed=$((passed + 1))
}

design=(--noise-db 60 --harmonics 5 --frequency-range 1:100:9)
hostile='a "b" $(touch x); c.csv'
"$SERVOSCOPE" simulate "${design[@]}" --fs-plus 0.8 --fs-minus 0.6 --output "$hostile"
"$SERVOSCOPE" simulate "${design[@]}" --magnitudes 1 --output one.csv
"$SERVOSCOPE" simulate "${design[@]}" --magnitudes 3,6 --output two.csv
sed '5s/,[^,]*$/,x/' one.csv >wrong.csv

expect 0 'static_friction, confidence above 99.9 %' \
    "$script" --actuator-order 0 --set "input=current A" --set "machine=@press; 4" "$hostile"
expect 0 '^EXPLAINED: The simulation lacks static friction' "$script" --actuator-order 0 "$hostile"
expect 0 '^Improvement on held-out data: residual ÷ [0-9.]+   95 % from' "$script" --actuator-order 0 "$hostile"
expect 0 'pole  -(9\.9|10)[0-9.]* rad/s   95 % from' "$script" --identify --actuator-order 0 one.csv two.csv
expect 0 '"parameters"' env SERVOSCOPE_KEY='a "key"' "$script" --identify --actuator-order 0 --json two.csv
expect 2 'Unreadable measurement: wrong.csv, line 5' "$script" wrong.csv
expect 2 'colour' "$script" --set colour=red one.csv
expect 0 'Uploads a measurement' "$script" --help
expect 2 'no option --frobnicate' "$script" --frobnicate one.csv
expect 2 'cannot read the file none.csv' "$script" none.csv
expect 2 'which file' "$script"
expect 2 'takes 0, 1 or 2' "$script" --actuator-order 3 one.csv
expect 2 'takes KEY=VALUE' "$script" --set machine one.csv
expect 1 'the server at http://127.0.0.1:1 does not answer' "$script" --server http://127.0.0.1:1 one.csv
[ ! -e x ]
printf '%d passed\n' "$passed"
