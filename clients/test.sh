#!/usr/bin/env bash
# Tests every client against a live server, on a fresh Debian machine as root or where the tools are
# installed. SERVOSCOPE is the program; left out, the one that `cargo build` leaves.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
exec </dev/null

program=${SERVOSCOPE:-target/debug/servoscope}
[[ $program == /* ]] || program=$here/../$program
SERVOSCOPE=$(realpath -- "$program")
[ -x "$SERVOSCOPE" ] || {
    echo "there is no program $SERVOSCOPE: cargo build makes it" >&2
    exit 1
}
TEST_FOLDER=$(mktemp -d)
export SERVOSCOPE TEST_FOLDER
server=
finish() {
    [ -z "$server" ] || kill "$server" 2>/dev/null || true
    rm -rf "$TEST_FOLDER"
}
trap finish EXIT

section() { printf '\n--> %s\n' "$1"; }
skip() { printf '\nSKIPPED: %s\n' "$1"; }

# install COMMAND PACKAGE...: whether the command is there, or could be installed.
updated=
install() {
    local command=$1
    shift
    command -v "$command" >/dev/null && return
    [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null || return 1
    [ -n "$updated" ] || apt-get update -qq || return 1
    updated=yes
    DEBIAN_FRONTEND=noninteractive apt-get install --yes -qq --no-install-recommends "$@" >/dev/null &&
        command -v "$command" >/dev/null
}

# A Python with the client and what tests it, in a folder that goes when the tests are over.
make_python() {
    install python3 python3 || return 1
    python3 -c 'import ensurepip' 2>/dev/null || {
        [ "$(id -u)" -eq 0 ] && apt-get update -qq &&
            DEBIAN_FRONTEND=noninteractive apt-get install --yes -qq --no-install-recommends python3-venv >/dev/null
    } || return 1
    python3 -m venv "$TEST_FOLDER/venv" &&
        PATH=$TEST_FOLDER/venv/bin:$PATH pip install --quiet "$here/python[test]"
}

start_server() {
    "$SERVOSCOPE" serve --listen 127.0.0.1:0 --data-dir "$TEST_FOLDER/data" \
        >"$TEST_FOLDER/listening" 2>"$TEST_FOLDER/log" &
    server=$!
    until grep -q '^listening on' "$TEST_FOLDER/listening"; do
        kill -0 "$server" || {
            cat "$TEST_FOLDER/log" >&2
            return 1
        }
        sleep 0.1
    done
    SERVOSCOPE_URL=$(sed -n 's/^listening on //p' "$TEST_FOLDER/listening")
    export SERVOSCOPE_URL
}

section "tools"
if make_python; then
    (
        PATH=$TEST_FOLDER/venv/bin:$PATH
        cd "$here/python"
        export PYTHONDONTWRITEBYTECODE=1 RUFF_NO_CACHE=true
        section "Python: ruff"
        ruff format --check .
        ruff check .
        section "Python: mypy"
        mypy --cache-dir "$TEST_FOLDER/mypy"
        section "Python: pytest, the notebook included"
        pytest -p no:cacheprovider
    )
else
    skip "Python: no python3 with venv, or no packages from PyPI"
fi

start_server
if install curl curl && install jq jq; then
    section "shell"
    "$here/shell/test.sh"
else
    skip "shell: curl and jq cannot be installed"
fi

# Octave draws with gnuplot where it has no display.
if install curl curl && install octave octave && install gnuplot gnuplot-nox fonts-freefont-otf; then
    section "Octave"
    octave --no-gui --quiet "$here/matlab/tests/run_tests.m"
else
    skip "Octave: octave and gnuplot cannot be installed"
fi
