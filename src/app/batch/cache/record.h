// SPDX-License-Identifier: GPL-3.0-or-later
// What the cache knows of an asset beside its bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/batch/jobs/job_result.h"
#include "base/hash.h"

namespace meshlode::app {

struct AssetRecord {
  std::string ingredients;  ///< whose hash is the key: told apart once more, whole
  Hash128 asset{};          ///< hash128 of the asset's bytes
  JobFacts facts;
};

[[nodiscard]] std::vector<std::uint8_t> record_bytes(const AssetRecord& record);
/// Nothing for other bytes.
[[nodiscard]] std::optional<AssetRecord> read_record(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::app
