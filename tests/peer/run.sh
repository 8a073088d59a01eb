#!/usr/bin/env bash
# Compares misbench's path tracer with Mitsuba 3, and its FLIP with its authors'; see README.md.
#
#   ./tests/peer/run.sh [--self-test] [OPTIONS OF compare.py]
#   ./tests/peer/run.sh --flip [OPTIONS OF compare_flip.py]
#
# Makes a virtual environment in build/peer with the pinned packages, and builds misbench unless
# --misbench names one. --self-test tests the comparison itself, without misbench.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../experiments/setup.sh"

peer_folder="$source_folder/tests/peer"
python="$source_folder/build/peer/venv/bin/python"

if ! cmp -s "$peer_folder/requirements.txt" "$source_folder/build/peer/installed.txt"; then
  mkdir -p "$source_folder/build/peer"
  python3 -m venv "$source_folder/build/peer/venv"
  "$python" -m pip install --quiet --requirement "$peer_folder/requirements.txt" >&2
  cp "$peer_folder/requirements.txt" "$source_folder/build/peer/installed.txt"
fi

if [ "${1:-}" = --self-test ]; then
  exec "$python" "$peer_folder/self_test.py"
fi
script=compare.py
if [ "${1:-}" = --flip ]; then
  script=compare_flip.py
  shift
fi
case " $* " in
  *" --misbench "* | *" --misbench="* | *" --list "* | *" --help "* | *" -h "*) ;;
  *) build_preset release misbench >&2 ;;
esac
exec "$python" "$peer_folder/$script" "$@"
