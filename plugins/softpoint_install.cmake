# What `cmake --install` lays down beside the headers, for find_package and for pkg-config.
#   lib/cmake/softpoint/softpoint-config.cmake            chooses and loads
#                       softpoint-<id>-<linkage>.cmake    what one library needs; <id>: elastic, elastic-float64
#                       softpoint-<id>-<linkage>-targets.cmake
#   lib/pkgconfig/softpoint-<id>.pc
# A library is installed if its files are there, so that installations with different options add up.
include(CMakePackageConfigHelpers)

set(softpoint_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/softpoint)
set(softpoint_package_sources ${PROJECT_SOURCE_DIR}/plugins/package)
set(softpoint_package_binaries ${PROJECT_BINARY_DIR}/package)

if(SOFTPOINT_INSTALL)
  write_basic_package_version_file(${softpoint_package_binaries}/softpoint-config-version.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${softpoint_package_sources}/softpoint-config.cmake
                ${softpoint_package_binaries}/softpoint-config-version.cmake
    DESTINATION ${softpoint_package_folder} COMPONENT core)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/third_party_notes.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT core)
endif()

# softpoint_install_library(<target> <id> <static|shared> <suffix> "<plugins>" "<private pkg-config modules>")
function(softpoint_install_library target id linkage suffix plugins private_modules)
  string(REPLACE "${suffix}" "" component ${id})
  list(TRANSFORM plugins APPEND "${suffix}")
  set(modules bullet${suffix})
  if(linkage STREQUAL "static")
    list(APPEND modules ${private_modules})
  endif()
  set(file softpoint-${id}-${linkage}.cmake)
  configure_file(${softpoint_package_sources}/softpoint-library.cmake.in ${softpoint_package_binaries}/${file} @ONLY)
  install(FILES ${softpoint_package_binaries}/${file} DESTINATION ${softpoint_package_folder} COMPONENT ${component})
  install(TARGETS ${target} EXPORT softpoint-${id}-${linkage}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component})
  install(EXPORT softpoint-${id}-${linkage}
    FILE softpoint-${id}-${linkage}-targets.cmake
    NAMESPACE softpoint::
    DESTINATION ${softpoint_package_folder} COMPONENT ${component})
endfunction()

# softpoint_install_pkgconfig(<name> <suffix> "<plugins>" "<private pkg-config modules>" "<private libraries>")
function(softpoint_install_pkgconfig name suffix plugins private_modules private_libraries)
  list(TRANSFORM plugins REPLACE "(.+)" "softpoint-\\1${suffix}")
  set(requires ${plugins} bullet${suffix} "eigen3 >= 3.4")
  set(requires_private ${private_modules})
  list(TRANSFORM private_libraries PREPEND " -l")
  list(JOIN private_libraries "" libs_private)
  set(libs "")
  set(cflags "")
  set(cflags_private " -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16")
  if(NOT "shared" IN_LIST SOFTPOINT_LINKAGE)  # nobody need say --static
    list(APPEND requires ${requires_private})
    set(requires_private)
    set(libs "${libs_private}")
    set(cflags "${cflags_private}")
  endif()
  list(JOIN requires ", " requires)
  list(JOIN requires_private ", " requires_private)
  if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
    set(prefix ${CMAKE_INSTALL_PREFIX})
    set(libdir ${CMAKE_INSTALL_LIBDIR})
  else()
    file(RELATIVE_PATH prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
    string(REGEX REPLACE "/$" "" prefix "\${pcfiledir}/${prefix}")
    set(libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
  endif()
  set(file softpoint-${name}${suffix}.pc)
  configure_file(${softpoint_package_sources}/softpoint.pc.in ${softpoint_package_binaries}/${file} @ONLY)
  install(FILES ${softpoint_package_binaries}/${file}
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${name})
endfunction()
