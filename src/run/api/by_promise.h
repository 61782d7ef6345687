// SPDX-License-Identifier: MIT
// An open asset by each promise that it has, so that threads select with different ones at once and no frame makes any:
// what C++ and C select from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "run/read/asset.h"

namespace meshlode::run {

constexpr std::uint32_t kPromiseCount = std::uint32_t{static_cast<std::uint32_t>(format::Promise::kAppearance)} + 1;
constexpr const char* kPromiseFault = "is not one of its enumerators";

class AssetByPromise {
 public:
  explicit AssetByPromise(Asset asset) : asset_(std::move(asset)) {
    for (std::uint32_t p = 1; p < kPromiseCount; ++p) {
      if (!asset_.has_promise(static_cast<format::Promise>(p))) continue;
      if (auto made = asset_.with_promise(static_cast<format::Promise>(p))) others_[p] = std::move(*made);
    }
  }

  [[nodiscard]] const Asset& by_position() const { return asset_; }
  /// Errors: kUsage for an unknown value; kUnsupported where the asset was not built with it, with the remedy.
  [[nodiscard]] Result<const Asset*> by(std::uint32_t promise) const {
    if (promise >= kPromiseCount) return Error{ErrorCode::kUsage, "promise", kPromiseFault};
    if (promise == 0) return &asset_;
    if (others_[promise]) return &*others_[promise];
    return asset_.with_promise(static_cast<format::Promise>(promise)).error();
  }

 private:
  Asset asset_;
  std::array<std::optional<Asset>, kPromiseCount> others_;  ///< the first one stays empty
};

}  // namespace meshlode::run
