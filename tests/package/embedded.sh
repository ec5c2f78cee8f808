# add_subdirectory: the application gets the libraries it links, compiled by its own settings, and nothing of its
# own is changed. What is compiled of our sources comes from the main build in the short tier.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ "$PACKAGE_GENERATOR" = Ninja ] || skip "reads what Ninja would do"
folder=$PACKAGE_WORK/embedded
precision=${precisions[0]}
suffix=$(suffix_of "$precision")

for linkage in static shared; do
  new_folder "$folder"
  # The full tier compiles the sources for the static libraries, each alone, as comes without asking.
  launcher="bash;$here/reuse_objects.sh"
  options=(-DSOFTPOINT_UNITY="$PACKAGE_UNITY")
  if full_tier && [ $linkage = static ]; then launcher= options=(); fi
  # Static is what comes without asking.
  [ $linkage = static ] || options+=(-DBUILD_SHARED_LIBS=ON)
  quietly "$CMAKE" -S "$here/embedded" -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$CXX" \
    -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DSOFTPOINT="$PACKAGE_SOURCE" \
    -DSUFFIX="$suffix" "${options[@]}"

  # What is built: the application, core and elastic in one precision, one kind.
  plan=$(ninja -C "$folder" -n -v)
  if found=$(grep -oE 'picture/src/[a-z_]+\.cpp|examples/[a-z_/]+\.cpp|[a-z_]+_test\.cpp' <<<"$plan"); then
    fail "built without need: $found"
  fi
  mapfile -t together < <(grep -oE '[^ ]+/Unity/unity_[0-9]+_cxx\.cxx( |$)' <<<"$plan" | tr -d ' ' | sort -u)
  compiled=$(cat - "${together[@]}" <<<"$plan" | grep -c 'plugins/core/src/.*\.cpp')
  sources=$(find "$PACKAGE_SOURCE/plugins/core/src" -name '*.cpp' | wc -l)
  [ "$compiled" -ge "$sources" ] && [ "$compiled" -lt $((2 * sources)) ] || fail "$compiled commands for $sources files of core"
  if grep -q -e -Werror <<<"$plan"; then fail "warnings are errors in somebody else's build"; fi

  # How the application is compiled: with the headers' folders and what Bullet's precision asks for.
  line=$(grep -F '"command"' "$folder/compile_commands.json" | grep -F elastic_app.cpp)
  if found=$(grep -oE -e ' -(W[a-z]|f[a-z]|O|D)[^ ]*' <<<"$line" |
    grep -vE -e '-(DBT_USE_DOUBLE_PRECISION|DEIGEN_MAX_(STATIC_)?ALIGN_BYTES=16)$'); then
    fail "the application is compiled with $found"
  fi

  # Cache: nothing but our own names, and where the packages were found.
  if found=$(grep -E '^[A-Za-z]' "$folder/CMakeCache.txt" |
    grep -vE '^(CMAKE_|SOFTPOINT_|SOFTPOINT:|softpoint_|PKG_CONFIG_|pkgcfg_lib_softpoint_|Eigen3_DIR|FIND_PACKAGE_MESSAGE_|SUFFIX|BUILD_SHARED_LIBS|__pkg_config_|prefix_result:INTERNAL)'); then
    fail "the cache of the application holds $found"
  fi
  grep -q '^CMAKE_BUILD_TYPE:STRING=$' "$folder/CMakeCache.txt" || fail "the build type of the application was chosen"

  quietly ninja -C "$folder" -j 2 app
  "$folder/app" >"$folder/printed" || fail "the application"
  cat "$folder/printed"
  cmp <("$apps/bin/elastic$suffix-${linkages[0]}") "$folder/printed" || full_tier || fail "other numbers than installed"
  loaded=$(ldd "$folder/app")
  case $linkage in
    static) ! grep -q libsoftpoint <<<"$loaded" || fail "$loaded" ;;
    shared) grep -q "libsoftpoint-elastic$suffix" <<<"$loaded" || fail "$loaded" ;;
  esac
  quietly "$CMAKE" --install "$folder" --prefix "$folder/prefix"
  [ ! -e "$folder/prefix" ] || [ -z "$(find "$folder/prefix" -type f)" ] || fail "installs files of ours"
done
