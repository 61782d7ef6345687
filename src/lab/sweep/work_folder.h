// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of a run's own for assets, gone when it ends.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include <meshlode/result.h>

namespace meshlode::lab {

class WorkFolder {
 public:
  /// Below `parent`. Error: kIo.
  static Result<WorkFolder> make(const std::filesystem::path& parent) {
    std::string name = (parent / ".meshlode-sweep-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      return Error{ErrorCode::kIo, parent.string(), std::error_code(errno, std::generic_category()).message()};
    }
    return WorkFolder(name);
  }
  WorkFolder(WorkFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit WorkFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace meshlode::lab
