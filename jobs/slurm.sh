#!/usr/bin/env bash
# Runs a case under Slurm until it is done, however many times it needs its walltime:
#   sbatch -n RANKS -c THREADS -t WALLTIME jobs/slurm.sh CASE.toml [OUT]
#   sbatch -n RANKS -t WALLTIME --array=1-N jobs/slurm.sh CASE.toml OUT TABLE.csv
# The first line of a table names keys of the case, row N after it is task N, whose folder is OUT-N.
#SBATCH --job-name=parsim
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --output=parsim-%j.log
set -euo pipefail
# Slurm runs a copy of this file: where it was is in the job's description
script=$(scontrol show job "$SLURM_JOB_ID" | sed -n 's/^ *Command=\(.*slurm\.sh\).*/\1/p' | head -n 1)
# shellcheck source=SCRIPTDIR/cluster.sh
source "$(dirname -- "$script")/cluster.sh"
[[ $# -ge 1 ]] || { say "use: sbatch jobs/slurm.sh CASE.toml [OUT] [TABLE.csv]"; exit 2; }

left=$(squeue --noheader --job "$SLURM_JOB_ID" --format %L | head -n 1)
[[ $left =~ ^[0-9:-]+$ ]] || left=  # no limit
prepare "$1" "${2:-runs/$(basename -- "$1" .toml)}" "${3:-}" "${SLURM_ARRAY_TASK_ID:-}"
code=0
attempt "${SLURM_NTASKS:-1}" "$left" || code=$?
if again "$code"; then
    say "back into the queue"
    scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
