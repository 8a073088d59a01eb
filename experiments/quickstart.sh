#!/usr/bin/env bash
# From a fresh Debian 12 machine to a table that says which estimator is better: installs, builds,
# runs experiments/quickstart.yaml into ./quickstart-store, prints the table, writes the figure and
# the report.
# A second call finds everything done.
#
#   ./experiments/quickstart.sh [--no-install]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install=true
for argument in "$@"; do
  case "$argument" in
    --no-install) install=false ;;
    *)
      echo "quickstart.sh: unknown argument '$argument'; known: --no-install" >&2
      exit 2
      ;;
  esac
done

if $install; then install_packages; fi
build_preset release misbench misbench-coordinator misbench-worker

misbench="$source_folder/build/release/bin/misbench"
store=./quickstart-store
"$misbench" run "$source_folder/experiments/quickstart.yaml" --store "$store" --workers 2 --threads-per-worker 1
"$misbench" figure "$source_folder/experiments/figures/quickstart.yaml" --store "$store" -o "$store/quickstart.pdf"
"$misbench" report "$store" -o "$store/report.html"
echo "The figure is in $store/quickstart.pdf, the report in $store/report.html"
