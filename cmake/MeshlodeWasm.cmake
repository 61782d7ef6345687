# SPDX-License-Identifier: GPL-3.0-or-later
# The target runtime-wasm: base, format and run as a WebAssembly module, in a build of its own with another compiler, put
# together as a package for npm in ${PROJECT_BINARY_DIR}/npm. `info --html` has the module in its pages; without the packages
# (tools/install-deps.sh) it answers that it cannot.
option(MESHLODE_WASM "The runtime as a WebAssembly module, and info --html, where the packages for it are there" ON)
if(NOT MESHLODE_WASM)
  return()
endif()
find_program(MESHLODE_WASM_COMPILER clang++-14)
find_program(MESHLODE_WASM_LINKER wasm-ld-14)
find_file(MESHLODE_WASM_LIBCXX libc++.a PATHS /usr/lib/wasm32-wasi NO_DEFAULT_PATH)
find_file(MESHLODE_WASM_BUILTINS libclang_rt.builtins-wasm32.a
          PATHS /usr/lib/llvm-14/lib/clang/14.0.6/lib/wasi /usr/lib/llvm-14/lib/clang/14/lib/wasi NO_DEFAULT_PATH)
mark_as_advanced(MESHLODE_WASM_COMPILER MESHLODE_WASM_LINKER MESHLODE_WASM_LIBCXX MESHLODE_WASM_BUILTINS)
if(NOT (MESHLODE_WASM_COMPILER AND MESHLODE_WASM_LINKER AND MESHLODE_WASM_LIBCXX AND MESHLODE_WASM_BUILTINS))
  message(STATUS "No compiler for WebAssembly: no runtime-wasm, no info --html (tools/install-deps.sh)")
  set(MESHLODE_WASM OFF)
  return()
endif()

set(meshlode_npm "${PROJECT_BINARY_DIR}/npm")
set(meshlode_wasm "${meshlode_npm}/meshlode.wasm")
set(wasm_build "${PROJECT_BINARY_DIR}/wasm")
file(GLOB_RECURSE wasm_sources CONFIGURE_DEPENDS
     ${PROJECT_SOURCE_DIR}/src/base/* ${PROJECT_SOURCE_DIR}/src/format/* ${PROJECT_SOURCE_DIR}/src/run/*
     ${PROJECT_SOURCE_DIR}/include/meshlode/* ${PROJECT_SOURCE_DIR}/tools/wasm/*)
set(npm_files)
foreach(name IN ITEMS package.json index.js index.d.ts README.md NOTICE)
  list(APPEND npm_files ${PROJECT_SOURCE_DIR}/tools/wasm/${name})
endforeach()
add_custom_command(OUTPUT "${meshlode_wasm}"
  COMMAND ${CMAKE_COMMAND} -S ${PROJECT_SOURCE_DIR} -B "${wasm_build}" -G Ninja -DCMAKE_BUILD_TYPE=Release
          -DCMAKE_TOOLCHAIN_FILE=${PROJECT_SOURCE_DIR}/cmake/wasm32-wasi.cmake -DMESHLODE_RUNTIME_ONLY=ON -DMESHLODE_TESTS=OFF
          "-DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}"
  COMMAND ${CMAKE_COMMAND} --build "${wasm_build}" --target meshlode_wasm
  COMMAND ${CMAKE_COMMAND} -E make_directory "${meshlode_npm}"
  COMMAND ${CMAKE_COMMAND} -E copy ${npm_files} "${meshlode_npm}"
  COMMAND ${CMAKE_COMMAND} -E rm -rf "${meshlode_npm}/three" "${meshlode_npm}/stream" "${meshlode_npm}/webgpu"
  COMMAND ${CMAKE_COMMAND} -E copy_directory ${PROJECT_SOURCE_DIR}/tools/wasm/three "${meshlode_npm}/three"
  COMMAND ${CMAKE_COMMAND} -E copy_directory ${PROJECT_SOURCE_DIR}/tools/wasm/stream "${meshlode_npm}/stream"
  COMMAND ${CMAKE_COMMAND} -E copy_directory ${PROJECT_SOURCE_DIR}/tools/wasm/webgpu "${meshlode_npm}/webgpu"
  COMMAND ${CMAKE_COMMAND} -E copy ${PROJECT_SOURCE_DIR}/include/meshlode/decode.wgsl "${meshlode_npm}/webgpu/decode.wgsl"
  COMMAND ${CMAKE_COMMAND} -E copy ${PROJECT_SOURCE_DIR}/LICENSES/MIT.txt "${meshlode_npm}/LICENSE"
  COMMAND ${CMAKE_COMMAND} -E copy "${wasm_build}/tools/wasm/meshlode.wasm" "${meshlode_wasm}"
  DEPENDS ${wasm_sources} ${PROJECT_SOURCE_DIR}/cmake/wasm32-wasi.cmake
  COMMENT "The runtime as a WebAssembly module" VERBATIM)
add_custom_target(runtime-wasm DEPENDS "${meshlode_wasm}")
