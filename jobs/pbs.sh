#!/usr/bin/env bash
# Runs a case under PBS until it is done, each stretch a job that submits the next:
#   qsub -l select=1:ncpus=RANKS:mpiprocs=RANKS:ompthreads=1 -l walltime=HH:MM:SS -v CASE=CASE.toml,OUT=OUT jobs/pbs.sh
#   qsub -J 1-N -v CASE=CASE.toml,OUT=OUT,TABLE=TABLE.csv ... jobs/pbs.sh
# The first line of a table names keys of the case, row N after it is task N, whose folder is OUT-N.
#PBS -N parsim
#PBS -r y
#PBS -j oe
#PBS -k oed
set -euo pipefail
cd -- "${PBS_O_WORKDIR:-.}"
# PBS runs a copy of this file: it is looked for where the job was submitted, or in PARSIM
[[ -f ${PARSIM:-.}/jobs/cluster.sh ]] || {
    echo "parsim: submit from the checkout, or add PARSIM=/path/to/checkout to -v" >&2
    exit 2
}
source "${PARSIM:-.}/jobs/cluster.sh"
[[ -n ${CASE:-} ]] || { say "use: qsub -v CASE=CASE.toml[,OUT=OUT][,TABLE=TABLE.csv] jobs/pbs.sh"; exit 2; }

seconds() { local h m s; IFS=: read -r h m s <<<"${1:-0:0:0}"; echo $((10#$h * 3600 + 10#$m * 60 + 10#$s)); }
told() { sed -n "s/^ *$1 = //p" <<<"$job_facts" | head -n 1; }

# the next job, with the account, project, queue and resources of this one
submit_next() {
    local option fact words=()
    for option in N:Job_Name A:Account_Name P:project q:queue; do
        fact=$(told "${option#*:}")
        [[ -z $fact || $fact == _pbs_project_default ]] || words+=("-${option%%:*}" "$fact")
    done
    for option in select place walltime; do
        fact=$(told "Resource_List.$option")
        [[ -z $fact ]] || words+=(-l "$option=$fact")
    done
    qsub "${words[@]}" -v "CASE=$CASE,OUT=${OUT:-},TABLE=${TABLE:-},ROW=$row,PARSIM=${PARSIM:-.}" "${PARSIM:-.}/jobs/pbs.sh" ||
        say "qsub has refused it: to go on, submit the same line again"
}

job_facts=$({ qstat -f "$PBS_JOBID" || say "qstat does not tell the walltime of this job"; } | sed -e ':all' -e 'N' -e '$!b all' -e 's/\n\t//g')  # long lines come folded
limit=$(told Resource_List.walltime) row=${PBS_ARRAY_INDEX:-${ROW:-}}
left=${limit:+"0:$(($(seconds "$limit") - $(seconds "$(told resources_used.walltime)")))"}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
prepare "$CASE" "${OUT:-runs/$(basename -- "$CASE" .toml)}" "${TABLE:-}" "$row"
code=0
attempt "$(wc -l <"$PBS_NODEFILE")" "$left" "$PBS_JOBID" || code=$?
if again "$code"; then
    say "submitting what is left"
    submit_next  # not qrerun, which most sites leave to operators
fi
exit "$code"
