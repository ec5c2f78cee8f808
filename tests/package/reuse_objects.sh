# A compiler launcher: copies what the main build has compiled already of this project's own sources (alone, or several
# in one), and runs the compiler for all else.
#   bash reuse_objects.sh <compiler> <option>...
set -euo pipefail
source_file= object= depfile= suffix= previous=
for argument in "$@"; do
  case $previous in
    -o) object=$argument ;;
    -c) source_file=$argument ;;
    -MF) depfile=$argument ;;
  esac
  [ "$argument" = -DBT_USE_DOUBLE_PRECISION ] && suffix=-float64
  previous=$argument
done
relative=${source_file#"$PACKAGE_SOURCE/plugins/"}
if [ "$relative" != "$source_file" ]; then
  plugin=${relative%%/*}
  made=$PACKAGE_BUILD/plugins/$plugin/CMakeFiles/softpoint-$plugin$suffix-objects.dir/${relative#*/}.o
else
  made=
  case $source_file in
    */softpoint-*-objects.dir/Unity/unity_*.cxx)
      together=$PACKAGE_BUILD/plugins/${source_file##*/softpoint/plugins/}
      cmp -s "$together" "$source_file" && made=$together.o ;;
  esac
fi
if [ -n "$made" ] && [ -f "$made" ]; then
  cp "$made" "$object"
  [ -z "$depfile" ] || printf '%s:\n' "$object" >"$depfile"
  exit 0
fi
exec "$@"
