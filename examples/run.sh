#!/usr/bin/env bash
# Installs what is missing, builds, plays the main scenes and leaves pictures in out/.
#   bash examples/run.sh [SCENE.json...]   other scenes instead of the main ones
set -euo pipefail
# shellcheck source=../plugins/packages.sh
source "$(dirname "${BASH_SOURCE[0]}")/../plugins/packages.sh"

scenes=()
for scene in "$@"; do
  scenes+=("$(realpath -- "$scene")")
done
cd "$softpoint_root"
started=$SECONDS
softpoint_install required "${softpoint_required[@]}"
softpoint_install optional "${softpoint_optional[@]}"
softpoint_build build -DCMAKE_BUILD_TYPE=Release -DSOFTPOINT_TESTS=OFF -DSOFTPOINT_EXAMPLES=ON

if [ ${#scenes[@]} = 0 ]; then
  scenes=("$softpoint_root"/examples/scenes/*.json)
fi

rows=()
row() { rows+=("$(printf '%-22s %-8s %s' "$1" "$2" "$3")"); }
row build done "programs in build/bin"

video=()
if command -v ffmpeg >/dev/null; then
  video=(--video)
else
  row videos skipped "no ffmpeg program here: pictures only"
fi

mkdir -p out
status=0
for scene in "${scenes[@]}"; do
  name=$(basename "$scene" .json)
  say "playing $name"
  mkdir -p "out/$name"
  if build/bin/softpoint play "$scene" --out "out/$name" --metrics "out/$name/metrics.json" "${video[@]}"; then
    row "$name" played "out/$name ($(find "out/$name" -name '*.png' | wc -l) pictures$(
      find "out/$name" -name '*.mp4' -printf ', %f'))"
  else
    row "$name" FAILED "see the message above"
    status=1
  fi
done
say "playing hello_elastic"
if build/bin/hello_elastic >out/hello_elastic.txt; then
  row hello_elastic played "out/hello_elastic.txt"
else
  row hello_elastic FAILED "see out/hello_elastic.txt"
  status=1
fi

printf '\n%-22s %-8s %s\n' what state where
printf '%s\n' "${rows[@]}"
say "done in $((SECONDS - started)) s"
exit $status
