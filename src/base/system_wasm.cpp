// SPDX-License-Identifier: MIT
// WebAssembly: a module that is given bytes by its host and has no operating system of its own. Whatever asks for one
// is answered that there is none; nothing here is imported from the host, so that the module runs wherever it is
// loaded.
#include "base/system.h"

namespace meshlode::system {

std::string last_error() {
  return "there are no files in WebAssembly";
}

std::optional<FileInfo> find_info(const std::filesystem::path& /*path*/) {
  return std::nullopt;
}

bool may_write(const std::filesystem::path& /*path*/, FileKind /*kind*/) {
  return false;
}

Result<Mapping> map_file(const std::filesystem::path& path) {
  return Error{ErrorCode::kIo, path.string(), "cannot open: " + last_error()};
}

void unmap(std::span<const std::uint8_t> /*bytes*/) {}

Created create_locked(const std::filesystem::path& /*path*/, Handle& /*file*/) {
  return Created::kFailed;
}

Handle open_device(const std::filesystem::path& /*path*/) {
  return kNoHandle;
}

bool write_all(Handle /*file*/, std::span<const std::uint8_t> /*bytes*/) {
  return false;
}

bool sync(Handle /*file*/) {
  return false;
}

bool close(Handle /*file*/) {
  return false;
}

std::optional<FileInfo> info_of(Handle /*file*/) {
  return std::nullopt;
}

bool rename_over(const std::filesystem::path& /*from*/, const std::filesystem::path& /*to*/) {
  return false;
}

void remove_file(const std::filesystem::path& /*path*/) {}

void remove_unlocked(const std::filesystem::path& /*path*/) {}

bool sync_folder(const std::filesystem::path& /*folder*/) {
  return true;
}

/// For names of files alone, of which there are none.
std::uint64_t random_number() {
  return 0;
}

std::optional<std::uint64_t> memory_left() {
  return std::nullopt;
}

std::uint64_t resident_memory() {
  return std::uint64_t{__builtin_wasm_memory_size(0)} << 16U;  // pages of 64 KiB
}

bool restart_peak_memory() {
  return false;
}

std::uint64_t peak_memory() {
  return 0;
}

void give_back_freed_memory() {}

}  // namespace meshlode::system
