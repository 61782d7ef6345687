// SPDX-License-Identifier: GPL-3.0-or-later
// What a file is that a command was given: an asset where a scene is expected, or the other way round, is named as what
// it is, with the command to use.
#pragma once

#include <cstdint>
#include <string>

#include <meshlode/result.h>

#include "run/read/asset.h"

namespace meshlode::cli {

enum class FileForm : std::uint8_t { kUnreadable, kEmpty, kAsset, kScene, kOther };

struct SeenFile {
  FileForm form = FileForm::kOther;
  std::string name{};  ///< of a scene: "a GLB scene"
};

/// By its first bytes where they tell, else by its extension: a scene is what import takes for one.
[[nodiscard]] SeenFile look_at_file(const std::string& path);

/// Error: kInvalid, for a scene, an empty file, and what does not begin as an asset does, named as what they are.
[[nodiscard]] Status check_may_be_asset(const std::string& path);

/// Error: kInvalid, for a scene, an asset and an empty file, named as what they are. `writer`: the command that
/// writes one.
[[nodiscard]] Status check_is_manifest(const std::string& path,
                                       const std::string& writer = "meshlode build --manifest");

/// run::Asset::open, with that error first.
[[nodiscard]] Result<run::Asset> open_asset(const std::string& path,
                                            std::uint64_t max_decoded = run::kDefaultMaxDecoded);

}  // namespace meshlode::cli
