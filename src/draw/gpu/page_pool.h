// SPDX-License-Identifier: GPL-3.0-or-later
// A fixed pool of page slots on the device, and what the selection there reads of it: where each page begins, and of
// each group whether it may be opened. Between two frames pages are loaded by the priorities that the frame wrote.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/gpu/gpu_scene.h"
#include "run/read/asset.h"

namespace meshlode::draw {

/// Slots for a share of an asset's pages, at least those of the roots.
[[nodiscard]] std::uint32_t pool_slots(const run::Asset& asset, double share);

class PagePool {
 public:
  /// All slots are free. \pre the arguments outlive this; `scene` was uploaded with slots
  PagePool(Device& device, const run::Asset& asset, const GpuScene& scene);

  /// Of the last frame that a streaming Renderer drew, per page: the largest projected error of its open groups, in
  /// allowed errors; 0 where no group is open, format::kInfiniteError where one is terminal.
  [[nodiscard]] Result<std::vector<float>> read_priorities();
  /// Loads up to `most` missing pages, by falling priority, then ascending. Where no slot is free, the page with the
  /// least priority makes room, if that is below the loaded one's. Errors: as run::load_page(); kUnsupported where the
  /// device fails.
  [[nodiscard]] Status load_pages(std::span<const float> priorities, std::uint32_t most);

  /// Frees a slot, whatever is in it: for tests of what is drawn without a page.
  [[nodiscard]] Status drop(std::uint32_t slot);

  /// As run::ResidentQuery::resident.
  [[nodiscard]] std::span<const std::uint32_t> resident() const { return resident_; }
  [[nodiscard]] std::uint64_t loads() const { return loads_; }

 private:
  [[nodiscard]] Status load_page(std::uint32_t page, std::uint32_t slot);
  [[nodiscard]] Status upload_state();

  Device& device_;
  const run::Asset& asset_;
  const GpuScene& scene_;
  std::vector<std::uint32_t> page_of_slot_;  ///< kNone: free
  std::vector<std::uint32_t> word_of_page_, resident_;
  std::uint64_t loads_ = 0;
};

}  // namespace meshlode::draw
