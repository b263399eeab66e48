# What the job scripts of all schedulers share. Sourced:   source jobs/cluster.sh; prepare CASE OUT TABLE ROW; attempt RANKS WALLTIME
# shellcheck shell=bash
# shellcheck source=SCRIPTDIR/setup.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

# Checks what the job was given; `options` become the words that `parsim run` gets.
prepare() {
    case_file=$1 output=$2 options=()
    local table=$3 row=$4 keys values
    [[ -x $python ]] || { say "no $venv: run \`bash jobs/local.sh\` once where the network is"; exit 2; }
    [[ -f $case_file ]] || { say "no case file '$case_file'"; exit 2; }
    if [[ -n $table ]]; then
        [[ -f $table ]] || { say "no table '$table'"; exit 2; }
        [[ $row =~ ^[1-9][0-9]*$ ]] || { say "a table needs an array job: --array=1-N, or -J 1-N"; exit 2; }
        IFS=, read -r -a keys <"$table"
        IFS=, read -r -a values < <(sed -n "$((row + 1))p" -- "$table") || true
        [[ ${#values[@]} -eq ${#keys[@]} ]] || {
            say "row $row of $table has ${#values[@]} values for ${#keys[@]} keys"; exit 2; }
        for k in "${!keys[@]}"; do options+=(--set "${keys[k]}=${values[k]}"); done
        output=$output-$row
    fi
    # compiled kernels on the node's own disk, made once there
    export NUMBA_CACHE_DIR=${NUMBA_CACHE_DIR:-${TMPDIR:-/tmp}/parsim-cache-${USER:-$UID}}
}

# One stretch of the run on RANKS ranks, WALLTIME long at most if it is given; the exit code is that of parsim, and
# `ended` is set where the scheduler ends the job: what then becomes of it is for the scheduler, or who cancelled it.
attempt() {
    local words code=0
    ended=
    if [[ -f $output/case.toml ]]; then
        words=(resume "$output")
    else
        words=(run "$case_file" -o "$output" "${options[@]}")
    fi
    words+=(-n "$1" ${2:+--walltime "$2"})
    say "parsim ${words[*]}"
    "$python" -P -m parsim "${words[@]}" &
    job=$!
    trap 'kill -USR1 "$job" 2>/dev/null' USR1
    trap 'ended=yes; kill -USR1 "$job" 2>/dev/null' TERM
    # a signal ends `wait` before the run has ended
    while :; do
        wait "$job" && code=0 || code=$?
        kill -0 "$job" 2>/dev/null || break
    done
    return "$code"
}

# What the newest checkpoint is; the same before and after a stretch when that brought nothing.
newest() { { find "$output/checkpoints" -name '*.h5' -printf '%T@ %f\n' 2>/dev/null || true; } | sort -n | tail -n 1; }
