// SPDX-License-Identifier: GPL-3.0-or-later
// The small questions every check of a glTF tree asks. The first failure is kept; the rest are skipped over.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <meshlode/result.h>

#include "scene/import/json.h"

namespace meshlode::scene {

class JsonChecker {
 public:
  static constexpr std::size_t kMaxMembers = 256;

  explicit JsonChecker(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] Status status() const {
    if (error_) return *error_;
    return Ok{};
  }
  [[nodiscard]] bool ok() const { return !error_; }

  bool fail(const std::string& path, std::string detail, ErrorCode code = ErrorCode::kInvalid);

  /// The member is absent or an array of objects of at most kMaxMembers members: they are looked up again and again, by
  /// name in a list, so they must be few for the checks to be linear in the text.
  bool objects(const Json& object, const std::string& path, std::string_view key);
  bool optional_object(const Json& object, const std::string& path, std::string_view key);
  bool optional_string(const Json& object, const std::string& path, std::string_view key);
  bool optional_bool(const Json& object, const std::string& path, std::string_view key);
  bool optional_number(const Json& object, const std::string& path, std::string_view key);
  /// The member is absent or an array of exactly `count` numbers.
  bool optional_numbers(const Json& object, const std::string& path, std::string_view key, std::size_t count);
  /// The member is absent or a whole number below `limit`.
  bool optional_index(const Json& object, const std::string& path, std::string_view key, std::uint64_t limit);
  bool required_index(const Json& object, const std::string& path, std::string_view key, std::uint64_t limit);
  /// The member is absent or an array of whole numbers below `limit`.
  bool optional_indices(const Json& object, const std::string& path, std::string_view key, std::uint64_t limit);
  /// Every member of the object is a whole number below `limit`.
  bool index_map(const Json& object, const std::string& path, std::uint64_t limit);

 private:
  bool check_index(const Json& value, const std::string& path, std::uint64_t limit);

  std::string file_;
  std::optional<Error> error_;
};

/// The member as a whole number, or `fallback`. \pre checked
[[nodiscard]] std::uint64_t index_or(const Json& object, std::string_view key, std::uint64_t fallback);

/// A key as a JSON pointer's part: control characters are not for a terminal, and long ones are cut.
[[nodiscard]] std::string pointer_part(std::string_view key);

}  // namespace meshlode::scene
