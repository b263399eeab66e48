#!/usr/bin/env bash
# Runs the tests:   bash tests/run.sh [PYTEST ARGUMENTS]      the first start makes .venv; see jobs/setup.sh
# Without arguments all default tests, two files at a time.
set -euo pipefail
# shellcheck source=SCRIPTDIR/../jobs/setup.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/../jobs/setup.sh"
set_up pictures tests terrain
cd -- "$root"
(($#)) || set -- --numprocesses 2 --dist loadfile --no-loadscope-reorder
exec "$python" -m pytest "$@"
