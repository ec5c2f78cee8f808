# The same programs by pkg-config and a plain compiler, shared and static.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
folder=$PACKAGE_WORK/pkg_config
new_folder "$folder"
export PKG_CONFIG_PATH=$libdir/pkgconfig
for precision in "${precisions[@]}"; do
  suffix=$(suffix_of "$precision")
  module=softpoint-elastic$suffix
  [ "$(pkg-config --modversion "$module")" = "$(pkg-config --modversion "softpoint-core$suffix")" ] || fail "versions"
  defines=$(pkg-config --cflags "$module")
  [ "$precision" = float32 ] || grep -q BT_USE_DOUBLE_PRECISION <<<"$defines" || fail "no BT_USE_DOUBLE_PRECISION"
done
# One compilation, of the last precision; it serves both kinds of library.
bytes=4; [ "$precision" = float64 ] && bytes=8
# shellcheck disable=SC2046  # lists of options
"$CXX" -std=c++20 -DEXPECTED_SCALAR_BYTES=$bytes -c "$here/apps/elastic_app.cpp" $(pkg-config --cflags "$module") -o "$folder/app.o"
if has shared "${linkages[@]}"; then
  "$CXX" "$folder/app.o" $(pkg-config --libs "$module") -Wl,-rpath,"$libdir" -o "$folder/shared"
  "$folder/shared"
  if pkg-config --libs "$module" | grep -E 'tinyobj|OSMesa|png'; then fail "private libraries are shown"; fi
fi
if has static "${linkages[@]}"; then
  # Where both kinds are installed the linker takes the shared one unless it is given the archive's name.
  libraries=$(pkg-config --static --libs "$module" | sed -E 's/-l(softpoint-[^ ]*)/-l:lib\1.a/g')
  # shellcheck disable=SC2086
  "$CXX" "$folder/app.o" $libraries -o "$folder/static"
  if ldd "$folder/static" | grep libsoftpoint; then fail "the shared library was linked"; fi
  "$folder/static"
  grep -q -e -ltinyobjloader_double <<<"$libraries" || fail "--static does not name the private libraries"
fi
