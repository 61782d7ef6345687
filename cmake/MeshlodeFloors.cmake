# SPDX-License-Identifier: GPL-3.0-or-later
# One floor = one folder under src/ = the library meshlode_<floor>; its rooms are the folders inside. cmake/layers.txt says
# which floor may include which, and a test holds it.

# The floors share a precompiled header: reading the standard library is a third of what compiling them costs. Whether each
# file includes the standard headers that it needs is checked by a test (tests/house/standard_headers_test.cpp). Compiler
# caches do not see through precompiled headers: with one each file reads for itself, as it does for clang-tidy. Under
# sanitizers GLM is among them, by the house's own header, which sets its options first: with others its types would be
# passed in another way.
# QUICKLY: not optimised under sanitizers, which takes off more than half of the rest, for code whose running time does
# not matter there.
function(meshlode_share_floor_headers name)
  cmake_parse_arguments(arg "QUICKLY" "" "" ${ARGN})
  set(headers meshlode_floor_headers)
  set(optimised)
  if(arg_QUICKLY AND MESHLODE_SANITIZE AND NOT MESHLODE_FUZZ)
    set(headers meshlode_quick_floor_headers)
    set(optimised -O0)
    target_compile_options(${name} PRIVATE ${optimised})
  endif()
  if(CMAKE_CXX_COMPILER_LAUNCHER OR MESHLODE_RUNTIME_ONLY
     OR NOT (CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR (MESHLODE_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES Clang)))
    return()
  endif()
  # Programs are position-independent in another way than libraries are, and the compiler minds.
  get_target_property(type ${name} TYPE)
  if(type STREQUAL "EXECUTABLE")
    string(APPEND headers "_of_programs")
  endif()
  if(NOT TARGET ${headers})
    file(WRITE "${PROJECT_BINARY_DIR}/${headers}.cpp" "")
    if(type STREQUAL "EXECUTABLE")
      file(WRITE "${PROJECT_BINARY_DIR}/${headers}.cpp" "int main() {}\n")
      add_executable(${headers} EXCLUDE_FROM_ALL "${PROJECT_BINARY_DIR}/${headers}.cpp")
    else()
      add_library(${headers} STATIC EXCLUDE_FROM_ALL "${PROJECT_BINARY_DIR}/${headers}.cpp")
    endif()
    target_link_libraries(${headers} PRIVATE meshlode_flags)
    target_include_directories(${headers} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/include)
    target_compile_options(${headers} PRIVATE ${optimised})
    target_precompile_headers(${headers} PRIVATE <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem>
                              <functional> <map> <optional> <set> <span> <string> <string_view> <utility> <variant>
                              <vector>)
    if(MESHLODE_SANITIZE)
      target_precompile_headers(${headers} PRIVATE ${PROJECT_SOURCE_DIR}/src/base/vec.h)
    endif()
  endif()
  target_precompile_headers(${name} REUSE_FROM ${headers})
endfunction()

# What every target of a floor has: flags, src/ and include/ to include from, its libraries. LIBS are third-party and
# private, because a library is seen through one wrapper file of a room only. A function is declared in a header or seen by
# its own file alone, so that two files of one namespace cannot define the same one.
function(meshlode_set_up_floor_target target)
  cmake_parse_arguments(arg "QUICKLY" "" "" ${ARGN})
  target_link_libraries(${target} PRIVATE meshlode_flags ${arg_UNPARSED_ARGUMENTS})
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wmissing-declarations>)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                                              $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>)
  set(how)
  if(arg_QUICKLY)
    set(how QUICKLY)
  endif()
  meshlode_share_floor_headers(${target} ${how})
endfunction()

# meshlode_compile_alone(FILE ...): with MESHLODE_UNITY too.
function(meshlode_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# meshlode_add_floor(NAME SOURCES room/a.cpp ... [FLOORS base format ...] [LIBS Some::target ...] [QUICKLY] [ALONE room/a.cpp ...])
# FLOORS are public: their headers are included by this floor's headers. QUICKLY: see meshlode_share_floor_headers().
# ALONE: sources that have a name of their own which others have too (MESHLODE_UNITY).
function(meshlode_add_floor name)
  cmake_parse_arguments(arg "QUICKLY" "" "SOURCES;FLOORS;LIBS;ALONE" ${ARGN})
  list(TRANSFORM arg_FLOORS PREPEND meshlode_)
  add_library(meshlode_${name} STATIC ${arg_SOURCES})
  meshlode_compile_alone(${arg_ALONE})
  set(how)
  if(arg_QUICKLY)
    set(how QUICKLY)
  endif()
  meshlode_set_up_floor_target(meshlode_${name} ${how} ${arg_LIBS})
  target_link_libraries(meshlode_${name} PUBLIC ${arg_FLOORS})
endfunction()

# The same for the floors that an engine ships: their objects also go into the libraries that are installed, which consist
# of them alone (MeshlodeInstall.cmake).
function(meshlode_add_runtime_floor name)
  cmake_parse_arguments(arg "" "" "SOURCES;FLOORS;LIBS" ${ARGN})
  list(TRANSFORM arg_FLOORS PREPEND meshlode_)
  add_library(meshlode_${name}_objects OBJECT ${arg_SOURCES})
  meshlode_set_up_floor_target(meshlode_${name}_objects ${arg_LIBS})
  add_library(meshlode_${name} STATIC)
  set_target_properties(meshlode_${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_link_libraries(meshlode_${name} PRIVATE meshlode_${name}_objects ${arg_LIBS} PUBLIC ${arg_FLOORS})
  target_include_directories(meshlode_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/include)
  target_compile_features(meshlode_${name} PUBLIC cxx_std_20)  # for a project that has these sources inside
endfunction()

# GoogleTest's header is half of what compiling a test costs; it is compiled once. Compiler caches do not see through that,
# so with one (CMAKE_CXX_COMPILER_LAUNCHER) every test reads it for itself.
function(meshlode_share_test_headers name)
  if(CMAKE_CXX_COMPILER_LAUNCHER)
    return()
  endif()
  if(NOT TARGET meshlode_test_headers)
    # A program, not a library: it has to be position-independent in the way that the tests are.
    file(WRITE "${PROJECT_BINARY_DIR}/test_headers.cpp" "")
    add_executable(meshlode_test_headers EXCLUDE_FROM_ALL "${PROJECT_BINARY_DIR}/test_headers.cpp")
    target_link_libraries(meshlode_test_headers PRIVATE meshlode_flags GTest::gtest_main)
    meshlode_compile_quickly(meshlode_test_headers)
    target_precompile_headers(meshlode_test_headers PRIVATE <gtest/gtest.h>)
  endif()
  target_precompile_headers(${name} REUSE_FROM meshlode_test_headers)
endfunction()

# A test's own code is run once, and is not worth what optimising it costs: with sanitizers half of compiling it, without a
# quarter. What it tests, the floors, is optimised; and so is what libFuzzer runs a million times.
function(meshlode_compile_quickly name)
  if(MESHLODE_SANITIZE AND NOT MESHLODE_FUZZ)
    target_compile_options(${name} PRIVATE -O0)
  elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${name} PRIVATE -O1)
  endif()
endfunction()

# A test program keeps the large arrays that it frees: it makes pictures of one size again and again, and the system would clear
# their pages each time, an eighth of what all tests take. The C library reads this, a sanitizer's own malloc does not.
set(meshlode_test_malloc "GLIBC_TUNABLES=glibc.malloc.mmap_threshold=1000000000:glibc.malloc.trim_threshold=1000000000")

# meshlode_add_test(NAME SOURCES a_test.cpp ... FLOORS ... [LIBS ...] [LABELS unit property ...] [TIMEOUT seconds]
#                   [SANITIZED] [MALLOC_OF_THE_SYSTEM] [SLOW Suite.Case ...] [SLOW_SANITIZED Suite.Case ...] [ALONE a_test.cpp ...])
# One GoogleTest program per room or property; ctest runs each GoogleTest case on its own line. SANITIZED: tools/test.sh
# runs it under sanitizers too, as it does everything labelled malformed: for rooms whose own arithmetic makes indices.
# MALLOC_OF_THE_SYSTEM: for what measures memory (meshlode_test_malloc).
# Programs labelled slow are built by the target slow_tests alone. SLOW: regular expressions for the beginnings of cases
# that are labelled slow in a program that is not; SLOW_SANITIZED: likewise, under sanitizers. tools/test.sh --all runs them.
function(meshlode_add_test name)
  cmake_parse_arguments(arg "SANITIZED;MALLOC_OF_THE_SYSTEM" "TIMEOUT" "SOURCES;FLOORS;LIBS;LABELS;ALONE;SLOW;SLOW_SANITIZED" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  meshlode_compile_alone(${arg_ALONE})
  meshlode_compile_quickly(${name})
  meshlode_share_test_headers(${name})
  target_link_libraries(${name} PRIVATE meshlode_flags GTest::gtest_main ${arg_LIBS})
  if(TARGET meshlode_samples)
    target_link_libraries(${name} PRIVATE meshlode_samples)  # scenes made from nothing (src/lab/samples)
  endif()
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  foreach(floor IN LISTS arg_FLOORS)
    target_link_libraries(${name} PRIVATE meshlode_${floor})
  endforeach()
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if("slow" IN_LIST arg_LABELS)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    set_property(GLOBAL APPEND PROPERTY MESHLODE_SLOW_TESTS ${name})
  elseif(arg_SANITIZED OR "malformed" IN_LIST arg_LABELS)
    list(APPEND arg_LABELS sanitized)
    set_property(GLOBAL APPEND PROPERTY MESHLODE_CORE_TESTS ${name})
  endif()
  set(malloc)
  if(NOT arg_MALLOC_OF_THE_SYSTEM)
    set(malloc ENVIRONMENT ${meshlode_test_malloc})
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST TEST_LIST ${name}_cases
                       PROPERTIES TIMEOUT ${arg_TIMEOUT} SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]" ${malloc})
  # gtest_discover_tests takes lists apart, so that a second label would be lost: labels are set after the discovery.
  set(labels_file "${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake")
  set(slow ${arg_SLOW})
  if(MESHLODE_SANITIZE)
    list(APPEND slow ${arg_SLOW_SANITIZED})
  endif()
  set(slow_labels)
  if(slow)
    string(CONCAT slow_labels
        "  foreach(slow IN ITEMS ${slow})\n    set(slow_cases \${${name}_cases})\n"
        "    list(FILTER slow_cases INCLUDE REGEX \"^\${slow}\")\n    if(NOT slow_cases)\n"
        "      message(FATAL_ERROR \"${name}: no case is slow by \${slow}\")\n    endif()\n"
        "    set_tests_properties(\${slow_cases} PROPERTIES LABELS \"${arg_LABELS};slow\")\n  endforeach()\n")
  endif()
  file(WRITE "${labels_file}"
       "if(${name}_cases)\n  set_tests_properties(\${${name}_cases} PROPERTIES LABELS \"${arg_LABELS}\")\n"
       "${slow_labels}"
       "elseif(NOT EXISTS \"${CMAKE_CURRENT_BINARY_DIR}/${name}\")\n"
       "  set_tests_properties(${name}_NOT_BUILT PROPERTIES LABELS \"${arg_LABELS}\")\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${labels_file}")
endfunction()
