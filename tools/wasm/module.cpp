// SPDX-License-Identifier: MIT
// What the module has beside <meshlode/meshlode.h>: memory for the host to put bytes into, and an end without
// exceptions.
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

/// The back end has no exceptions here, and a libc++ without them returns a null pointer that nobody expects. Memory
/// that cannot be had ends the module with a trap, which its host catches; an instance that trapped must not be used
/// again.
[[noreturn]] void trap() {
  __builtin_trap();
}

[[maybe_unused]] const std::new_handler kBefore = std::set_new_handler(trap);

}  // namespace

extern "C" {

/// Memory at a multiple of 16, or null.
__attribute__((export_name("meshlode_web_allocate"))) void* meshlode_web_allocate(std::size_t bytes) {
  return std::malloc(bytes == 0 ? 1 : bytes);
}

__attribute__((export_name("meshlode_web_release"))) void meshlode_web_release(void* memory) {
  std::free(memory);
}

}  // extern "C"
