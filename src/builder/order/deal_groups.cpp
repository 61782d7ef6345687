// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/order/deal_groups.h"

#include <bit>
#include <limits>

namespace meshlode::builder {

namespace {

/// Where the pages of the groups from `begin` on start, by what all views load: the least for the groups up to each
/// from the least for those before its page.
std::vector<std::size_t> cheapest_starts(std::span<const std::size_t> group_bytes, std::size_t begin,
                                         std::size_t page_bytes, std::span<const ViewBits> needs) {
  const std::size_t end = group_bytes.size();
  std::vector<std::uint64_t> least(end + 1, std::numeric_limits<std::uint64_t>::max());
  std::vector<std::size_t> start_of(end + 1, begin);  // of the page that ends there
  least[begin] = 0;
  for (std::size_t start = begin; start < end; ++start) {
    ViewBits any{};
    std::size_t bytes = kPageFrameBytes;
    for (std::size_t g = start; g < end; ++g) {
      bytes += group_bytes[g];
      if (g > start && bytes > page_bytes) break;
      std::uint64_t views = 0;
      for (std::size_t w = 0; w < any.size(); ++w) {
        any[w] |= needs[g][w];
        views += static_cast<std::uint64_t>(std::popcount(any[w]));
      }
      const std::uint64_t cost = least[start] + (bytes + page_bytes) * views;
      if (cost >= least[g + 1]) continue;  // of equal ones the longest page
      least[g + 1] = cost;
      start_of[g + 1] = start;
    }
  }
  std::vector<std::size_t> starts;
  for (std::size_t at = end; at > begin; at = start_of[at]) starts.push_back(start_of[at]);
  return {starts.rbegin(), starts.rend()};
}

}  // namespace

std::vector<std::uint32_t> deal_groups(std::span<const std::size_t> group_bytes, std::size_t first_page_bytes,
                                       std::size_t page_bytes, std::span<const ViewBits> needs) {
  std::vector<std::uint32_t> page_of(group_bytes.size());
  std::vector<std::size_t> starts;
  std::uint32_t page = 0;
  std::size_t bytes = kPageFrameBytes;
  for (std::size_t g = 0; g < group_bytes.size(); ++g) {
    bool is_next = g > 0 && bytes + group_bytes[g] > (page == 0 ? first_page_bytes : page_bytes);
    if (!needs.empty() && is_next && page == 0) starts = cheapest_starts(group_bytes, g, page_bytes, needs);
    if (!starts.empty()) is_next = page < starts.size() && g == starts[page];
    if (is_next) {
      ++page;
      bytes = kPageFrameBytes;
    }
    bytes += group_bytes[g];
    page_of[g] = page;
  }
  return page_of;
}

}  // namespace meshlode::builder
