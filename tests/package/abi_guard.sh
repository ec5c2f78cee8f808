# A program for one precision of Bullet must not link with our library for the other: most of Bullet's own
# soft-body symbols are spelt the same in both.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ ${#precisions[@]} = 2 ] || skip "one precision only"
folder=$PACKAGE_WORK/abi_guard
new_folder "$folder"
for linkage in "${linkages[@]}"; do
  for precision in float32 float64; do
    suffix=$(suffix_of "$precision")
    other=-float64; [ "$precision" = float64 ] && other=
    object=$(find "$apps" -path "*/elastic$suffix-objects.dir/*" -name '*.o')
    [ -f "$object" ] || fail "no object of the elastic program: $object"
    # link <suffix of our library>: with the Bullet of that library, as a careless build file would.
    link() {
      local extension=so
      [ "$linkage" = static ] && extension=a
      # shellcheck disable=SC2046  # a list of options
      "$CXX" "$object" -L"$libdir" -Wl,-rpath-link,"$libdir" "-l:libsoftpoint-elastic$1.$extension" \
        "-l:libsoftpoint-core$1.$extension" $(pkg-config --libs "bullet$1" tinyobjloader_double) -o "$folder/program"
    }
    link "$suffix" || fail "the program links with its own precision"
    if link "$other" 2>"$folder/log"; then fail "a $precision program links with the other precision ($linkage)"; fi
    grep -q "undefined reference to .softpoint::abi_$precision::" "$folder/log" || fail "$(cat "$folder/log")"
  done
done
