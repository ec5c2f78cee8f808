# Doxygen reads `///`; this project writes plain `//`. A comment after code belongs to what stands before it.
s|^([[:space:]]*)//([^/]?)|\1///\2|
/^[[:space:]]*\/\//! s|[[:space:]]//[[:space:]]| ///< |
# Doxygen's parser knows no inline namespace within a nested one.
s|^(namespace softpoint)::inline SOFTPOINT_ABI|\1|
