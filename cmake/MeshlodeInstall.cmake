# SPDX-License-Identifier: GPL-3.0-or-later
# What an installed meshlode offers: the program, its man pages and completion scripts, and for find_package(meshlode)
#   meshlode::program  the command line, and meshlode_add_assets() to build assets with it (MeshlodeAssets.cmake).
#   meshlode::runtime  static, MIT: read, unpack, select, decode behind <meshlode/runtime.h>. Needs nothing but the C and
#                      C++ runtime (with MESHLODE_OLD_CODECS also lz4, zstd and draco).
#   meshlode::c        shared, MIT: the same behind <meshlode/meshlode.h>, for C. Its C++ runtime is inside; what it needs
#                      is libc (with MESHLODE_OLD_CODECS also these).
#   meshlode::build    shared, GPL-3.0-or-later: the builder behind <meshlode/build.h>. Shared, so that its third-party
#                      libraries are its own affair.
# Each file belongs to one of three components, which are the packages of MeshlodePackages.cmake: runtime (the C library),
# tools (the program and the builder's library) and dev (headers, the static library, what find_package reads).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set_target_properties(meshlode_cli PROPERTIES EXPORT_NAME program)
install(TARGETS meshlode_cli EXPORT meshlodeTargets RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
# What the program wrote of itself (tools/meshlode/CMakeLists.txt): the folder, because it knows its verbs.
install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
set(meshlode_scripts ${PROJECT_BINARY_DIR}/completions)
install(FILES ${meshlode_scripts}/meshlode DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT tools)
install(FILES ${meshlode_scripts}/_meshlode DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT tools)
install(FILES ${meshlode_scripts}/meshlode.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT tools)
install(FILES LICENSES/GPL-3.0-or-later.txt LICENSES/MIT.txt DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
install(DIRECTORY docs/schemas/ DESTINATION ${CMAKE_INSTALL_DATADIR}/meshlode/schemas COMPONENT tools
        FILES_MATCHING PATTERN "*.json")

set(meshlode_runtime_objects $<TARGET_OBJECTS:meshlode_base_objects> $<TARGET_OBJECTS:meshlode_format_objects>
                             $<TARGET_OBJECTS:meshlode_run_objects>)
set(meshlode_runtime_codecs)  # by their names for the linker
if(MESHLODE_OLD_CODECS)
  list(APPEND meshlode_runtime_objects $<TARGET_OBJECTS:meshlode_old_readers>)
  set(meshlode_runtime_codecs lz4 zstd draco)
else()
  list(APPEND meshlode_runtime_objects $<TARGET_OBJECTS:meshlode_no_old_readers>)
endif()

add_library(meshlode_runtime STATIC ${meshlode_runtime_objects})
set_target_properties(meshlode_runtime PROPERTIES EXPORT_NAME runtime LINKER_LANGUAGE CXX)
target_link_libraries(meshlode_runtime INTERFACE ${meshlode_runtime_codecs})
target_include_directories(meshlode_runtime INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(meshlode_runtime INTERFACE cxx_std_20)

# Exports meshlode_* and nothing else.
add_library(meshlode_c SHARED ${meshlode_runtime_objects})
set_target_properties(meshlode_c PROPERTIES OUTPUT_NAME meshlode EXPORT_NAME c LINKER_LANGUAGE CXX
                                            VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
target_link_libraries(meshlode_c PRIVATE ${meshlode_runtime_codecs})
target_include_directories(meshlode_c INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
set(meshlode_c_symbols ${CMAKE_CURRENT_LIST_DIR}/meshlode_c.map)
target_link_options(meshlode_c PRIVATE -Wl,--version-script=${meshlode_c_symbols})
set_property(TARGET meshlode_c APPEND PROPERTY LINK_DEPENDS ${meshlode_c_symbols})
if(NOT MESHLODE_SANITIZE)
  target_link_options(meshlode_c PRIVATE -static-libstdc++ -static-libgcc)
endif()

install(FILES include/meshlode/format.h include/meshlode/page.h include/meshlode/page_cache.h include/meshlode/decode.glsl
              include/meshlode/decode.wgsl
              include/meshlode/result.h include/meshlode/runtime.h include/meshlode/meshlode.h include/meshlode/version.h
              src/run/select/metric.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/meshlode COMPONENT dev)

# Of the renderer's shaders what an engine may take (docs/reference/shaders.md), and SPIR-V beside where there is a compiler. In
# the tree metric.h lies elsewhere.
set(meshlode_shader_dir ${CMAKE_INSTALL_INCLUDEDIR}/meshlode/gpu)
set(meshlode_glsl alpha.glsl clusters.comp common.glsl cull.glsl hardware.frag hardware.mesh hardware.vert instances.comp nodes.glsl
                  page.glsl persistent.comp pyramid.comp raster.comp raster_clip.comp raster_far.comp resident.glsl roots.comp screen.glsl strips.glsl
                  traverse.comp)
list(TRANSFORM meshlode_glsl PREPEND src/draw/gpu/shaders/)
install(FILES ${meshlode_glsl} DESTINATION ${meshlode_shader_dir} COMPONENT dev)
set(meshlode_frame src/draw/gpu/shaders/frame.h)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${meshlode_frame})
file(READ ${meshlode_frame} meshlode_frame_text)
string(REPLACE "\"run/select/metric.h\"" "\"meshlode/metric.h\"" meshlode_frame_text "${meshlode_frame_text}")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/shaders/frame.h CONTENT "${meshlode_frame_text}" @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/shaders/frame.h DESTINATION ${meshlode_shader_dir} COMPONENT dev)
if(MESHLODE_VULKAN)
  list(TRANSFORM meshlode_spirv APPEND .spv OUTPUT_VARIABLE meshlode_spirv_files)
  list(TRANSFORM meshlode_spirv_files PREPEND ${PROJECT_BINARY_DIR}/src/draw/shaders/)
  install(FILES ${meshlode_spirv_files} DESTINATION ${meshlode_shader_dir} COMPONENT dev)
endif()

# Shows the functions of <meshlode/build.h> and <meshlode/meshlode_build.h>, and nothing else: CGAL and what else is inside
# is nobody's business.
# meshlode_thread_rand stays out: a library must not replace its host's rand().
add_library(meshlode_build_library SHARED $<TARGET_OBJECTS:meshlode_builder>)
target_link_libraries(meshlode_build_library PRIVATE meshlode_builder)
set_target_properties(meshlode_build_library PROPERTIES OUTPUT_NAME meshlode_build EXPORT_NAME build LINKER_LANGUAGE CXX
                                                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
target_include_directories(meshlode_build_library INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(meshlode_build_library INTERFACE cxx_std_20)
set(meshlode_build_symbols ${CMAKE_CURRENT_LIST_DIR}/meshlode_build.map)
target_link_options(meshlode_build_library PRIVATE -Wl,--version-script=${meshlode_build_symbols})
set_property(TARGET meshlode_build_library APPEND PROPERTY LINK_DEPENDS ${meshlode_build_symbols})
install(FILES include/meshlode/build.h include/meshlode/meshlode_build.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/meshlode COMPONENT dev)

set(meshlode_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/meshlode)
install(TARGETS meshlode_runtime EXPORT meshlodeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(TARGETS meshlode_c EXPORT meshlodeTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
install(TARGETS meshlode_build_library EXPORT meshlodeTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT tools NAMELINK_COMPONENT dev)
install(EXPORT meshlodeTargets NAMESPACE meshlode:: DESTINATION ${meshlode_package_dir} COMPONENT dev)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/meshlodeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/meshlodeConfigVersion.cmake cmake/meshlodeConfig.cmake cmake/MeshlodeAssets.cmake
        DESTINATION ${meshlode_package_dir} COMPONENT dev)

# For compilers without CMake: `pkg-config meshlode`, `meshlode-runtime`, `meshlode-build`. Relative to where the files lie, so that
# a moved prefix works.
set(meshlode_pc_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH meshlode_pc_prefix /prefix/${meshlode_pc_dir} /prefix)
function(meshlode_install_pc name description libs)
  set(meshlode_pc_name ${name})
  set(meshlode_pc_description ${description})
  set(meshlode_pc_libs ${libs})
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/meshlode.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${meshlode_pc_dir} COMPONENT dev)
endfunction()
list(TRANSFORM meshlode_runtime_codecs PREPEND "-l" OUTPUT_VARIABLE meshlode_codec_flags)
list(JOIN meshlode_codec_flags " " meshlode_codec_flags)
meshlode_install_pc(meshlode "Reads .lode assets, C" "-lmeshlode")
meshlode_install_pc(meshlode-runtime "Reads .lode assets, C++" "-lmeshlode_runtime ${meshlode_codec_flags}")
meshlode_install_pc(meshlode-build "Builds .lode assets, C++ and C" "-lmeshlode_build")
