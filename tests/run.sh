#!/usr/bin/env bash
# Installs what is missing, builds both Bullet precisions and passes every test. tests/README.md tells more.
#   bash tests/run.sh               the short tier
#   bash tests/run.sh --full        all of it: the long tests, sanitizers, fuzzers
#   bash tests/run.sh --sanitizers  the tests under ASan and UBSan alone
#   bash tests/run.sh --fuzzers [SECONDS]  each fuzzer alone, for so long (60)
# A part that fails does not hide the others; the table at the end lists every part, and what was skipped and why.
set -uo pipefail
# shellcheck source=../plugins/packages.sh
source "$(dirname "${BASH_SOURCE[0]}")/../plugins/packages.sh"

tests=1 sanitizers=0 fuzzers=0 fuzz_seconds=60 full=0
case ${1:-} in
  '') ;;
  --full) full=1 sanitizers=1 fuzzers=1 ;;
  --sanitizers) tests=0 sanitizers=1 ;;
  --fuzzers) tests=0 fuzzers=1 fuzz_seconds=${2:-60} ;;
  *) say "unknown argument '$1'; permitted are --full, --sanitizers, --fuzzers [SECONDS]"; exit 2 ;;
esac
case $fuzz_seconds in
  '' | *[!0-9]*) say "--fuzzers '$fuzz_seconds': permitted is a whole number of seconds"; exit 2 ;;
esac

cd "$softpoint_root" || exit 1
# Tests must neither read nor fill the cache of the user who runs them; logs and finds are kept.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export SOFTPOINT_CACHE_DIR=$work/cache
mkdir -p "$SOFTPOINT_CACHE_DIR"

part_names=() part_seconds=() part_states=() status=0

# part <name> <command>...: runs it, and notes how that went.
part() {
  local name=$1 started=$SECONDS state=passed
  shift
  say "$name"
  ("$@") || { state=FAILED; status=1; }
  part_names+=("$name") part_seconds+=("$((SECONDS - started))") part_states+=("$state")
  [ $state = passed ]
}

# skip <name> <reason>
skip() {
  part_names+=("$1") part_seconds+=("-") part_states+=("skipped: $2")
}

# run_tests <folder> <name>: all tests that ctest knows there; which of them skipped something, and why.
run_tests() {
  local folder=$1 log=$work/$2.skipped code=0
  ctest --test-dir "$folder" --output-on-failure -j "$(nproc)" || code=1
  awk '
    /^[0-9]+\/[0-9]+ Test: / { test = $3 }
    /^skipped: / { print test ": " substr($0, 10) }                       # of a script
    /: Skipped$/ { getline reason }                                       # of a googletest
    /^\[  SKIPPED \] .*\(/ { print test ": " $4 ": " reason }
  ' "$folder/Testing/Temporary/LastTest.log" | sort -u >"$log"
  return "$code"
}

# run_fuzzer <name>: new inputs are not added to the kept corpus; what breaks it is kept in build-fuzz/findings.
run_fuzzer() {
  mkdir -p "$work/corpus/$1" build-fuzz/findings
  "build-fuzz/bin/fuzz_$1" -max_total_time="$fuzz_seconds" -timeout=20 -rss_limit_mb=2048 -max_len=4096 \
    -print_final_stats=1 -artifact_prefix="build-fuzz/findings/$1-" "$work/corpus/$1" "tests/fuzz/corpus/$1" \
    >"$work/fuzz-$1.log" 2>&1 || { tail -n 60 "$work/fuzz-$1.log"; return 1; }
  grep -E 'number_of_executed_units|DONE' "$work/fuzz-$1.log"
}

clang_fuzzes() {
  command -v clang++ >/dev/null || return 1
  echo 'extern "C" int LLVMFuzzerTestOneInput(const char*, unsigned long) { return 0; }' |
    clang++ -x c++ -fsanitize=fuzzer,address,undefined -o "$work/probe" - 2>/dev/null
}

# Long tests are ended later, instrumented ones too.
patience=(-DSOFTPOINT_TEST_TIMEOUT=1200)
[ $full$sanitizers = 00 ] || patience=(-DSOFTPOINT_TEST_TIMEOUT=7200)

part 'packages' softpoint_install required "${softpoint_required[@]}" "${softpoint_required_for_tests[@]}" || exit 1
softpoint_install optional "${softpoint_optional[@]}"
if [ $full = 1 ] || [ $fuzzers = 1 ]; then
  softpoint_install optional "${softpoint_optional_for_full_tests[@]}"
fi

if [ $tests = 1 ]; then
  if part 'build' softpoint_build build -DCMAKE_BUILD_TYPE=Release -DSOFTPOINT_TESTS=ON -DSOFTPOINT_EXAMPLES=ON \
    "${patience[@]}"; then
    # Nobody runs them here, but they are to compile.
    [ $full = 0 ] || part 'build of the benchmarks' softpoint_build_target softpoint_benchmarks build
    [ $full = 1 ] && export SOFTPOINT_TEST_FULL=1
    part 'tests' run_tests build tests
    unset SOFTPOINT_TEST_FULL
  else
    skip 'tests' 'the build failed'
  fi
fi

if [ $sanitizers = 1 ]; then
  # -O1 -g1: half the compilation time of -O2 -g, and a report still names the line.
  if part 'build with ASan and UBSan' softpoint_build build-sanitize -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO='-O1 -g1 -DNDEBUG' -DSOFTPOINT_SANITIZE=ON -DSOFTPOINT_TESTS=ON -DSOFTPOINT_EXAMPLES=ON "${patience[@]}"; then
    part 'tests under ASan and UBSan' run_tests build-sanitize sanitizers
  else
    skip 'tests under ASan and UBSan' 'the build failed'
  fi
elif [ $tests = 1 ]; then
  skip 'tests under ASan and UBSan' 'with --full or --sanitizers only'
fi

if [ $fuzzers = 1 ]; then
  if ! clang_fuzzes; then
    skip 'fuzzers' 'no clang++ with libFuzzer here (packages clang, libclang-rt-14-dev)'
  elif part 'build of the fuzzers' softpoint_build_target fuzzers build-fuzz -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSOFTPOINT_UNITY=OFF -DSOFTPOINT_FUZZ=ON -DSOFTPOINT_SANITIZE=ON -DSOFTPOINT_WERROR=OFF \
    -DSOFTPOINT_PRECISIONS=float32 -DSOFTPOINT_TESTS=ON -DSOFTPOINT_EXAMPLES=ON; then
    for file in tests/fuzz/*_fuzzer.cpp; do
      name=$(basename "$file" _fuzzer.cpp)
      part "fuzzer $name, $fuzz_seconds s" run_fuzzer "$name"
    done
  else
    skip 'fuzzers' 'their build failed'
  fi
elif [ $tests = 1 ]; then
  skip 'fuzzers' 'with --full or --fuzzers only; their kept inputs are among the tests'
fi

printf '\n%-32s %8s  %s\n' part seconds state
for i in "${!part_names[@]}"; do
  printf '%-32s %8s  %s\n' "${part_names[$i]}" "${part_seconds[$i]}" "${part_states[$i]}"
done
for list in "$work"/*.skipped; do
  if [ -s "$list" ]; then
    printf '\nskipped among the %s:\n' "$(basename "$list" .skipped)"
    sed 's/^/  /' "$list"
  fi
done
[ $full = 1 ] || [ $tests = 0 ] || printf '\nTests of the long tier ran in their short form: SOFTPOINT_TEST_FULL is set by --full.\n'
say "done in $SECONDS s: $([ $status = 0 ] && echo 'every part that ran passed' || echo 'FAILED')"
exit $status
