#!/usr/bin/env bash
# Installs what is missing, builds both Bullet precisions and passes every test.
#   bash tests/run.sh          the short tier
#   bash tests/run.sh --full   also long stress runs and everything again under ASan and UBSan
set -euo pipefail
# shellcheck source=../plugins/packages.sh
source "$(dirname "${BASH_SOURCE[0]}")/../plugins/packages.sh"

full=0
for argument in "$@"; do
  case $argument in
    --full) full=1 ;;
    *) say "unknown argument '$argument'; permitted is --full"; exit 2 ;;
  esac
done

cd "$softpoint_root"
started=$SECONDS
softpoint_install required "${softpoint_required[@]}" "${softpoint_required_for_tests[@]}"
softpoint_install optional "${softpoint_optional[@]}"
if [ $full = 1 ]; then
  softpoint_install optional "${softpoint_optional_for_full_tests[@]}"
fi

# Tests must neither read nor fill the cache of the user who runs them.
SOFTPOINT_CACHE_DIR=$(mktemp -d)
export SOFTPOINT_CACHE_DIR
trap 'rm -rf "$SOFTPOINT_CACHE_DIR"' EXIT

run_tests() {  # folder
  say "testing in $1"
  ctest --test-dir "$1" --output-on-failure -j "$(nproc)"
}

status=0
softpoint_build build -DCMAKE_BUILD_TYPE=Release -DSOFTPOINT_TESTS=ON -DSOFTPOINT_EXAMPLES=ON
if [ $full = 1 ]; then
  export SOFTPOINT_TEST_FULL=1
fi
run_tests build || status=1
if [ $full = 1 ]; then
  softpoint_build build-sanitize -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSOFTPOINT_SANITIZE=ON -DSOFTPOINT_TESTS=ON
  unset SOFTPOINT_TEST_FULL
  SOFTPOINT_TEST_SANITIZED=1 run_tests build-sanitize || status=1
fi
say "done in $((SECONDS - started)) s: $([ $status = 0 ] && echo 'every test passed' || echo 'tests FAILED')"
exit $status
