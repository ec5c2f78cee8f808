# Every plugin, precision and kind of library through find_package: configured, compiled, run. Static and shared
# must print the same numbers.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
new_folder "$apps"
quietly "$CMAKE" -S "$here/apps" -B "$apps" -G "$PACKAGE_GENERATOR" -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_PREFIX_PATH="$prefix" \
  "-DLINKAGES=${PACKAGE_LINKAGES// /;}" "-DPLUGINS=${PACKAGE_PLUGINS// /;}" "-DPRECISIONS=${PACKAGE_PRECISIONS// /;}"
quietly "$CMAKE" --build "$apps" -j 2
count=0
for precision in "${precisions[@]}"; do
  for plugin in "${plugins[@]}"; do
    first=
    for linkage in "${linkages[@]}"; do
      name=$plugin$(suffix_of "$precision")-$linkage
      arguments=()
      if [ "$plugin" = picture ]; then arguments=("$apps/$name.png"); fi
      printed=$("$apps/bin/$name" "${arguments[@]}") || fail "$name"
      printf '%s:\n%s\n' "$name" "$printed"
      first=${first:-$printed}
      [ "$printed" = "$first" ] || fail "static and shared print different numbers"
      count=$((count + 1))
    done
  done
done
[ "$count" = $((${#plugins[@]} * ${#precisions[@]} * ${#linkages[@]})) ] || fail "$count programs were run"
