// SPDX-License-Identifier: MIT
// How much memory this process may still take: on Linux what the machine has, and what its control groups leave
// it; elsewhere what the system says (base/system.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace meshlode {

/// Bytes that can be had before something is killed or swapped: the least of MemAvailable (/proc/meminfo), what each
/// control group above the process leaves (memory.max of version 2, memory.limit_in_bytes of version 1; page cache that
/// can be dropped counts as free), and RLIMIT_AS. Nothing where none of them says. `root` stands for / in tests.
[[nodiscard]] std::optional<std::uint64_t> available_memory(const std::filesystem::path& root = "/");

/// Gives what was freed piece by piece back to the system, between stages that need much of it in another form. With
/// glibc alone; elsewhere nothing happens.
void give_back_freed_memory();

/// Bytes of this process that are in memory now; 0 where it cannot be told.
[[nodiscard]] std::uint64_t resident_memory();

/// The most of it that was in memory at a time since restart_peak_memory(), which is false where the system cannot do
/// that; 0 where it cannot be told. Linux has one peak for the whole process.
[[nodiscard]] bool restart_peak_memory();
[[nodiscard]] std::uint64_t peak_memory();

}  // namespace meshlode
