// SPDX-License-Identifier: GPL-3.0-or-later
// Deal: groups in their order become pages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

namespace meshlode::builder {

/// The header of a page and the zero word behind it.
constexpr std::uint32_t kPageFrameBytes = static_cast<std::uint32_t>(sizeof(format::PageHeader)) + 4U;

/// With 1,024 and with 4,096 the working sets of the dragon's paths in pages of 32 KiB are the same within 1%.
constexpr std::uint32_t kTrainingViews = 2048;
/// Which training views need a group, a bit each.
using ViewBits = std::array<std::uint64_t, kTrainingViews / 64>;

/// Which page each group is in, for groups in the order given. The first page takes as many as fit it; a group that
/// fits none has one of its own. Without `needs` all pages are filled as the first. With them they end where the views
/// load least: each page counts once for each view that needs one of its groups, with its bytes and, for the request,
/// `page_bytes`.
/// \param group_bytes  of all members of each, in the page  \param first_page_bytes, page_bytes  a page is full there
/// \param needs  none, or of each group
[[nodiscard]] std::vector<std::uint32_t> deal_groups(std::span<const std::size_t> group_bytes,
                                                     std::size_t first_page_bytes, std::size_t page_bytes,
                                                     std::span<const ViewBits> needs = {});

}  // namespace meshlode::builder
