# A shared library shows our own names and no others, and none of what its folder src keeps to itself.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
has shared "${linkages[@]}" || skip "no shared libraries"
for precision in "${precisions[@]}"; do
  for plugin in "${plugins[@]}"; do
    library=$libdir/libsoftpoint-$plugin$(suffix_of "$precision").so
    shown=$(nm -DC --defined-only "$library" | cut -d' ' -f3-)
    [ "$(wc -l <<<"$shown")" -gt 10 ] || fail "$library shows next to nothing"
    if foreign=$(grep -Ev "^((vtable|typeinfo|typeinfo name) for |(non-virtual )?(virtual )?thunk to )?softpoint::abi_$precision::" <<<"$shown"); then
      fail "$library shows: $foreign"
    fi
    # Internals by name: contact search, kernels, shaders, the parts behind the public classes.
    if inner=$(grep -E '::(Impl|ContactFinder|ContactSolver|SolverTap|kernels_|gl|GlContext|assemble_)' <<<"$shown" |
      grep -v '::assemble_stiffness('); then
      fail "$library shows internals: $inner"
    fi
  done
  # What must cross the border for catch and dynamic_cast.
  shown=$(nm -DC --defined-only "$libdir/libsoftpoint-core$(suffix_of "$precision").so")
  for name in Error Surface Deformable; do
    grep -q " typeinfo for softpoint::abi_$precision::$name$" <<<"$shown" || fail "no typeinfo of $name"
  done
done

# Every function and class of the headers is marked, or a program could link the static library only. (StageTimer is all inline.)
cd "$prefix/include"
unmarked=$(find . -name '*.h' -exec awk '
  /^namespace softpoint/ { inside = 1 }
  /^}  \/\/ namespace/ { inside = 0 }
  inside && /^[A-Za-z].*\(/ && !/^(SOFTPOINT_API|inline|constexpr|template|static_assert|struct|class|enum|using|namespace)[ (]/
  inside && /^class [A-Za-z]+.*[^;]$/ && !/^class (SOFTPOINT_API|StageTimer) /' {} +)
[ -z "$unmarked" ] || fail "without SOFTPOINT_API: $unmarked"
