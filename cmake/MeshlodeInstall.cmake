# SPDX-License-Identifier: GPL-3.0-or-later
# What an installed meshlode offers: the program, and for find_package(meshlode)
#   meshlode::runtime  static, MIT: read, unpack, select, decode behind <meshlode/runtime.h>. Needs nothing but the C and
#                      C++ runtime (and zstd, lz4 where the codecs are built in).
#   meshlode::c        shared, MIT: the same behind <meshlode/meshlode.h>, for C. Its C++ runtime is inside; what it needs
#                      is libc (and zstd, lz4).
#   meshlode::build    shared, GPL-3.0-or-later: the builder behind <meshlode/build.h>. Shared, so that its third-party
#                      libraries are its own affair.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS meshlode_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES LICENSES/GPL-3.0-or-later.txt LICENSES/MIT.txt DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/schemas/ DESTINATION ${CMAKE_INSTALL_DATADIR}/meshlode/schemas FILES_MATCHING PATTERN "*.json")

set(meshlode_runtime_rooms base coding read unpack select decode api_runtime)
set(has_runtime TRUE)
foreach(room IN LISTS meshlode_runtime_rooms)
  if(NOT TARGET meshlode_${room})
    set(has_runtime FALSE)
  endif()
endforeach()
if(NOT has_runtime)
  message(STATUS "install: no meshlode::runtime, a room of it is not there")
  return()
endif()

# Draco is C++ and large, and its codec is the slowest: the installed libraries answer "unsupported" to its pages unless
# they are told to bring it. The program reads it always.
option(MESHLODE_INSTALL_DRACO "The installed runtime libraries read pages stored with draco, and need libdraco" OFF)
set(meshlode_runtime_codecs lz4 zstd)
if(MESHLODE_INSTALL_DRACO)
  list(APPEND meshlode_runtime_codecs draco)
endif()

function(add_runtime_objects target)
  foreach(room IN LISTS meshlode_runtime_rooms)
    get_target_property(type meshlode_${room} TYPE)
    if(room STREQUAL unpack AND NOT MESHLODE_INSTALL_DRACO)
      target_sources(${target} PRIVATE $<FILTER:$<TARGET_OBJECTS:meshlode_unpack>,EXCLUDE,/unpack_draco[.]>
                                       ${PROJECT_SOURCE_DIR}/src/unpack/unpack_draco.cpp)
      target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/include)
      target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:meshlode_flags>)
    elseif(NOT type STREQUAL INTERFACE_LIBRARY)
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:meshlode_${room}>)
    endif()
  endforeach()
endfunction()

add_library(meshlode_runtime STATIC)
set_target_properties(meshlode_runtime PROPERTIES EXPORT_NAME runtime LINKER_LANGUAGE CXX)
add_runtime_objects(meshlode_runtime)
target_include_directories(meshlode_runtime INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(meshlode_runtime INTERFACE cxx_std_20)
# The codecs of unpack, by their names for the linker.
foreach(codec IN LISTS meshlode_runtime_codecs)
  string(TOUPPER ${codec} name)
  if(MESHLODE_UNPACK_${name})
    target_link_libraries(meshlode_runtime INTERFACE ${codec})
  endif()
endforeach()
set(meshlode_exports meshlode_runtime)

# Exports meshlode_* and nothing else.
add_library(meshlode_c SHARED)
add_runtime_objects(meshlode_c)
set_target_properties(meshlode_c PROPERTIES OUTPUT_NAME meshlode EXPORT_NAME c LINKER_LANGUAGE CXX
                                            VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
target_include_directories(meshlode_c INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
set(meshlode_c_symbols ${CMAKE_CURRENT_LIST_DIR}/meshlode_c.map)
target_link_options(meshlode_c PRIVATE -Wl,--version-script=${meshlode_c_symbols})
set_property(TARGET meshlode_c APPEND PROPERTY LINK_DEPENDS ${meshlode_c_symbols})
if(NOT MESHLODE_SANITIZE)
  target_link_options(meshlode_c PRIVATE -static-libstdc++ -static-libgcc)
endif()
foreach(codec IN LISTS meshlode_runtime_codecs)
  string(TOUPPER ${codec} name)
  if(MESHLODE_UNPACK_${name})
    target_link_libraries(meshlode_c PRIVATE ${codec})
  endif()
endforeach()
list(APPEND meshlode_exports meshlode_c)

install(FILES include/meshlode/format.h include/meshlode/page.h include/meshlode/decode.glsl
              include/meshlode/result.h include/meshlode/runtime.h include/meshlode/meshlode.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/meshlode)

if(TARGET meshlode_api_build AND TARGET meshlode_pipeline)
  add_library(meshlode_build SHARED $<TARGET_OBJECTS:meshlode_api_build>)
  # meshlode_thread_rand stays out: a library must not replace its host's rand().
  target_link_libraries(meshlode_build PRIVATE meshlode_api_build)
  set_target_properties(meshlode_build PROPERTIES EXPORT_NAME build LINKER_LANGUAGE CXX
                                                  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
  target_include_directories(meshlode_build INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(meshlode_build INTERFACE cxx_std_20)
  list(APPEND meshlode_exports meshlode_build)
  install(FILES include/meshlode/build.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/meshlode)
endif()

set(meshlode_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/meshlode)
install(TARGETS ${meshlode_exports} EXPORT meshlodeTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT meshlodeTargets NAMESPACE meshlode:: FILE meshlodeConfig.cmake DESTINATION ${meshlode_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/meshlodeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/meshlodeConfigVersion.cmake DESTINATION ${meshlode_package_dir})
