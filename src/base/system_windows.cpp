// SPDX-License-Identifier: MIT
// Windows 8 and later. A lock is that nobody else may open the file for reading or writing while its writer has it
// open; it may be renamed and removed, as on POSIX.
#include "base/system.h"

#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
// After windows.h, whose names these use.
#include <ntsecapi.h>
#include <psapi.h>
#include <algorithm>
#include <system_error>

namespace meshlode::system {

namespace {

namespace fs = std::filesystem;

HANDLE handle_of(Handle file) {
  return reinterpret_cast<HANDLE>(file);
}

Handle number_of(HANDLE handle) {
  return reinterpret_cast<Handle>(handle);
}

/// Folders too; what others do with it is their affair.
HANDLE open_to_look(const fs::path& path) {
  constexpr DWORD kShareAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
  return ::CreateFileW(path.c_str(), FILE_READ_ATTRIBUTES, kShareAll, nullptr, OPEN_EXISTING,
                       FILE_FLAG_BACKUP_SEMANTICS, nullptr);
}

Error io_error(const fs::path& path, const char* what) {
  return {ErrorCode::kIo, path.string(), std::string(what) + ": " + last_error()};
}

std::optional<FileInfo> look_at(HANDLE handle) {
  if (::GetFileType(handle) != FILE_TYPE_DISK) return FileInfo{{}, FileKind::kOther};
  BY_HANDLE_FILE_INFORMATION info{};
  if (::GetFileInformationByHandle(handle, &info) == 0) return std::nullopt;
  const std::uint64_t index = std::uint64_t{info.nFileIndexHigh} << 32U | info.nFileIndexLow;
  const bool is_folder = (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
  return FileInfo{{info.dwVolumeSerialNumber, index}, is_folder ? FileKind::kFolder : FileKind::kRegular};
}

Result<Mapping> map_handle(HANDLE handle, const fs::path& path) {
  const auto info = look_at(handle);
  if (!info) return io_error(path, "cannot stat");
  if (info->kind != FileKind::kRegular) return Error{ErrorCode::kIo, path.string(), "not a regular file"};
  LARGE_INTEGER size{};
  if (::GetFileSizeEx(handle, &size) == 0) return io_error(path, "cannot stat");
  Mapping out{{}, info->id};
  if (size.QuadPart == 0) return out;
  HANDLE object = ::CreateFileMappingW(handle, nullptr, PAGE_READONLY, 0, 0, nullptr);
  if (object == nullptr) return io_error(path, "cannot map");
  const void* address = ::MapViewOfFile(object, FILE_MAP_READ, 0, 0, static_cast<SIZE_T>(size.QuadPart));
  const DWORD error = ::GetLastError();
  ::CloseHandle(object);  // the view keeps it
  ::SetLastError(error);
  if (address == nullptr) return io_error(path, "cannot map");
  out.bytes = {static_cast<const std::uint8_t*>(address), static_cast<std::size_t>(size.QuadPart)};
  return out;
}

}  // namespace

std::string last_error() {
  const DWORD error = ::GetLastError();
  switch (error) {  // what users meet, in the words that they meet elsewhere
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND: return "No such file or directory";
    case ERROR_ACCESS_DENIED: return "Permission denied";
    case ERROR_SHARING_VIOLATION: return "in use by another program";
    case ERROR_DISK_FULL: return "No space left on device";
    default: return "Windows error " + std::to_string(error);
  }
}

std::optional<FileInfo> find_info(const fs::path& path) {
  HANDLE handle = open_to_look(path);
  if (handle == INVALID_HANDLE_VALUE) return std::nullopt;
  auto info = look_at(handle);
  const DWORD error = ::GetLastError();
  ::CloseHandle(handle);
  ::SetLastError(error);
  return info;
}

/// As far as attributes tell: who has which right shows when it is used.
bool may_write(const fs::path& path, FileKind kind) {
  const DWORD attributes = ::GetFileAttributesW(path.c_str());
  if (attributes == INVALID_FILE_ATTRIBUTES) return kind == FileKind::kOther;
  if (kind == FileKind::kFolder || (attributes & FILE_ATTRIBUTE_READONLY) == 0) return true;
  ::SetLastError(ERROR_ACCESS_DENIED);
  return false;
}

Result<Mapping> map_file(const fs::path& path) {
  HANDLE handle = ::CreateFileW(path.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr, OPEN_EXISTING,
                                FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE) {
    const DWORD error = ::GetLastError();
    const auto info = find_info(path);  // a folder is not opened so, and says that access is denied
    if (info && info->kind == FileKind::kFolder) return Error{ErrorCode::kIo, path.string(), "not a regular file"};
    ::SetLastError(error);
    return io_error(path, "cannot open");
  }
  auto mapping = map_handle(handle, path);
  ::CloseHandle(handle);
  return mapping;
}

void unmap(std::span<const std::uint8_t> bytes) {
  ::UnmapViewOfFile(bytes.data());
}

Created create_locked(const fs::path& path, Handle& file) {
  HANDLE handle = ::CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE | DELETE, FILE_SHARE_DELETE, nullptr,
                                CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE) {
    return ::GetLastError() == ERROR_FILE_EXISTS ? Created::kNameTaken : Created::kFailed;
  }
  file = number_of(handle);
  return Created::kYes;
}

Handle open_device(const fs::path& path) {
  return number_of(::CreateFileW(path.c_str(), GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr,
                                 OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr));
}

bool write_all(Handle file, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMost = std::size_t{1} << 30U;  // a call's count has 32 bits
  while (!bytes.empty()) {
    DWORD written = 0;
    const auto count = static_cast<DWORD>(std::min(bytes.size(), kMost));
    if (::WriteFile(handle_of(file), bytes.data(), count, &written, nullptr) == 0 || written == 0) return false;
    bytes = bytes.subspan(written);
  }
  return true;
}

bool sync(Handle file) {
  return ::FlushFileBuffers(handle_of(file)) != 0;
}

bool close(Handle file) {
  return ::CloseHandle(handle_of(file)) != 0;
}

std::optional<FileInfo> info_of(Handle file) {
  return look_at(handle_of(file));
}

bool rename_over(const fs::path& from, const fs::path& to) {
  return ::MoveFileExW(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
}

void remove_file(const fs::path& path) {
  ::DeleteFileW(path.c_str());
}

/// Opened for nobody else: it fails where its writer lives. Removed when it is closed; a link would be removed itself.
void remove_unlocked(const fs::path& path) {
  HANDLE handle = ::CreateFileW(path.c_str(), GENERIC_READ | DELETE, 0, nullptr, OPEN_EXISTING,
                                FILE_FLAG_DELETE_ON_CLOSE | FILE_FLAG_OPEN_REPARSE_POINT, nullptr);
  if (handle != INVALID_HANDLE_VALUE) ::CloseHandle(handle);
}

bool sync_folder(const fs::path&) {
  return true;  // rename_over has written it through
}

std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::RtlGenRandom(&number, sizeof number) == 0) number = ::GetCurrentProcessId();
  return number;
}

std::optional<std::uint64_t> memory_left() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  if (::GlobalMemoryStatusEx(&status) == 0) return std::nullopt;
  return std::min(status.ullAvailPhys, status.ullAvailPageFile);
}

std::uint64_t resident_memory() {
  PROCESS_MEMORY_COUNTERS counters{};
  if (::K32GetProcessMemoryInfo(::GetCurrentProcess(), &counters, sizeof counters) == 0) return 0;
  return counters.WorkingSetSize;
}

bool restart_peak_memory() {
  return false;  // Windows keeps the peak of the whole process alone
}

std::uint64_t peak_memory() {
  return 0;
}

void give_back_freed_memory() {}

}  // namespace meshlode::system
