#!/usr/bin/env bash
# Diagnoses a measurement on a servoscope server, with curl and jq.
set -euo pipefail

usage() {
    cat <<'END'
servoscope.sh [OPTION]... FILE...

Uploads a measurement, has it diagnosed or identified, and prints the answer. Several FILEs form
one measurement.

  --server URL          where the server is; $SERVOSCOPE_URL, or http://127.0.0.1:8080
  --identify            fits the base model only
  --actuator-order N    0, 1 or 2; otherwise the order is chosen from the data
  --set KEY=VALUE       what the file does not say, such as --set "input=current A",
                        --set "response=velocity rad/s", --set period_s=0.5; repeatable
  --json                prints the whole result as JSON
  --help                prints this

A key in $SERVOSCOPE_KEY is sent as "Authorization: Bearer". The exit code is 0 when done, 2
when the arguments or the file cannot be used, and 1 otherwise. Interrupted, the script leaves the
job to the server.
END
}

fail() {
    printf 'servoscope.sh: %s\n' "$2" >&2
    exit "$1"
}

# What curl is told on its standard input shows in no list of processes.
key() {
    [ -n "${SERVOSCOPE_KEY:-}" ] || return 0
    local escaped=${SERVOSCOPE_KEY//\\/\\\\}
    printf 'header = "Authorization: Bearer %s"\n' "${escaped//\"/\\\"}"
}

# request PATH [CURL ARGUMENT]...: the body of the answer; an error is told and ends the script.
request() {
    local path=$1 status told
    shift
    status=$(key | curl --config - --silent --retry 5 --retry-all-errors --connect-timeout 10 \
        --output "$scratch/answer" --write-out '%{http_code}' "$@" "$server$path") ||
        fail 1 "the server at $server does not answer"
    if [ "$status" -ge 400 ]; then
        told=$(jq -r '"\(.title): \(.detail)"' "$scratch/answer" 2>/dev/null) || told="HTTP status $status"
        case $status in
            400 | 413 | 415 | 422) fail 2 "$told" ;;
            *) fail 1 "$told" ;;
        esac
    fi
    cat "$scratch/answer"
}

# A request with it may be repeated: it makes no second measurement and no second job.
idempotency_key() {
    printf 'Idempotency-Key: %s' "$(od -An -N16 -tx1 /dev/urandom | tr -d ' \n')"
}

# What a file's name is within a form: quoted, so that no character of it means anything.
quoted() {
    local text=${1//\\/\\\\}
    printf '"%s"' "${text//\"/\\\"}"
}

wait_for() {
    local job=$1 state stage shown=
    while :; do
        state=$(request "/v1/jobs/$job?wait=5" --max-time 60)
        stage=$(jq -r '"\((.progress.fraction // 0) * 100 | floor) %  \(.progress.stage // .status)"' <<<"$state")
        [ "$stage" = "$shown" ] || printf '%s\n' "$stage" >&2
        shown=$stage
        case $(jq -r .status <<<"$state") in
            succeeded) return ;;
            failed) fail 1 "the job failed: $(jq -r .failure.reason <<<"$state")" ;;
            cancelled) fail 1 "the job was cancelled" ;;
        esac
    done
}

readonly DIAGNOSIS='
def digits: if . == null then "unknown" else . as $x
    | if $x == 0 then "0" else ($x | fabs | log10 | floor) as $e
    | (if $e > 4 then 0 else 4 - $e end) as $places
    | pow(10; $places) as $scale | ($x * $scale | round) / $scale | tostring end end;
def interval: if . == null then "" else "   95 % from \(.[0] | digits) to \(.[1] | digits)" end;
def change: if .ratio >= 1 then "residual ÷ \(.ratio | digits)\(.interval95 | interval)"
    else "residual × \(1 / .ratio | digits)\(.interval95 | map(1 / .) | sort | interval)" end;
def parameter: "     \(.key)  \(.value.value | digits) \(.value.unit)\(.value.interval95 | interval)";
def confidence: if . > 0.999 then "above 99.9 %" else "\(. * 100 | round) %" end;
def model: (.parameters | to_entries[] | parameter);
if .verdict then
    .headline // (.verdict | ascii_upcase), "\(if .verdict == "adequate" then "Sensitivity" else "Where" end): \(.discrepancy.sentence)",
    (.measurement[] | "The measurement: \(.sentence)"),
    (.causes | to_entries[] |
        "  \(.key + 1). \(.value.effect), confidence \(.value.confidence | confidence)",
        (.value.parameters | to_entries[] | parameter),
        (.value | select(.equivalents != []) | "     cannot be told from \(.equivalents | join(", "))")),
    (.gain // empty | "Improvement on held-out data: \(change)"),
    (if .extended then "The model with the causes", (.extended | model)
        else "The base model", (.base | model) end)
else
    .headline // empty, "Residual: \(.fit.nrmse * 100 | digits) % of the response", model
end'

server=${SERVOSCOPE_URL:-http://127.0.0.1:8080}
kind=diagnose order= json= parts=() files=0
while [ $# -gt 0 ]; do
    case $1 in
        --help) usage && exit ;;
        --identify) kind=identify ;;
        --json) json=yes ;;
        --server | --actuator-order | --set)
            [ $# -ge 2 ] || fail 2 "$1 needs a value"
            case $1 in
                --server) server=${2%/} ;;
                --actuator-order) order=$2 ;;
                --set)
                    [[ $2 == *=* ]] || fail 2 "--set takes KEY=VALUE, not $2"
                    parts+=(--form-string "$2")
                    ;;
            esac
            shift
            ;;
        --*) fail 2 "there is no option $1; --help lists them" ;;
        *)
            [ -r "$1" ] && [ ! -d "$1" ] || fail 2 "cannot read the file $1"
            parts+=(--form "file=@$(quoted "$1");filename=$(quoted "${1##*/}")")
            files=$((files + 1))
            ;;
    esac
    shift
done
for program in curl jq; do
    command -v "$program" >/dev/null || fail 1 "$program is not installed"
done
[ "$files" -gt 0 ] || fail 2 "which file? --help says more"
[[ $order =~ ^[012]?$ ]] || fail 2 "--actuator-order takes 0, 1 or 2, not $order"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
measurement=$(request /v1/measurements --header "$(idempotency_key)" "${parts[@]}")
asked=$(jq -c --arg kind "$kind" --arg order "$order" '
    {measurement_id: .id, kind: $kind}
    + if $order == "" then {} else {plant: {actuator_order: ($order | tonumber)}} end' <<<"$measurement")
job=$(request /v1/jobs --header "$(idempotency_key)" \
    --header 'Content-Type: application/json' --data-raw "$asked" | jq -r .id)
wait_for "$job"
result=$(request "/v1/jobs/$job/result")
if [ -n "$json" ]; then
    printf '%s\n' "$result"
else
    jq -r "$DIAGNOSIS" <<<"$result"
    printf 'The report: %s/v1/jobs/%s/report.html\n' "$server" "$job"
fi
