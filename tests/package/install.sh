# cmake --install, and that what it lays down does not know where it was built.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
new_folder "$PACKAGE_WORK"
quietly "$CMAKE" --install "$PACKAGE_BUILD" --prefix "$prefix"
[ -n "$(find "$prefix" -name LICENSE)" ] || fail "the licence is not installed"
for precision in "${precisions[@]}"; do
  for plugin in "${plugins[@]}"; do
    name=softpoint-$plugin$(suffix_of "$precision")
    [ -e "$libdir/pkgconfig/$name.pc" ] || fail "$name.pc is not installed"
    if has static "${linkages[@]}"; then [ -e "$libdir/lib$name.a" ] || fail "lib$name.a is not installed"; fi
    if has shared "${linkages[@]}"; then
      [ "$(readlink "$libdir/lib$name.so")" = "lib$name.so.$PACKAGE_VERSION" ] || fail "lib$name.so is no link to its soname"
    fi
  done
done
if grep -rIlF -e "$PACKAGE_BUILD" -e "$PACKAGE_SOURCE" "$libdir/cmake" "$libdir/pkgconfig" "$prefix/include"; then
  fail "these files name the folder they were built in"
fi
if find "$prefix/include" -name '*-inl.h' -o -name '*_impl.h' | grep .; then fail "internal headers are installed"; fi
