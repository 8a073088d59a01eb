#!/usr/bin/env bash
# Installs, builds and runs the tests.
#
#   ./tests/run.sh [--no-install] [--all] [--preset release|dev|asan|ubsan|tsan]
#
# --all     the slow tests too
# --preset  another build; tsan leaves out the tests with processes, because Debian's gRPC is not
#           built for it
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../experiments/setup.sh"

install=true
all=false
preset=release
while [ $# -gt 0 ]; do
  case "$1" in
    --no-install) install=false ;;
    --all) all=true ;;
    --preset)
      preset=${2:-}
      shift
      ;;
    *)
      echo "run.sh: unknown argument '$1'; known: --no-install --all --preset" >&2
      exit 2
      ;;
  esac
  shift
done
case "$preset" in
  release | dev | asan | ubsan | tsan) ;;
  *)
    echo "run.sh: unknown preset '$preset'; known: release dev asan ubsan tsan" >&2
    exit 2
    ;;
esac

if $install; then install_packages; fi
build_preset "$preset"

excluded=()
$all || excluded+=(slow)
[ "$preset" = tsan ] && excluded+=(e2e)
labels=()
[ ${#excluded[@]} -eq 0 ] || labels=(-LE "$(IFS='|'; echo "${excluded[*]}")")
cd "$source_folder/build/$preset"
ctest --output-on-failure -j2 "${labels[@]}"
