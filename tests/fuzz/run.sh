#!/usr/bin/env bash
# Builds the fuzzer's binaries with clang and runs each for a while, one after the other.
#
#   ./tests/fuzz/run.sh [SECONDS] [TARGET...]      60 seconds; all targets
#
# What they learn is kept in build/fuzz/corpus, what they find in build/fuzz/findings. Needs the
# packages clang-14 and libclang-rt-14-dev.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=${1:-60}
shift || true
targets=("$@")
[ ${#targets[@]} -gt 0 ] || for folder in tests/fuzz/corpus/*/; do
  targets+=("$(basename "$folder")")
done

# A file of limit_bytes must not make a reader ask for more than memory_mb at once. OpenEXR makes
# room for an attribute of any size that a header names, up to 2 GB, before it reads it.
limit_bytes=65536
memory_mb=1024
declare -A library_mb=([exr]=2100)

cmake --preset release -B build/fuzz -DMISBENCH_FUZZ=ON \
  -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 > /dev/null
ninja -C build/fuzz "${targets[@]/#/fuzz_}"

# Inputs go through files: memory is a faster place for them than a disk.
[ -d /dev/shm ] && export TMPDIR=/dev/shm
mkdir -p build/fuzz/findings
for target in "${targets[@]}"; do
  mkdir -p "build/fuzz/corpus/$target"
  echo "== $target"
  "build/fuzz/tests/fuzz_$target" "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" \
    -max_total_time="$seconds" -max_len=$limit_bytes -timeout=10 \
    -malloc_limit_mb=${library_mb[$target]:-$memory_mb} -rss_limit_mb=$((2 * memory_mb)) \
    -artifact_prefix="build/fuzz/findings/$target-" -print_final_stats=1 2>&1 |
    grep -E '^(stat::|#[0-9]+.*DONE|==|SUMMARY|artifact|.*ERROR)' || true
done
