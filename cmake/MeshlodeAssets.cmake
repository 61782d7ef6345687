# SPDX-License-Identifier: GPL-3.0-or-later
# Assets as a part of somebody's build: find_package(meshlode) brings this. For generators that know DEPFILE: Ninja and
# Makefiles.

# meshlode_add_assets(NAME SOURCES scene.gltf ... [OUTPUT_FOLDER folder] [OPTIONS --preset best ...] [CACHE folder])
# A target NAME, part of `all`, that builds OUTPUT_FOLDER/<scene>.lode of each scene, anew when the scene, a file that it
# refers to, an option or the program changes. Relative sources are of the current source folder, OUTPUT_FOLDER (the
# current binary folder where not given) and CACHE of the current binary folder. The target's property MESHLODE_ASSETS
# lists the assets.
function(meshlode_add_assets name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "OUTPUT_FOLDER;CACHE" "SOURCES;OPTIONS")
  if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES OR NOT arg_SOURCES)
    message(FATAL_ERROR "meshlode_add_assets(NAME SOURCES scene.gltf ... [OUTPUT_FOLDER folder] [OPTIONS option ...] "
                        "[CACHE folder]): not understood: ${arg_UNPARSED_ARGUMENTS} ${arg_KEYWORDS_MISSING_VALUES}")
  endif()
  cmake_path(ABSOLUTE_PATH arg_OUTPUT_FOLDER BASE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}" NORMALIZE OUTPUT_VARIABLE folder)
  file(MAKE_DIRECTORY "${folder}")
  set(options ${arg_OPTIONS})
  if(arg_CACHE)
    cmake_path(ABSOLUTE_PATH arg_CACHE BASE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}" NORMALIZE OUTPUT_VARIABLE cache)
    list(APPEND options --cache "${cache}")
  endif()
  set(assets)
  foreach(source IN LISTS arg_SOURCES)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
    cmake_path(GET source STEM LAST_ONLY stem)
    cmake_path(APPEND folder "${stem}.lode" OUTPUT_VARIABLE asset)
    if(asset IN_LIST assets)
      message(FATAL_ERROR "meshlode_add_assets(${name}): two sources would both become ${asset}")
    endif()
    list(APPEND assets "${asset}")
    # An asset that the cache finds unchanged is not written: Ninja looks again afterwards (restat), Make goes by time.
    set(touch)
    if(NOT CMAKE_GENERATOR MATCHES Ninja)
      set(touch COMMAND "${CMAKE_COMMAND}" -E touch "${asset}")
    endif()
    add_custom_command(OUTPUT "${asset}"
      COMMAND meshlode::program build "${source}" -o "${asset}" --depfile "${asset}.d" --quiet ${options} ${touch}
      DEPENDS "${source}" meshlode::program DEPFILE "${asset}.d"
      COMMENT "Building ${stem}.lode" VERBATIM)
  endforeach()
  add_custom_target(${name} ALL DEPENDS ${assets})
  set_target_properties(${name} PROPERTIES MESHLODE_ASSETS "${assets}")
endfunction()
