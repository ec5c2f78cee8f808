# One library per plugin and per Bullet precision:
#   softpoint::core           btScalar is float   (Debian's package `bullet`)
#   softpoint::core-float64   btScalar is double  (Debian's package `bullet-float64`)
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

foreach(precision IN LISTS SOFTPOINT_PRECISIONS)
  if(precision STREQUAL "float32")
    pkg_check_modules(BULLET_float32 REQUIRED IMPORTED_TARGET bullet)
  elseif(precision STREQUAL "float64")
    pkg_check_modules(BULLET_float64 REQUIRED IMPORTED_TARGET bullet-float64)
  else()
    message(FATAL_ERROR "SOFTPOINT_PRECISIONS holds '${precision}'; permitted: float32, float64")
  endif()
endforeach()

# softpoint_suffix(<precision> <variable>): "" for float32, "-float64" for float64.
function(softpoint_suffix precision out)
  if(precision STREQUAL "float32")
    set(${out} "" PARENT_SCOPE)
  else()
    set(${out} "-${precision}" PARENT_SCOPE)
  endif()
endfunction()

# Warnings, floating-point contract and sanitizers shared by all our targets.
function(softpoint_compile_settings target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wpedantic -ffp-contract=off)
  if(SOFTPOINT_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SOFTPOINT_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=undefined)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
  set_target_properties(${target} PROPERTIES
    CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET default
    VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# softpoint_add_plugin(<name> SOURCES <file>... [PLUGINS <name>...] [PRIVATE_LIBRARIES <target>...])
function(softpoint_add_plugin name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PLUGINS;PRIVATE_LIBRARIES" ${ARGN})
  foreach(precision IN LISTS SOFTPOINT_PRECISIONS)
    softpoint_suffix(${precision} suffix)
    set(target softpoint-${name}${suffix})
    add_library(${target} ${ARG_SOURCES})
    add_library(softpoint::${name}${suffix} ALIAS ${target})
    target_include_directories(${target}
      PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
      PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
    target_link_libraries(${target} PUBLIC PkgConfig::BULLET_${precision} Eigen3::Eigen)
    foreach(other IN LISTS ARG_PLUGINS)
      target_link_libraries(${target} PUBLIC softpoint::${other}${suffix})
    endforeach()
    foreach(library IN LISTS ARG_PRIVATE_LIBRARIES)
      target_link_libraries(${target} PRIVATE ${library})
    endforeach()
    target_compile_definitions(${target} PUBLIC EIGEN_MPL2_ONLY EIGEN_MAX_ALIGN_BYTES=16
                                                EIGEN_MAX_STATIC_ALIGN_BYTES=16)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    softpoint_compile_settings(${target})
  endforeach()
endfunction()
