# Sourced by examples/run.sh and tests/run.sh: packages, configuring, building. Bash.

softpoint_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# Debian 12 packages without which nothing here builds.
softpoint_required=(
  g++ cmake ninja-build pkg-config
  libbullet-dev libeigen3-dev libtinyobjloader-dev libfcl-dev
  nlohmann-json3-dev libcli11-dev libfmt-dev
  libosmesa6-dev libpng-dev
)
softpoint_required_for_tests=(libgtest-dev)
# Packages that only add something.
softpoint_optional=(liburdfdom-dev ffmpeg libegl-dev libegl-mesa0 libgl1-mesa-dri)
softpoint_optional_for_full_tests=(doxygen clang libclang-rt-14-dev libxsmm-dev)

say() { printf '%s\n' "softpoint: $*"; }

softpoint_missing() {
  local package
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || printf '%s ' "$package"
  done
}

# softpoint_install <required|optional> <package>...: installs what is missing, or prints the one line that would
# and (for required ones) stops.
softpoint_install() {
  local kind=$1 missing prefix=()
  shift
  if ! command -v dpkg-query >/dev/null; then
    say "this is no Debian system: packages are not checked (wanted: $*)"
    return 0
  fi
  missing=$(softpoint_missing "$@")
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" != 0 ]; then
    if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
      prefix=(sudo -n)
    elif [ "$kind" = optional ]; then
      say "not installed, going on without: $missing"
      return 0
    else
      say "packages are missing; as root, run:"
      printf '  apt-get update && apt-get install -y --no-install-recommends %s\n' "$missing"
      exit 1
    fi
  fi
  say "installing $missing"
  # shellcheck disable=SC2086  # a list of package names
  if ! { "${prefix[@]}" apt-get update -qq &&
         "${prefix[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing; } \
       >"${TMPDIR:-/tmp}/softpoint-apt.$$.log" 2>&1; then
    tail -n 20 "${TMPDIR:-/tmp}/softpoint-apt.$$.log"
    [ "$kind" = optional ] && { say "could not be installed, going on without: $missing"; return 0; }
    say "apt-get failed"
    exit 1
  fi
  rm -f "${TMPDIR:-/tmp}/softpoint-apt.$$.log"
}

# softpoint_build <folder> <cmake option>...: configures and builds, with a line now and then.
softpoint_build() {
  softpoint_build_target all "$@"
}

# softpoint_build_target <target> <folder> <cmake option>...: the same for one target.
softpoint_build_target() {
  local target=$1 folder=$2 started=$SECONDS
  shift 2
  say "configuring in $folder"
  if ! cmake -S "$softpoint_root" -B "$folder" -G Ninja "$@" >"$folder.configure.log" 2>&1; then
    cat "$folder.configure.log"
    rm -f "$folder.configure.log"
    say "cmake failed"
    exit 1
  fi
  rm -f "$folder.configure.log"
  say "building with $(nproc) jobs"
  if [ -t 1 ]; then
    cmake --build "$folder" --target "$target" -j "$(nproc)" || { say "the build failed"; exit 1; }
  else
    # One line in ten, and everything that is not progress (warnings, errors).
    cmake --build "$folder" --target "$target" -j "$(nproc)" | awk '!/^\[[0-9]+\/[0-9]+\]/ || ++n % 10 == 0 { print; fflush() }'
    [ "${PIPESTATUS[0]}" = 0 ] || { say "the build failed"; exit 1; }
  fi
  say "built in $((SECONDS - started)) s"
}
