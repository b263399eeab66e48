#!/usr/bin/env bash
# Runs a case under Slurm until it is done, however many times it needs its walltime:
#   sbatch -n RANKS -c THREADS -t WALLTIME jobs/slurm.sh CASE.toml [OUT]
#   sbatch -n RANKS -t WALLTIME --array=1-N --output=parsim-%A_%a.log jobs/slurm.sh CASE.toml OUT TABLE.csv
# The first line of a table names keys of the case, row N after it is task N, whose folder is OUT-N. Options of sbatch go
# before the script; a copy of it needs PARSIM=/path/to/checkout.
#SBATCH --job-name=parsim
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --output=parsim-%j.log
set -euo pipefail
# Slurm runs a copy of this file: where it was is in the job's description
[[ -n ${SLURM_JOB_ID:-} ]] || { echo "parsim: use: sbatch jobs/slurm.sh CASE.toml [OUT] [TABLE.csv]" >&2; exit 2; }
script=$(scontrol show job "$SLURM_JOB_ID" | sed -n 's/^ *Command=\(.*slurm\.sh\).*/\1/p' | head -n 1)
checkout=${PARSIM:-$(dirname -- "$(dirname -- "${script:-none}")")}
[[ -f $checkout/jobs/cluster.sh ]] || {
    echo "parsim: this is a copy of jobs/slurm.sh: name the checkout that it is of, export PARSIM=/path/to/checkout" >&2
    exit 2
}
# shellcheck source=SCRIPTDIR/cluster.sh
source "$checkout/jobs/cluster.sh"
[[ $# -ge 1 ]] || { say "use: sbatch jobs/slurm.sh CASE.toml [OUT] [TABLE.csv]"; exit 2; }
[[ -n ${SLURM_NTASKS:-} || ${SLURM_JOB_NUM_NODES:-1} -eq 1 ]] || { say "-N without -n: give the number of ranks, -n"; exit 2; }
export SLURM_EXPORT_ENV=ALL  # mpirun starts its daemons on other nodes with srun, also where sbatch --export=NONE was used

left=$(squeue --noheader --job "$SLURM_JOB_ID" --format %L | head -n 1)
[[ $left =~ ^[0-9:-]+$ ]] || left=  # no limit
prepare "$1" "${2:-runs/$(basename -- "$1" .toml)}" "${3:-}" "${SLURM_ARRAY_TASK_ID:-}"
code=0
attempt "${SLURM_NTASKS:-1}" "$left" "$SLURM_JOB_ID" || code=$?
if again "$code"; then
    say "back into the queue"
    scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
