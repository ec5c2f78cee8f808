# Sourced by the other scripts, which tests/package/CMakeLists.txt runs with PACKAGE_... set.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
prefix=$PACKAGE_WORK/prefix
apps=$PACKAGE_WORK/apps
libdir=$prefix/$PACKAGE_LIBDIR
read -ra plugins <<<"$PACKAGE_PLUGINS"
read -ra precisions <<<"$PACKAGE_PRECISIONS"
read -ra linkages <<<"$PACKAGE_LINKAGES"

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}
skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}
has() { # element list...
  local element=$1 other
  shift
  for other in "$@"; do [ "$other" = "$element" ] && return 0; done
  return 1
}
# Runs a command that must succeed; its output appears only if it does not.
quietly() {
  local log
  log=$(mktemp)
  if ! "$@" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    fail "$*"
  fi
  rm -f "$log"
}
suffix_of() { [ "$1" = float64 ] && echo -float64 || true; }
new_folder() {
  rm -rf "$1"
  mkdir -p "$1"
}
# The tier that compiles the libraries anew.
full_tier() { [ -n "${SOFTPOINT_TEST_FULL:-}" ]; }
