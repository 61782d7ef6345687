# SPDX-License-Identifier: GPL-3.0-or-later
# Toolchain: WebAssembly by clang 14 with Debian's wasi-libc and libc++ (packages: tools/install-deps.sh).
set(CMAKE_SYSTEM_NAME Generic)  # CMake 3.25 knows no WASI
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_C_COMPILER clang-14)
set(CMAKE_CXX_COMPILER clang++-14)
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# Debian's clang knows where Debian's libraries lie (with --sysroot=/usr it would also find those of this machine); its libc++ was
# compiled without exceptions.
set(CMAKE_CXX_FLAGS_INIT
    "-fno-exceptions -isystem ${CMAKE_CURRENT_LIST_DIR}/../tools/wasm/include")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-fuse-ld=lld")
