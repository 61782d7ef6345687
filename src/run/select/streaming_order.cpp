// SPDX-License-Identifier: MIT
#include "run/select/streaming_order.h"

#include <algorithm>

namespace meshlode::run {
namespace {

/// Largest error of a page's groups: what is drawn without the page is off by at least the smallest, at most this.
float largest_error(const Asset& asset, const format::PageRecord& page) {
  float error = 0.0F;
  for (const format::GroupRecord& group : asset.groups().subspan(page.first_group, page.group_count)) {
    error = std::max(error, group.error);
  }
  return error;
}

}  // namespace

std::vector<std::uint32_t> streaming_order(const Asset& asset) {
  const std::size_t count = asset.pages().size();
  // A page counts with the largest error of all that depends on it, or it would hold up a page that matters more.
  std::vector<float> errors(count);
  for (std::size_t p = count; p-- > 0;) {  // what depends on a page comes after it
    const format::PageRecord& page = asset.pages()[p];
    errors[p] = std::max(errors[p], largest_error(asset, page));
    for (const std::uint32_t needed : asset.page_dependencies().subspan(page.first_dependency, page.dependency_count)) {
      errors[needed] = std::max(errors[needed], errors[p]);
    }
  }
  // So errors never grow from a page to what depends on it, and with the ids for equal ones the order is right.
  std::vector<std::uint32_t> order(count);
  for (std::size_t p = 0; p < count; ++p) order[p] = static_cast<std::uint32_t>(p);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return errors[a] > errors[b]; });
  return order;
}

std::vector<FileRange> first_ranges(const Asset& asset, std::uint64_t max_gap) {
  constexpr std::uint64_t kPadding = format::kSectionAlignment - 1;  // between neighbours, at most
  std::vector<std::uint8_t> is_drawn(asset.meshes().size());
  for (const format::InstanceRecord& instance : asset.instances()) {
    if ((instance.flags & format::kInstanceSingular) == 0) is_drawn[instance.mesh] = 1;
  }
  std::vector<FileRange> ranges;
  for (const format::PageRecord& page : asset.pages()) {  // ascending in the file too
    const auto groups = asset.groups().subspan(page.first_group, page.group_count);
    const bool is_first = std::any_of(groups.begin(), groups.end(), [&](const format::GroupRecord& group) {
      return (group.flags & format::kGroupTerminal) != 0 && is_drawn[group.mesh] != 0;
    });
    if (!is_first) continue;
    const std::uint64_t end = ranges.empty() ? 0 : ranges.back().offset + ranges.back().bytes;
    if (!ranges.empty() && page.offset - end <= std::max(max_gap, kPadding)) {
      ranges.back().bytes = page.offset + page.stored_bytes - ranges.back().offset;
    } else {
      ranges.push_back({page.offset, page.stored_bytes});
    }
  }
  return ranges;
}

}  // namespace meshlode::run
