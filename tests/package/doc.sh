# The pages of the public headers, by Doxygen: a name without a comment, or a comment about nothing, is an error.
# Full tier only.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
full_tier || skip "full tier only"
command -v doxygen >/dev/null || skip "doxygen is not installed"
folder=$PACKAGE_WORK/doc
new_folder "$folder"
cd "$PACKAGE_SOURCE"
{
  cat plugins/doc/Doxyfile
  echo "OUTPUT_DIRECTORY = $folder"
} | doxygen - >"$folder/log" 2>&1 || { cat "$folder/log" >&2; fail "doxygen"; }
[ ! -s "$folder/log" ] || { cat "$folder/log" >&2; fail "doxygen is not silent"; }
for page in classsoftpoint_1_1DeformableSystem classsoftpoint_1_1elastic_1_1ElasticBody \
  classsoftpoint_1_1picture_1_1Renderer; do
  [ -f "$folder/html/$page.html" ] || fail "there is no page $page"
done
