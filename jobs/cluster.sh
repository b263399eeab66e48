# What the job scripts of all schedulers share. Sourced:
#   source jobs/cluster.sh; prepare CASE OUT TABLE ROW; attempt RANKS WALLTIME JOB; again CODE
# shellcheck shell=bash
# shellcheck source=SCRIPTDIR/setup.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/setup.sh"

# Checks what the job was given; `options` become the words that `parsim run` gets.
prepare() {
    case_file=$1 output=$2 options=()
    local table=$3 row=$4
    [[ -x $python ]] || { say "no $venv: run \`bash jobs/local.sh\` once where the network is"; exit 2; }
    if [[ -n $table ]]; then
        [[ $row =~ ^[1-9][0-9]*$ ]] || { say "a table needs an array job: --array=1-N, or -J 1-N"; exit 2; }
        options+=(--table "$table" --row "$row")
        output=$output-$row
    elif [[ -n $row ]]; then
        say "an array job needs a table, or all its tasks would be one run"
        exit 2
    fi
    # compiled kernels on the node's own disk, made once there
    export NUMBA_CACHE_DIR=${NUMBA_CACHE_DIR:-/tmp/parsim-cache-$UID}
    # mpirun's daemons on the other nodes would not outlive the SIGTERM that a scheduler sends to all processes of a job
    if env --block-signal=TERM true 2>/dev/null; then
        export PRTE_MCA_prte_launch_agent=${PRTE_MCA_prte_launch_agent:-env --block-signal=TERM prted}
    fi
}

# One stretch of the run on RANKS ranks, WALLTIME long at most if it is not empty, in JOB; the exit code is that of parsim.
# A folder that holds the run of another case is refused.
attempt() {
    local words code=0
    before=$(newest) ended=
    if [[ -f $output/case.toml ]]; then
        words=(resume "$output" --case "$case_file")
    else
        words=(run "$case_file" -o "$output")
    fi
    words+=(${options[@]+"${options[@]}"} -n "$1" ${2:+--walltime "$2"})
    say "$(date '+%F %T'), job $3 on $(uname -n): parsim ${words[*]}"
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

# Whether a run that has ended with CODE is to be put back into the queue: it was stopped, or killed by no fault of its
# own, and has come further. A job that the scheduler ends is left to the scheduler, and to who cancelled it.
again() {
    [[ -z $ended ]] || return 1
    if [[ $1 -eq 2 || $1 -eq 74 ]]; then  # what is wrong stays wrong
        return 1
    elif [[ $1 -eq 75 ]]; then
        say "stopped with a checkpoint"
    elif grep -q '"status": "running"' "$output/run.json" 2>/dev/null; then
        say "killed, or lost with a node"
    else
        return 1
    fi
    [[ $(newest) != "$before" ]] || { say "no new checkpoint in this stretch, so this is its end"; return 1; }
}

# What the newest checkpoint is; the same before and after a stretch when that brought nothing.
newest() { { find "$output/checkpoints" -name '*.h5' -printf '%T@ %f\n' 2>/dev/null || true; } | sort -n | tail -n 1; }
