// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/report_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meshlode::lab {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 2> kFolders{"pictures", "plots"};

Error io_error(const fs::path& path, const std::error_code& error) {
  return {ErrorCode::kIo, path.string(), error.message()};
}

/// No file right below `folder` is one that was read.
Status check_files(const fs::path& folder, std::span<const FileId> read) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const auto id = find_file_id(at->path());
    if (!id || std::find(read.begin(), read.end(), *id) == read.end()) continue;
    return Error{ErrorCode::kUsage, at->path().string(), "the output would overwrite a file that was read"};
  }
  return error ? Status(io_error(folder, error)) : Status(Ok{});
}

/// Lines are appended to the state: a link would put them into another file.
Status check_state(const fs::path& state) {
  struct stat info {};
  if (::lstat(state.c_str(), &info) != 0) return Ok{};
  if (S_ISREG(info.st_mode) && info.st_nlink == 1) return Ok{};
  return Error{ErrorCode::kUsage, state.string(), "is a link or not a regular file; remove it to measure again"};
}

Status make_state(const fs::path& state) {
  const int file = ::open(state.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return Error{ErrorCode::kIo, state.string(), std::strerror(errno)};
  ::close(file);
  return Ok{};
}

}  // namespace

fs::path state_file_of(const fs::path& report) {
  return report / "sweep-state.txt";
}

Status make_report_folder(const fs::path& report, std::span<const FileId> read) {
  std::error_code error;
  fs::create_directories(report, error);
  if (error) return io_error(report, error);
  const bool is_empty = fs::is_empty(report, error);
  if (error) return io_error(report, error);
  const fs::path state = state_file_of(report);
  const bool has_state = fs::exists(fs::symlink_status(state, error));
  if (!is_empty && !has_state) {
    return Error{ErrorCode::kUsage, report.string(), "has other things in it; name a new folder, or that of a sweep"};
  }
  if (Status sound = check_files(report, read); !sound) return sound;
  for (const char* name : kFolders) {
    const fs::path folder = report / name;
    const fs::file_status status = fs::symlink_status(folder, error);
    if (!fs::exists(status)) continue;
    if (!fs::is_directory(status))
      return Error{ErrorCode::kUsage, folder.string(), "is a link or no folder; remove it"};
    if (Status sound = check_files(folder, read); !sound) return sound;
  }
  if (Status sound = check_state(state); !sound) return sound;
  if (Status made = make_state(state); !made) return made;
  fs::create_directories(report / kFolders[0], error);
  if (error) return io_error(report / kFolders[0], error);
  return Ok{};
}

}  // namespace meshlode::lab
