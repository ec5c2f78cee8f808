# One library per plugin and per Bullet precision:
#   softpoint::core           btScalar is float   (Debian's package `bullet`)
#   softpoint::core-float64   btScalar is double  (Debian's package `bullet-float64`)
# Each is compiled once and made into a static library (target softpoint-core), a shared one
# (softpoint-core-shared), or both; softpoint::core is the shared one only where BUILD_SHARED_LIBS asks
# for it or there is no other.
include(GNUInstallDirs)
include(softpoint_install)

# What is found here must be visible where the libraries are linked, which may be another folder.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
find_package(PkgConfig REQUIRED)
if(NOT TARGET Eigen3::Eigen)
  find_package(Eigen3 3.4 REQUIRED NO_MODULE)
endif()

# softpoint_find_module(<pkg-config module> [REQUIRED|QUIET]): the imported target that
# softpoint_module_target() names.
macro(softpoint_find_module module)
  string(MAKE_C_IDENTIFIER "softpoint_${module}" softpoint_prefix)
  pkg_check_modules(${softpoint_prefix} ${ARGN} IMPORTED_TARGET GLOBAL ${module})
endmacro()
function(softpoint_module_target module out)
  string(MAKE_C_IDENTIFIER "softpoint_${module}" prefix)
  set(${out} PkgConfig::${prefix} PARENT_SCOPE)
endfunction()

# softpoint_suffix(<precision> <variable>): "" for float32, "-float64" for float64: that of our libraries
# and of Bullet's.
function(softpoint_suffix precision out)
  if(precision STREQUAL "float32")
    set(${out} "" PARENT_SCOPE)
  else()
    set(${out} "-${precision}" PARENT_SCOPE)
  endif()
endfunction()

foreach(precision IN LISTS SOFTPOINT_PRECISIONS)
  if(NOT precision MATCHES "^float(32|64)$")
    message(FATAL_ERROR "SOFTPOINT_PRECISIONS holds '${precision}'; permitted: float32, float64")
  endif()
  softpoint_suffix(${precision} suffix)
  softpoint_find_module(bullet${suffix} REQUIRED)
endforeach()

foreach(linkage IN LISTS SOFTPOINT_LINKAGE)
  if(NOT linkage MATCHES "^(static|shared)$")
    message(FATAL_ERROR "SOFTPOINT_LINKAGE holds '${linkage}'; permitted: static, shared")
  endif()
endforeach()
# Tests look at internals, which shared libraries hide.
set(softpoint_built_linkage ${SOFTPOINT_LINKAGE})
if(SOFTPOINT_TESTS AND NOT "static" IN_LIST softpoint_built_linkage)
  list(PREPEND softpoint_built_linkage static)
endif()
if("static" IN_LIST softpoint_built_linkage AND (SOFTPOINT_TESTS OR NOT BUILD_SHARED_LIBS
                                                 OR NOT "shared" IN_LIST softpoint_built_linkage))
  set(softpoint_default_linkage static)
else()
  set(softpoint_default_linkage shared)
endif()

# Warnings, floating-point contract and sanitizers shared by all our targets.
function(softpoint_compile_settings target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wpedantic -ffp-contract=off)
  target_compile_definitions(${target} PRIVATE EIGEN_MPL2_ONLY)
  set(visibility hidden)
  if(SOFTPOINT_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SOFTPOINT_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=undefined)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
    set(visibility default)  # UBSan compares the addresses of Bullet's type information
  endif()
  if(SOFTPOINT_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  set_target_properties(${target} PROPERTIES
    CXX_EXTENSIONS OFF
    UNITY_BUILD ${SOFTPOINT_UNITY}
    UNITY_BUILD_BATCH_SIZE ${SOFTPOINT_UNITY_BATCH}
    CXX_VISIBILITY_PRESET ${visibility}
    VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# softpoint_add_plugin(<name> SOURCES <file>... [PLUGINS <name>...] [PRIVATE_MODULES <pkg-config module>...]
#                      [PRIVATE_LIBRARIES <name>...] [PRIVATE_DEFINITIONS <definition>...])
# Libraries that only the sources need are named as modules of pkg-config, so that whoever links the installed
# static library finds them too; as plain libraries (-l) where the module asks for flags that nobody wants.
function(softpoint_add_plugin name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PLUGINS;PRIVATE_MODULES;PRIVATE_LIBRARIES;PRIVATE_DEFINITIONS" ${ARGN})
  set(private_libraries)
  foreach(module IN LISTS ARG_PRIVATE_MODULES)
    softpoint_find_module(${module} REQUIRED)
    softpoint_module_target(${module} library)
    list(APPEND private_libraries ${library})
  endforeach()
  list(APPEND private_libraries ${ARG_PRIVATE_LIBRARIES})
  # Eigen allocates in inline code, of which the linker keeps one copy: what is linked statically must agree
  # on the alignment, whatever instruction set the program is compiled for.
  set(alignment EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16)

  foreach(precision IN LISTS SOFTPOINT_PRECISIONS)
    softpoint_suffix(${precision} suffix)
    softpoint_module_target(bullet${suffix} bullet)
    set(id ${name}${suffix})
    set(objects softpoint-${id}-objects)
    list(TRANSFORM ARG_PLUGINS REPLACE "(.+)" "softpoint::\\1${suffix}" OUTPUT_VARIABLE others)

    add_library(${objects} OBJECT EXCLUDE_FROM_ALL ${ARG_SOURCES})
    target_include_directories(${objects} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/include ${CMAKE_CURRENT_SOURCE_DIR}/src)
    target_compile_definitions(${objects} PRIVATE ${alignment} ${ARG_PRIVATE_DEFINITIONS})
    target_link_libraries(${objects} PRIVATE ${others} ${bullet} Eigen3::Eigen ${private_libraries})
    set_target_properties(${objects} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    softpoint_compile_settings(${objects})

    foreach(linkage IN LISTS softpoint_built_linkage)
      set(target softpoint-${id})
      set(others ${ARG_PLUGINS})
      list(TRANSFORM others REPLACE "(.+)" "softpoint-\\1${suffix}")
      if(linkage STREQUAL "shared")
        string(APPEND target -shared)
        list(TRANSFORM others APPEND -shared)
        add_library(${target} SHARED $<TARGET_OBJECTS:${objects}>)
        set(map ${PROJECT_SOURCE_DIR}/plugins/softpoint.map)
        target_link_options(${target} PRIVATE LINKER:--version-script=${map} LINKER:-z,defs)
        set_target_properties(${target} PROPERTIES
          VERSION ${PROJECT_VERSION}
          SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
          LINK_DEPENDS ${map}
          INSTALL_RPATH $ORIGIN)
      else()
        add_library(${target} STATIC $<TARGET_OBJECTS:${objects}>)
        target_compile_definitions(${target} INTERFACE ${alignment})
      endif()
      softpoint_compile_settings(${target})
      target_include_directories(${target} INTERFACE
        $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
      target_link_libraries(${target} PUBLIC ${others} ${bullet} Eigen3::Eigen PRIVATE ${private_libraries})
      set_target_properties(${target} PROPERTIES
        LINKER_LANGUAGE CXX
        OUTPUT_NAME softpoint-${id}
        EXPORT_NAME ${id})
      if(NOT PROJECT_IS_TOP_LEVEL AND NOT SOFTPOINT_INSTALL)
        set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL ON)
      endif()
      if(linkage STREQUAL softpoint_default_linkage)
        add_library(softpoint::${id} ALIAS ${target})
      endif()
      if(SOFTPOINT_INSTALL AND linkage IN_LIST SOFTPOINT_LINKAGE)
        softpoint_install_library(${target} ${id} ${linkage} "${suffix}" "${ARG_PLUGINS}" "${ARG_PRIVATE_MODULES}")
      endif()
    endforeach()
    if(SOFTPOINT_INSTALL)
      softpoint_install_pkgconfig(${name} "${suffix}" "${ARG_PLUGINS}" "${ARG_PRIVATE_MODULES}" "${ARG_PRIVATE_LIBRARIES}")
    endif()
  endforeach()
  if(SOFTPOINT_INSTALL)
    install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${name})
  endif()
endfunction()
