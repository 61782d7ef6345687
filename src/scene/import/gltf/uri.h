// SPDX-License-Identifier: GPL-3.0-or-later
// URIs of a glTF file: data URIs, and paths, which must stay below the scene's folder or one that the caller allows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
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

/// Decodes `data:[mime][;params];base64,…`, of which blanks, line breaks and percent escapes are taken out, or the
/// percent-encoded form. Errors: kInvalid.
[[nodiscard]] Result<DataUri> decode_data_uri(std::string_view uri);

/// %41 -> A. Errors: kInvalid for a broken escape or an encoded NUL.
[[nodiscard]] Result<std::string> percent_decode(std::string_view text);

/// Strict base64 (RFC 4648 section 4); missing padding is accepted, other characters are not.
[[nodiscard]] Result<std::vector<std::uint8_t>> base64_decode(std::string_view text);

/// The paths that a URI may mean, the likely one first: percent-decoded; its very letters, for "100%wood.png" is no
/// escape; and both with "/" for "\\". None for a scheme other than file:.
[[nodiscard]] std::vector<std::string> paths_of_uri(std::string_view uri);

/// The first of paths_of_uri() that there is. It must lie below `folder`, or below one of `allowed` (whatever way leads
/// there: a path with "..", an absolute one, a file: URI), before and after links are followed.
/// Errors: kInvalid an absolute path or one that leaves the folder, kUnsupported another scheme (http:, C:),
/// kIo it does not exist.
[[nodiscard]] Result<std::filesystem::path> resolve_uri(const std::filesystem::path& folder, std::string_view uri,
                                                        std::span<const std::filesystem::path> allowed = {});

/// The same of a plain path.
[[nodiscard]] Result<std::filesystem::path> resolve_below(const std::filesystem::path& folder, const std::string& path,
                                                          std::span<const std::filesystem::path> allowed = {});

/// Why a file that a scene names is done without, to be said after its name: in words that are the same on every
/// machine, without what the machine says. `error`: of resolve_uri() or resolve_below(), or of opening what they found.
[[nodiscard]] std::string reason_not_opened(const Error& error);

}  // namespace meshlode::scene
