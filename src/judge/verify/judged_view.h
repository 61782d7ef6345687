// SPDX-License-Identifier: GPL-3.0-or-later
// Random cameras, and what the selection rule says of a group for them, in double precision: what cuts of cameras are
// judged by. Internal to the judge.
#pragma once

#include <cstdint>
#include <span>

#include "base/random.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::judge {

struct JudgedView {
  run::Camera camera;
  double pixel_error = 1.0;
  const char* kind = "";
};

[[nodiscard]] bool is_drawable(const run::Asset& asset, const format::InstanceRecord& instance);

/// A camera around a random cluster of a random instance, so that cuts are mixed more often than not. Five kinds, by
/// the index: inside, near, mid, far and orthographic.
[[nodiscard]] JudgedView random_view(const run::Asset& asset, std::span<const std::uint32_t> instances,
                                     std::uint32_t index, SplitMix64& random);

enum class Answer : std::uint8_t { kFails, kPasses, kTooClose };

struct WeighedGroup {
  Answer answer;
  double low_px, high_px;  ///< its projected error lies between
};
/// The rule of docs/reference/selection.md in doubles: e·s·k <= t·max(|M·c - eye| - r·s, near); orthographic e·s·k <=
/// t.
[[nodiscard]] WeighedGroup weigh(const JudgedView& view, const format::InstanceRecord& instance,
                                 const format::MeshRecord& mesh, const format::GroupRecord& group);

}  // namespace meshlode::judge
