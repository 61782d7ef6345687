# SPDX-License-Identifier: GPL-3.0-or-later
# src/scene/import/gltf/draco_decode.cpp takes a private member of Draco's and overrides functions of its decoders: what it
# relies on was read in the sources of one version. Another one may compile and be guarded no more, so it stops here.
# (The header's constant is an array that is not constexpr: no static_assert can see it.)
function(meshlode_check_draco_version include_dir)
  set(tried 1.5.5)
  set(header "${include_dir}/draco/core/draco_version.h")
  set(found "unknown")
  if(EXISTS "${header}")
    file(STRINGS "${header}" line REGEX "kDracoVersion\\[\\] *= *\"[^\"]*\"")
    if(line MATCHES "\"([^\"]*)\"")
      set(found "${CMAKE_MATCH_1}")
    endif()
  endif()
  if(NOT found STREQUAL tried)
    message(FATAL_ERROR
      "Draco ${tried} is needed, ${include_dir} has ${found}. src/scene/import/gltf/draco_decode.cpp guards that version's "
      "decoders by their private layout. For another version, read its decoders again, run import_test, "
      "import_mutate_test and the importer's fuzzing under sanitizers, and then change cmake/CheckDracoVersion.cmake.")
  endif()
endfunction()

# cmake -DMESHLODE_DRACO_INCLUDE_DIR=folder -P CheckDracoVersion.cmake, as the test does.
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  meshlode_check_draco_version("${MESHLODE_DRACO_INCLUDE_DIR}")
endif()
