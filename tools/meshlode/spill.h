// SPDX-License-Identifier: GPL-3.0-or-later
// --max-memory beyond what meshes one after another can keep: from a share of it on, every large array of the process
// lies in a temporary file (spill_area.h), and a thread drops from memory what would go beyond the limit. No stage
// knows of it and no byte depends on it.
//
// spill_operators.cpp replaces the program's operator new and delete, as a library must not: what links the library
// alone is refused where memory is short.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MESHLODE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || __has_feature(thread_sanitizer)
#define MESHLODE_SANITIZED 1
#endif
#endif

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include <meshlode/result.h>

namespace meshlode::cli {

/// Once in a process, for the rest of it. `limit`: bytes in memory. The file is made in the first of `folders` that can
/// take one. Error: kIo, of the last of them.
[[nodiscard]] Status start_spilling(std::uint64_t limit, std::span<const std::filesystem::path> folders);

/// The file's folder, where the file found no room for an array since.
[[nodiscard]] std::optional<std::filesystem::path> full_spill_folder();

/// What operator new and delete do. nullptr: there is no memory.
[[nodiscard]] void* new_array(std::size_t bytes) noexcept;
void delete_array(void* array) noexcept;

}  // namespace meshlode::cli
