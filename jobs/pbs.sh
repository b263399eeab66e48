#!/usr/bin/env bash
# Runs a case under PBS until it is done, each stretch a job that submits the next:
#   qsub -l select=1:ncpus=RANKS:mpiprocs=RANKS -l walltime=HH:MM:SS -v CASE=CASE.toml,OUT=OUT jobs/pbs.sh
#   qsub -J 1-N -v CASE=CASE.toml,OUT=OUT,TABLE=TABLE.csv ... jobs/pbs.sh
# The first line of a table names keys of the case, line N + 1 is task N, whose folder is OUT-N.
#PBS -N parsim
#PBS -r n
#PBS -j oe
#PBS -k oed
set -euo pipefail
cd -- "${PBS_O_WORKDIR:-.}"
# PBS runs a copy of this file: it is looked for where the job was submitted, or in PARSIM
source "${PARSIM:-.}/jobs/cluster.sh"
[[ -n ${CASE:-} ]] || { say "use: qsub -v CASE=CASE.toml[,OUT=OUT][,TABLE=TABLE.csv] jobs/pbs.sh"; exit 2; }

seconds() { local h m s; IFS=: read -r h m s <<<"${1:-0:0:0}"; echo $((10#$h * 3600 + 10#$m * 60 + 10#$s)); }
told() { sed -n "s/^ *$1 = //p" <<<"$job_facts" | head -n 1; }

job_facts=$(qstat -f "$PBS_JOBID")
limit=$(told Resource_List.walltime) row=${PBS_ARRAY_INDEX:-${ROW:-}}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
prepare "$CASE" "${OUT:-runs/$(basename -- "$CASE" .toml)}" "${TABLE:-}" "$row"
before=$(newest) code=0
attempt "$(wc -l <"$PBS_NODEFILE")" "0:$(($(seconds "$limit") - $(seconds "$(told resources_used.walltime)")))" || code=$?
if [[ $code -eq 75 ]]; then
    [[ $(newest) != "$before" ]] || { say "no checkpoint within this walltime: ask for a longer one"; exit 1; }
    say "stopped with a checkpoint: submitting what is left"
    # not qrerun, which most sites leave to operators
    qsub -q "$(told queue)" -l "select=$(told Resource_List.select)" -l "walltime=$limit" \
        -v "CASE=$CASE,OUT=${OUT:-},TABLE=${TABLE:-},ROW=$row,PARSIM=${PARSIM:-.}" "${PARSIM:-.}/jobs/pbs.sh"
fi
exit "$code"
