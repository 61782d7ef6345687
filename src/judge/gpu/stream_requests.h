// SPDX-License-Identifier: GPL-3.0-or-later
// V410 without a device: what may be wrong with the pages that a frame asks for, and with a frame that is culled.
// Priorities are per page; 0: nobody wants it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "run/select/select.h"

namespace meshlode::judge {

/// The device's priorities against the CPU's, which are in pixels. "": they are the same up to rounding.
/// `pixel_error`: of the frame; the device's priorities are multiples of it.
[[nodiscard]] std::string find_priority_fault(std::span<const float> device, std::span<const float> host,
                                              double pixel_error);

struct DrawnFrame {
  std::span<const run::ClusterInstance> cut;  ///< ascending
  std::span<const float> priorities;
};
/// A frame that is culled by the view volume against the same one that is not. "": nothing else is drawn or asked for
/// by more. \pre both have priorities of as many pages
[[nodiscard]] std::string find_culled_fault(const DrawnFrame& culled, const DrawnFrame& whole);

/// "": each of `seen`, pages of which something would be seen if all were there, is asked for.
[[nodiscard]] std::string find_unasked_page(std::span<const float> priorities, std::span<const std::uint32_t> seen);

}  // namespace meshlode::judge
