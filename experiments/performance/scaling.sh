#!/usr/bin/env bash
# Time and memory of bdpt and vcm against image size, threads, path length, number of light paths
# and number of lights, at equal samples. One line a render: what `misbench render --json` records,
# CPU and wall seconds, rays, and the peak memory of the process. (Tables of an experiment compare
# errors, which equal samples of one method do not change.) Paths of each length go on without
# Russian roulette. One sample a pixel takes about five minutes on one core.
#
#   cmake --build --preset release --target misbench
#   experiments/performance/scaling.sh [SAMPLES] > scaling.tsv   # samples a pixel: 1
set -euo pipefail

source_folder="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
misbench="$source_folder/build/release/bin/misbench"
samples=${1:-1}
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# A closed box under a lamp of so many squares, two triangles each: write_box FOLDER SQUARES.
write_box() {
  mkdir -p "$1"
  awk -v n="$2" 'BEGIN {
    print "ply\nformat ascii 1.0\nelement vertex", 2 * (n + 1)
    print "property float x\nproperty float y\nproperty float z\nelement face", 2 * n
    print "property list uchar uint vertex_indices\nend_header"
    for (i = 0; i <= n; ++i) printf "%.9g 0.98 -0.3\n%.9g 0.98 0.3\n", i / n - 0.5, i / n - 0.5
    for (i = 0; i < 2 * n; i += 2) printf "3 %d %d %d\n3 %d %d %d\n", i, i + 2, i + 3, i, i + 3, i + 1
  }' >"$1/lamp.ply"
  cat >"$1/box.json" <<'JSON'
{
  "name": "box",
  "transforms": [{"name": "camera", "position": [0, 0, 0.99]}],
  "cameras": [{"name": "default", "type": "perspective", "fov": 60, "transform": "camera"}],
  "materials": [
    {"name": "wall", "type": "diffuse", "baseColor": {"type": "rgb", "value": [0.7, 0.7, 0.7]}},
    {"name": "lamp", "type": "diffuse", "baseColor": {"type": "rgb", "value": [0, 0, 0]}}],
  "objects": [
    {"name": "lamp", "type": "ply", "relativePath": "lamp.ply", "material": "lamp",
     "emission": {"type": "rgb", "unit": "radiance", "value": [10, 10, 10]}},
    {"name": "walls", "type": "trimesh", "material": "wall",
     "vertices": [-1,-1,-1, 1,-1,-1, 1,1,-1, -1,1,-1, -1,-1,1, 1,-1,1, 1,1,1, -1,1,1],
     "indices": [0,1,2, 0,2,3, 4,6,5, 4,7,6, 0,3,7, 0,7,4, 1,5,6, 1,6,2, 0,4,5, 0,5,1, 3,2,6, 3,6,7]}]
}
JSON
}

# run AXIS VALUE SCENE SIZE THREADS [--set …]: one line for each method.
run() {
  local axis=$1 value=$2 scene=$3 size=$4 threads=$5
  shift 5
  local method
  for method in bdpt vcm; do
    "$misbench" render "$scene" --method "$method" --spp "$samples" --size "$size" \
      --threads "$threads" "$@" --json -o "$work/image.exr" 2>"$work/log" |
      awk -v head="$axis\t$value\t$(basename "$scene" .json)\t$method" -F '[:,]' '
        /"(cpu_seconds|wall_seconds|rays|peak_memory_bytes)"/ { gsub(/[ "]/, "", $1); v[$1] = $2 }
        END { printf "%s\t%.3f\t%.3f\t%.2f\t%.0f\n", head, v["cpu_seconds"], v["wall_seconds"],
                     v["rays"] / 1e6, v["peak_memory_bytes"] / 1e6 }'
  done
}

printf 'axis\tvalue\tscene\tmethod\tcpu_seconds\twall_seconds\tmillion_rays\tpeak_memory_mb\n'
for scene in VeachBidir ModernHall DiningRoom2; do
  for size in 160x120 320x240 640x480 1280x960; do run image "$size" "$scene" "$size" 1; done
  for n in 1 2; do run threads "$n" "$scene" 640x480 "$n"; done
  for n in 2 4 8 16 32; do run max_depth "$n" "$scene" 320x240 1 --set max_depth="$n" --set rr_depth=0; done
  for n in 0 0.25 1 4; do run light_paths "$n" "$scene" 320x240 1 --set light_paths="$n"; done
done
for n in 1 100 10000 1000000; do
  write_box "$work/$n" "$n"
  run lights "$((2 * n))" "$work/$n/box.json" 320x240 1
done
