# What find_package says to wishes that the installation cannot meet, and how the kind of library is chosen.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
folder=$PACKAGE_WORK/find_package
new_folder "$folder"
mkdir "$folder/aside"
cp -r "$prefix" "$folder/prefix"
package=$folder/prefix/$PACKAGE_LIBDIR/cmake/softpoint

# ask <lines of CMake>: a project of these lines, with policies of old; its output in $said.
ask() {
  rm -rf "$folder/project"
  mkdir "$folder/project"
  printf 'cmake_minimum_required(VERSION 3.5)\nproject(p LANGUAGES NONE)\n%s\n' "$1" >"$folder/project/CMakeLists.txt"
  # CMake breaks long messages into lines.
  said=$("$CMAKE" -S "$folder/project" -B "$folder/project/build" -G "$PACKAGE_GENERATOR" \
    -DCMAKE_PREFIX_PATH="$folder/prefix" 2>&1) && answer=yes || answer=no
  said=$(tr -s ' \n' ' ' <<<"$said")
}
accepts() { ask "$1"; [ $answer = yes ] || fail "$1"$'\n'"$said"; }
refuses() { # lines, what the message must say
  ask "$1"
  [ $answer = no ] || fail "not refused: $1"
  grep -qF -- "$2" <<<"$said" || fail "$1"$'\n'"does not say '$2' but: $said"
}
kind() { # lines, expected TYPE
  accepts "$1"$'\nget_target_property(type softpoint::core'"$(suffix_of "${precisions[0]}")"$' TYPE)\nmessage(STATUS "kind ${type}")'
  grep -qF "kind $2" <<<"$said" || fail "$1"$'\n'"expected $2: $said"
}
core=core$(suffix_of "${precisions[0]}")

accepts 'find_package(softpoint 0.1 REQUIRED)'
accepts "find_package(softpoint 0.1.0 REQUIRED COMPONENTS $core)"
refuses 'find_package(softpoint 0.2 REQUIRED)' 'version: 0.1'
refuses 'find_package(softpoint 1.0 REQUIRED)' 'version: 0.1'
refuses 'find_package(softpoint 0.0 REQUIRED)' 'version: 0.1'
refuses 'find_package(softpoint 0.1 REQUIRED COMPONENTS clay)' "component 'clay' is not installed"
accepts "find_package(softpoint 0.1 REQUIRED COMPONENTS $core OPTIONAL_COMPONENTS clay)
if(softpoint_clay_FOUND OR NOT softpoint_${core}_FOUND)
  message(FATAL_ERROR wrong)
endif()"
refuses "find_package(softpoint 0.1 REQUIRED COMPONENTS $core)
find_package(PkgConfig REQUIRED)
set(ENV{PKG_CONFIG_LIBDIR} /nonexistent)
find_package(softpoint 0.1 REQUIRED COMPONENTS clay)" "component 'clay'"
refuses "set(ENV{PKG_CONFIG_LIBDIR} /nonexistent)
find_package(softpoint 0.1 REQUIRED COMPONENTS $core)" "needs the pkg-config module 'bullet"

# A library that is missing takes with it the components that need it, and no others.
if has static "${linkages[@]}" && has picture "${plugins[@]}"; then
  mkdir "$folder/modules"
  for module in bullet bullet-float64 tinyobjloader_double; do
    cp "$(pkg-config --variable=pcfiledir "$module")/$module.pc" "$folder/modules"
  done
  picture=${core/core/picture}
  lines="set(softpoint_SHARED OFF)
set(ENV{PKG_CONFIG_LIBDIR} $folder/modules)
find_package(softpoint 0.1 REQUIRED"
  refuses "$lines COMPONENTS $core $picture)" "component '$picture' (static) needs the pkg-config module"
  accepts "$lines COMPONENTS $core OPTIONAL_COMPONENTS $picture)
if(softpoint_${picture}_FOUND OR TARGET softpoint::$picture OR NOT TARGET softpoint::$core)
  message(FATAL_ERROR wrong)
endif()"
fi

if [ ${#precisions[@]} = 2 ]; then
  # The other precision comes along, and does no harm where it is not there.
  accepts 'find_package(softpoint 0.1 REQUIRED COMPONENTS elastic)
if(NOT TARGET softpoint::elastic-float64 OR NOT softpoint_elastic-float64_FOUND OR TARGET softpoint::picture)
  message(FATAL_ERROR wrong)
endif()'
  mv "$package"/softpoint-*-float64-* "$folder/aside"
  refuses 'find_package(softpoint 0.1 REQUIRED COMPONENTS elastic-float64)' "component 'elastic-float64' is not installed"
  accepts 'find_package(softpoint 0.1 REQUIRED COMPONENTS elastic)
if(TARGET softpoint::elastic-float64 OR softpoint_elastic-float64_FOUND)
  message(FATAL_ERROR wrong)
endif()'
  mv "$folder/aside"/* "$package"
fi

if [ ${#linkages[@]} = 2 ]; then
  find="find_package(softpoint 0.1 REQUIRED COMPONENTS $core)"
  kind "$find" SHARED_LIBRARY
  kind "set(BUILD_SHARED_LIBS OFF)
$find" STATIC_LIBRARY
  kind "set(BUILD_SHARED_LIBS ON)
$find" SHARED_LIBRARY
  kind "set(BUILD_SHARED_LIBS ON)
set(softpoint_SHARED OFF)
$find" STATIC_LIBRARY
  refuses "set(softpoint_SHARED OFF)
$find
set(softpoint_SHARED ON)
$find" "is in use as static library"
  # An installation of one kind only: a preference gives way, a demand does not.
  mv "$package"/softpoint-*-shared* "$folder/aside"
  kind "set(BUILD_SHARED_LIBS ON)
$find" STATIC_LIBRARY
  refuses "set(softpoint_SHARED ON)
$find" "component '$core' is not installed as shared library"
fi
