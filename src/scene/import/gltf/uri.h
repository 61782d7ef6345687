// SPDX-License-Identifier: GPL-3.0-or-later
// URIs of a glTF file: data URIs, and relative paths that must stay below the scene's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::scene {

[[nodiscard]] bool is_data_uri(std::string_view uri);

struct DataUri {
  std::string mime_type;  ///< as written, empty where none is
  std::vector<std::uint8_t> bytes;
};

/// Decodes `data:[mime][;params];base64,…` or its percent-encoded form. Errors: kInvalid.
[[nodiscard]] Result<DataUri> decode_data_uri(std::string_view uri);

/// %41 -> A. Errors: kInvalid for a broken escape or an encoded NUL.
[[nodiscard]] Result<std::string> percent_decode(std::string_view text);

/// Strict base64 (RFC 4648 section 4); missing padding is accepted, other characters are not.
[[nodiscard]] Result<std::vector<std::uint8_t>> base64_decode(std::string_view text);

/// The file a relative URI names. It must lie below `folder`, before and after links are followed.
/// Errors: kInvalid an absolute path or one that leaves the folder, kUnsupported another scheme (http:, file:),
/// kIo it does not exist.
[[nodiscard]] Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, std::string_view uri);

/// The same of a plain path, which must be relative.
[[nodiscard]] Result<std::filesystem::path> resolve_below(const std::filesystem::path& folder, const std::string& path);

}  // namespace meshlode::scene
