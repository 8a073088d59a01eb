#!/usr/bin/env bash
# Looks at a report in headless Chromium; see README.md.
#
#   ./tests/browser/run.sh [--misbench PROGRAM] [--chromium PROGRAM]
#
# Builds misbench unless --misbench names one.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../experiments/setup.sh"

arguments=("$@")
case " $* " in
  *" --misbench "* | *" --help "* | *" -h "*) ;;
  *)
    build_preset release misbench misbench-coordinator misbench-worker >&2
    arguments+=(--misbench "$source_folder/build/release/bin/misbench")
    ;;
esac
cd "$source_folder"
exec python3 "$source_folder/tests/browser/report_test.py" "${arguments[@]}"
