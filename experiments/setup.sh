# Shared by quickstart.sh and tests/run.sh, which source it: the packages, and the build.
# Works on Debian 12. Needs bash; run from anywhere.

source_folder="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

packages=(
  build-essential ccache cmake git ninja-build
  fonts-linuxlibertine libboost-dev libcairo2-dev libcli11-dev libeigen3-dev libembree-dev
  libgrpc++-dev libjs-chart.js libopenexr-dev libpango1.0-dev libpng-dev libprotobuf-dev
  libpugixml-dev librandom123-dev libspdlog-dev libsqlite3-dev libssl-dev libstb-dev libyaml-cpp-dev
  nlohmann-json3-dev pkg-config protobuf-compiler protobuf-compiler-grpc zlib1g-dev
  libbenchmark-dev libgmock-dev libgtest-dev
)

# Installs what is missing, and says so first.
install_packages() {
  local missing=()
  local name
  for name in "${packages[@]}"; do
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" != installed ]; then
      missing+=("$name")
    fi
  done
  [ ${#missing[@]} -eq 0 ] && return
  local sudo=()
  [ "$(id -u)" -eq 0 ] || sudo=(sudo)
  echo "Installing from apt: ${missing[*]}"
  "${sudo[@]}" apt-get update
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "${missing[@]}"
}

# build_preset PRESET [TARGET...]
build_preset() {
  local preset=$1
  shift
  (
    cd "$source_folder"
    cmake --preset "$preset"
    cmake --build --preset "$preset" ${1:+--target "$@"}
  )
}
