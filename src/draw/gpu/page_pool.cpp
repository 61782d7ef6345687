// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/page_pool.h"

#include <algorithm>
#include <cmath>

#include "base/try.h"
#include "draw/gpu/upload_table.h"
#include "run/unpack/unpack.h"

namespace meshlode::draw {

std::uint32_t pool_slots(const run::Asset& asset, double share) {
  std::vector<std::uint32_t> pages;
  for (const format::GroupRecord& group : asset.groups()) {
    if ((group.flags & format::kGroupTerminal) != 0) pages.push_back(group.page);
  }
  std::sort(pages.begin(), pages.end());
  const auto roots = static_cast<std::uint32_t>(std::unique(pages.begin(), pages.end()) - pages.begin());
  const double all = static_cast<double>(asset.pages().size());
  return std::max({static_cast<std::uint32_t>(std::lround(all * std::clamp(share, 0.0, 1.0))), roots, 1U});
}

PagePool::PagePool(Device& device, const run::Asset& asset, const GpuScene& scene)
    : device_(device),
      asset_(asset),
      scene_(scene),
      page_of_slot_(scene.slot_count, format::kNone),
      word_of_page_(asset.pages().size()),
      resident_((asset.pages().size() + 31) / 32) {}

Result<std::vector<float>> PagePool::read_priorities() {
  std::vector<float> out(word_of_page_.size());
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(out.data()), out.size() * sizeof(float));
  TRY(device_.download(scene_.priorities, bytes));
  return out;
}

Status PagePool::load_page(std::uint32_t page, std::uint32_t slot) {
  TRY_LET(loaded, run::load_page(asset_, PageId(page)));
  const std::uint64_t at = std::uint64_t{slot} * scene_.slot_bytes;
  TRY(device_.upload(scene_.pages, loaded->bytes(), at));
  if (const std::uint32_t old = page_of_slot_[slot]; old != format::kNone) resident_[old / 32] &= ~(1U << old % 32);
  page_of_slot_[slot] = page;
  word_of_page_[page] = static_cast<std::uint32_t>(at / 4);
  resident_[page / 32] |= 1U << page % 32;
  ++loads_;
  return Ok{};
}

/// Once per change and not per instance and frame. Clusters lie with the group that they are members of, and that has a
/// smaller id than the one they were made from.
Status PagePool::upload_state() {
  const auto groups = asset_.groups();
  std::vector<std::uint32_t> ready((groups.size() + 31) / 32, ~0U);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t page = groups[g].page;
    if ((resident_[page / 32] >> page % 32 & 1U) == 0) ready[g / 32] &= ~(1U << g % 32);
    if ((ready[g / 32] >> g % 32 & 1U) != 0) continue;
    for (const format::ClusterRecord& cluster :
         asset_.clusters().subspan(groups[g].first_cluster, groups[g].cluster_count)) {
      const std::uint32_t own = cluster.own_group;
      if (own != format::kNone) ready[own / 32] &= ~(1U << own % 32);
    }
  }
  TRY(device_.upload(scene_.page_words, bytes_of_table(word_of_page_)));
  return device_.upload(scene_.ready, bytes_of_table(ready));
}

Status PagePool::drop(std::uint32_t slot) {
  std::uint32_t& page = page_of_slot_[slot];
  if (page == format::kNone) return Ok{};
  resident_[page / 32] &= ~(1U << page % 32);
  page = format::kNone;
  return upload_state();
}

Status PagePool::load_pages(std::span<const float> priorities, std::uint32_t most) {
  std::vector<std::uint32_t> wanted;
  for (std::uint32_t page = 0; page < priorities.size(); ++page) {
    if (priorities[page] > 0.0F && (resident_[page / 32] >> page % 32 & 1U) == 0) wanted.push_back(page);
  }
  std::stable_sort(wanted.begin(), wanted.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return priorities[a] > priorities[b]; });
  if (wanted.size() > most) wanted.resize(most);
  const auto priority_of = [&](std::uint32_t page) { return page == format::kNone ? -1.0F : priorities[page]; };
  bool has_changed = false;
  for (const std::uint32_t page : wanted) {
    const auto slot =
        std::min_element(page_of_slot_.begin(), page_of_slot_.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return priority_of(a) < priority_of(b); });
    if (slot == page_of_slot_.end() || priority_of(*slot) >= priorities[page]) break;
    TRY(load_page(page, static_cast<std::uint32_t>(slot - page_of_slot_.begin())));
    has_changed = true;
  }
  return has_changed ? upload_state() : Status(Ok{});
}

}  // namespace meshlode::draw
