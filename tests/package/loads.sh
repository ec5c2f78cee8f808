# A program with elastic bodies alone loads neither a collision library nor an OpenGL one; one with pictures names
# the backends that were built (so the look would find them), no other, and no libGL.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
heavy='lib(fcl|ccd|octomap|OSMesa|EGL|GL|GLX|GLdispatch|OpenGL|glapi|LLVM|png|SDL2)[-.0-9]*so'
for precision in "${precisions[@]}"; do
  for linkage in "${linkages[@]}"; do
    for plugin in core elastic; do
      program=$apps/bin/$plugin$(suffix_of "$precision")-$linkage
      needed=$(readelf -d "$program" | grep NEEDED)
      loaded=$(ldd "$program")
      grep -q 'libLinearMath' <<<"$loaded" || fail "$program does not load Bullet?"
      if found=$(grep -E "$heavy" <<<"$needed"$'\n'"$loaded"); then fail "$program loads $found"; fi
      if grep -q 'not found' <<<"$loaded"; then fail "$program: $loaded"; fi
      # Bullet of one precision only.
      other=-float64; [ "$precision" = float64 ] && other=
      if grep -qE "libBulletCollision$other\.so" <<<"$loaded"; then fail "$program loads both precisions of Bullet"; fi
      if [ "$linkage" = static ] && grep -q libsoftpoint <<<"$loaded"; then fail "$program loads our shared library"; fi
      if [ "$linkage" = shared ] && ! grep -q libsoftpoint-core <<<"$loaded"; then fail "$program does not load our library"; fi
    done
    has picture "${plugins[@]}" || continue
    drawing=$apps/bin/picture$(suffix_of "$precision")-$linkage
    [ "$linkage" = static ] || drawing=$libdir/libsoftpoint-picture$(suffix_of "$precision").so
    needed=$(readelf -d "$drawing" | grep NEEDED)
    for backend in osmesa:libOSMesa egl:libEGL; do
      read -ra built <<<"$PACKAGE_BACKENDS"
      if has "${backend%:*}" "${built[@]}"; then
        grep -q "${backend#*:}\.so" <<<"$needed" || fail "$drawing does not need ${backend#*:}"
      elif grep -q "${backend#*:}\.so" <<<"$needed"; then
        fail "$drawing needs ${backend#*:}"
      fi
    done
    if grep -E 'lib(GL|GLX|OpenGL)\.so' <<<"$needed"; then fail "$drawing names libGL"; fi
  done
done
