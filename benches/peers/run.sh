#!/usr/bin/env bash
# Compares `servoscope identify` with searches of other packages on the same data: see README.md.
#
#   benches/peers/run.sh                 11 seeds
#   benches/peers/run.sh --seeds 3       fewer
#   benches/peers/run.sh --smoke         one seed and small budgets: that everything still runs
#
# SERVOSCOPE names a release binary that is there already; without it one is built. PYTHON names the
# interpreter. Everything that is made is in target/peers.
set -euo pipefail
here=$(realpath "$(dirname "$0")")
target=$(realpath -m "${CARGO_TARGET_DIR:-$here/../../target}")
program=${SERVOSCOPE:+$(realpath "$SERVOSCOPE")}
export PEERS_BUILD=$target/peers PYTHONPYCACHEPREFIX=$target/peers/pycache
environment=$PEERS_BUILD/environment
if [ -z "$program" ]; then
    cargo build --manifest-path "$here/../../Cargo.toml" --locked --release --bin servoscope
    program=$target/release/servoscope
fi
if ! cmp -s "$here/requirements.txt" "$environment/installed.txt"; then
    rm -rf "$environment"
    "${PYTHON:-python3}" -m venv "$environment"
    "$environment/bin/pip" install --quiet --only-binary :all: -r "$here/requirements.txt"
    cp "$here/requirements.txt" "$environment/installed.txt"
fi
# One thread for everybody. A package leaves its log in the current folder.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
cd "$PEERS_BUILD"
exec "$environment/bin/python" "$here/compare.py" "$program" "$@"
