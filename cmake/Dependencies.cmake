# SPDX-License-Identifier: GPL-3.0-or-later
# Every library that meshlode stands on, found once; each an imported target. What tests and benchmarks need beside them is
# found where MESHLODE_TESTS or MESHLODE_BENCH asks for it.

# meshlode_find_library(TARGET NAME HEADER): libraries of Debian's that ship neither a CMake config nor a find module.
function(meshlode_find_library target name header)
  string(MAKE_C_IDENTIFIER "MESHLODE_${name}" variable)
  string(TOUPPER "${variable}" variable)
  find_library(${variable}_LIBRARY ${name} REQUIRED)
  find_path(${variable}_INCLUDE_DIR ${header} REQUIRED)
  mark_as_advanced(${variable}_LIBRARY ${variable}_INCLUDE_DIR)
  add_library(${target} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES IMPORTED_LOCATION "${${variable}_LIBRARY}"
                                             INTERFACE_INCLUDE_DIRECTORIES "${${variable}_INCLUDE_DIR}")
endfunction()

# Of page codecs that nothing writes any more: their readers and the tests of these.
if(MESHLODE_OLD_CODECS OR (MESHLODE_TESTS AND NOT WIN32))
  meshlode_find_library(ZSTD::zstd zstd zstd.h)
  meshlode_find_library(LZ4::lz4 lz4 lz4.h)
endif()

if(MESHLODE_RUNTIME_ONLY)
  if(MESHLODE_OLD_CODECS)
    meshlode_find_library(Draco::draco draco draco/core/decoder_buffer.h)
  endif()
  if(MESHLODE_TESTS AND NOT WIN32)
    # Of the tests alone: their samples are made by pieces of the builder (tests/portability/CMakeLists.txt).
    find_package(GTest REQUIRED)
    find_package(TBB REQUIRED)
    find_package(Boost REQUIRED)
    find_package(CGAL REQUIRED)
  endif()
  return()
endif()

find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
find_package(Boost REQUIRED)  # headers: CGAL's need them, and whole numbers of any length
find_package(METIS REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
meshlode_find_library(Draco::draco draco draco/core/decoder_buffer.h)
include(CheckDracoVersion)
meshlode_check_draco_version("${MESHLODE_DRACO_INCLUDE_DIR}")
# Another simplifier, to compare; the tests' oracle of topology; the reference of bench/quality.
meshlode_find_library(OpenMesh::Core OpenMeshCore OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh)
meshlode_find_library(OpenMesh::Tools OpenMeshTools OpenMesh/Tools/Decimater/DecimaterT.hh)
meshlode_find_library(meshoptimizer::meshoptimizer meshoptimizer meshoptimizer.h)
meshlode_find_library(WebP::webp webp webp/decode.h)
find_path(MESHLODE_STB_INCLUDE_DIR stb_image.h PATH_SUFFIXES stb REQUIRED)
mark_as_advanced(MESHLODE_STB_INCLUDE_DIR)
add_library(stb::stb INTERFACE IMPORTED GLOBAL)
target_include_directories(stb::stb INTERFACE "${MESHLODE_STB_INCLUDE_DIR}")
if(MESHLODE_VULKAN OR MESHLODE_TESTS)
  find_program(MESHLODE_GLSLC glslc REQUIRED)
endif()
if(MESHLODE_TESTS)
  find_package(GTest REQUIRED)
  find_package(Python3 COMPONENTS Interpreter)
  # For its exact predicates, which the tests ask. Its flags (-frounding-math) stay with the targets that link it.
  find_package(CGAL REQUIRED)
endif()
