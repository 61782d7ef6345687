// SPDX-License-Identifier: GPL-3.0-or-later
// The program's operator new and delete (spill.h). Under sanitizers they are the sanitizer's own.
#include <cstddef>
#include <new>

#include "spill.h"

#ifndef MESHLODE_SANITIZED

void* operator new(std::size_t bytes) {
  for (;;) {
    void* const array = meshlode::cli::new_array(bytes);
    if (array != nullptr) return array;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* array) noexcept {
  meshlode::cli::delete_array(array);
}

void operator delete(void* array, std::size_t /*bytes*/) noexcept {
  meshlode::cli::delete_array(array);
}

#endif
