#!/usr/bin/env bash
# Runs a case on this machine and makes its page:   bash jobs/local.sh [CASE.toml] [RANKS]
# The first start makes .venv; see jobs/setup.sh. Results go to runs/<case name>, never over an earlier run.
set -euo pipefail
# shellcheck source=SCRIPTDIR/setup.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

case_file=${1:-$root/cases/ice_release/4_blocks_dry.toml}
ranks=${2:-2}
[[ $ranks =~ ^[1-9][0-9]*$ ]] || { say "RANKS is '$ranks'; it must be a whole number from 1 up"; exit 2; }
[[ -f $case_file ]] || { say "no case file '$case_file'. There are: $(cd "$root" && echo cases/*/[!_]*.toml)"; exit 2; }

set_up pictures

name=$(basename -- "$case_file" .toml)
output=$root/runs/$name
mkdir -p -- "$root/runs"
# making the folder claims the name, also against a run that starts at the same moment
for ((again = 2; ; again++)); do
    mkdir -- "$output" 2>/dev/null && break
    [[ -e $output ]] || stop "cannot write in $root/runs"
    output=$root/runs/$name-$again
done

code=0
say "parsim run $case_file -o $output -n $ranks"
"$python" -P -m parsim run "$case_file" -o "$output" -n "$ranks" || code=$?
# 75: stopped in good order with a checkpoint; what there is can be looked at
if [[ $code -ne 0 && $code -ne 75 ]]; then
    rmdir -- "$output" 2>/dev/null || true
    say "the run ended with exit code $code"
    exit "$code"
fi
"$python" -P -m parsim report "$output"
exit "$code"
