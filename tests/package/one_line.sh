# The folders of two plugins copied into an application and compiled by one line of g++, without CMake and without
# flags of their own for the kernels. The short tier compiles what such a line could spoil (kernels with their
# instruction sets, the file that wants a macro, the choice between them) and takes the rest from the library; the
# full tier runs the whole line, as it stands in README.md.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
folder=$PACKAGE_WORK/one_line
new_folder "$folder"
cp -r "$PACKAGE_SOURCE/plugins" "$folder"
cp "$here/apps/elastic_app.cpp" "$folder/app.cpp"
cp "$here/apps/app.h" "$folder"
cd "$folder"

check() {
  ./app >printed || fail "the program"
  cat printed
  # Other optimisation, so other roundings: the numbers agree to a micrometre.
  height() { sed -nE 's/^height ([0-9.]+) m.*/\1/p'; }
  awk -v a="$(height <printed)" -v b="$("$apps/bin/elastic$1-${linkages[0]}" | height)" \
    'BEGIN { exit !(a > 0 && (a - b) ^ 2 < 1e-12) }' || fail "other numbers than the library's"
}

if full_tier; then
  line=$(sed -n '/^g++ -std=c++20 .*plugins\/elastic/p' "$PACKAGE_SOURCE/README.md")
  [ "$(wc -l <<<"$line")" = 1 ] || fail "README.md holds no such line, or several"
  printf '%s\n' "$line"
  bash -c "$line"
  check ""
  exit
fi
has static "${linkages[@]}" || skip "the short tier needs the static libraries"
precision=${precisions[0]}
suffix=$(suffix_of "$precision")
sources=(app.cpp plugins/core/src/obj.cpp plugins/elastic/src/kernels_*.cpp plugins/elastic/src/instruction_set.cpp)
[ ${#sources[@]} = 6 ] || fail "unexpected kernels: ${sources[*]}"
# shellcheck disable=SC2046  # lists of options
g++ -std=c++20 -O1 -Iplugins/core/include -Iplugins/elastic/include "${sources[@]}" -o app \
  "$libdir/libsoftpoint-elastic$suffix.a" "$libdir/libsoftpoint-core$suffix.a" \
  $(pkg-config --cflags --libs "bullet$suffix" eigen3 tinyobjloader_double)
check "$suffix"
