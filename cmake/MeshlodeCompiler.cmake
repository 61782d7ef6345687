# SPDX-License-Identifier: GPL-3.0-or-later
# The one place for language level, warnings and floating-point rules.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "wasm32")  # a module lies where it likes, and its tables cost less so
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

option(MESHLODE_WERROR "Warnings are errors" ON)
set(MESHLODE_SANITIZE "" CACHE STRING "Sanitizers, for example address,undefined")

add_library(meshlode_flags INTERFACE)
# I10: contraction and excess precision would let a byte depend on the compiler.
target_compile_options(meshlode_flags INTERFACE -ffp-contract=off
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wold-style-cast
                            -Wnon-virtual-dtor -Woverloaded-virtual>
  $<$<COMPILE_LANGUAGE:C>:-Wall -Wextra>)
# GCC 12's SLP vectorizer leaves out the rounding of two doubles to floats and back that it makes one vector of, at -O2 already
# (tests/environment/rounding_test.cpp): bytes, and margins that rest on what floats hold, would depend on the compiler.
target_compile_options(meshlode_flags INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>)
# GCC 12 sees overlapping copies and overflows in std::string's insert and operator+ that cannot be (GCC bugs 105329 and
# 105651); which of them it sees depends on what it inlines, so that any change of a test may bring one. Clang's own
# warnings of arrays stay on.
target_compile_options(meshlode_flags INTERFACE
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-restrict -Wno-stringop-overflow -Wno-array-bounds>)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "wasm32")
  # size_t has 32 bits there: what is cut to it was compared, in 64, with the size of the file.
  target_compile_options(meshlode_flags INTERFACE -Wno-shorten-64-to-32)
endif()
if(MESHLODE_WERROR)
  target_compile_options(meshlode_flags INTERFACE -Werror)
endif()
if(MESHLODE_SANITIZE)
  # Left out of `undefined`: what `address` sees too (object-size), and the types behind virtual functions, of which there are
  # eight (vptr). The two are a tenth of what compiling with sanitizers costs.
  add_compile_options(-fsanitize=${MESHLODE_SANITIZE} -fno-sanitize=object-size,vptr -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${MESHLODE_SANITIZE})
  add_compile_definitions(MESHLODE_SANITIZED)
endif()
