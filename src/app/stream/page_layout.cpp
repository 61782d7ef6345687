// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/page_layout.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>

#include "base/enum_names.h"
#include "base/printable.h"
#include "builder/order/covisible_order.h"
#include "builder/order/deal_groups.h"
#include "builder/preset.h"

namespace meshlode::app {

namespace {

std::optional<std::uint32_t> whole_number(std::string_view word) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

/// What comes before the separator; `rest` becomes what comes after it.
std::string_view take_word(std::string_view& rest, char separator) {
  const std::size_t at = rest.find(separator);
  const std::string_view word = rest.substr(0, at);
  rest = at == std::string_view::npos ? std::string_view() : rest.substr(at + 1);
  return word;
}

std::optional<PageLayout> parse_layout(std::string_view word) {
  PageLayout layout;
  const bool has_order = word.find('/') != std::string_view::npos;
  const auto kib = whole_number(take_word(word, '/'));
  if (!kib || !builder::is_page_size(*kib)) return {};
  layout.page_kib = *kib;
  if (!has_order) return layout;
  const bool has_root = word.find('/') != std::string_view::npos;
  const auto order = value_in(builder::kPageOrderNames, take_word(word, '/'));
  if (!order) return {};
  layout.order = *order;
  if (!has_root) return layout;
  const auto root = whole_number(word);
  if (!root || *root == 0 || !builder::is_root_size(*root)) return {};
  layout.root_bytes = *root;
  return layout;
}

/// In object units, as a build has them before they are stored.
builder::OrderedGroups groups_of(const StreamScene& scene, const format::MeshRecord& mesh) {
  builder::OrderedGroups out;
  const double unit = std::ldexp(1.0, mesh.sphere_log2);
  for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
    const format::GroupRecord& group = scene.groups[g];
    out.groups.push_back({group.first_cluster - mesh.first_cluster,
                          group.cluster_count,
                          group.level,
                          (group.flags & format::kGroupTerminal) != 0,
                          {{group.center[0], group.center[1], group.center[2]}, group.radius},
                          group.error});
  }
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    const format::ClusterRecord& cluster = scene.clusters[c];
    const auto length = [&](int units) { return static_cast<float>(units * unit); };
    out.clusters.push_back(
        {{{length(cluster.center[0]), length(cluster.center[1]), length(cluster.center[2])}, length(cluster.radius)},
         cluster.own_group == format::kNone ? kNoId : cluster.own_group - mesh.first_group,
         cluster.coarser_group - mesh.first_group});
  }
  return out;
}

/// Stored bytes over decoded ones of a mesh's pages.
double stored_share(const StreamScene& scene, std::span<const format::GroupRecord> groups) {
  std::uint64_t bytes = 0, stored = 0;
  std::uint32_t last = kNoId;
  for (const format::GroupRecord& group : groups) {  // a page's groups lie one behind the other
    if (group.page == last) continue;
    last = group.page;
    bytes += scene.pages[last].bytes;
    stored += scene.pages[last].stored_bytes;
  }
  return bytes > 0 ? static_cast<double>(stored) / static_cast<double>(bytes) : 1.0;
}

}  // namespace

std::string PageLayout::text() const {
  std::string out = std::to_string(page_kib) + "/" + builder::name_of(order);
  if (root_bytes != 0) out += "/" + std::to_string(root_bytes);
  return out;
}

Result<std::vector<PageLayout>> parse_layouts(std::string_view text, const std::string& where) {
  constexpr std::size_t kMostLayouts = 32;
  std::vector<PageLayout> layouts;
  for (bool is_more = true; is_more;) {
    is_more = text.find(',') != std::string_view::npos;
    const std::string_view word = take_word(text, ',');
    const auto layout = parse_layout(word);
    if (!layout) {
      return Error{ErrorCode::kUsage, where,
                   "expected 16, 32, 64 or 128, then /level or /covisible, then /BYTES of first pages, 16384 to "
                   "131072, as in 32/covisible/131072" +
                       got_text(word)};
    }
    if (layouts.size() == kMostLayouts) return Error{ErrorCode::kUsage, where, "at most 32 layouts"};
    layouts.push_back(*layout);
  }
  return layouts;
}

StreamScene with_layout(const StreamScene& scene, const PageLayout& layout) {
  StreamScene out = scene;
  out.pages.clear();
  const std::size_t page_bytes = std::size_t{layout.page_kib} * 1024;
  for (const format::MeshRecord& mesh : scene.meshes) {
    const std::span groups = std::span(scene.groups).subspan(mesh.first_group, mesh.group_count);
    builder::CovisibleOrder order;
    if (layout.order == PageOrder::kCovisible) {
      order = builder::covisible_order(groups_of(scene, mesh));
    } else {
      order.groups.resize(groups.size());
      std::iota(order.groups.begin(), order.groups.end(), 0U);
    }
    std::vector<std::size_t> group_bytes;
    for (const std::uint32_t g : order.groups) {
      const auto first = scene.cluster_bytes.begin() + groups[g].first_cluster;
      group_bytes.push_back(std::accumulate(first, first + groups[g].cluster_count, std::size_t{0}));
    }
    const double share = stored_share(scene, groups);
    const auto first_page = static_cast<std::uint32_t>(out.pages.size());
    const std::vector<std::uint32_t> page_of = builder::deal_groups(
        group_bytes, layout.root_bytes > 0 ? layout.root_bytes : page_bytes, page_bytes, order.needs);
    for (std::size_t i = 0; i < order.groups.size(); ++i) {
      const std::uint32_t page = first_page + page_of[i];
      if (page == out.pages.size()) out.pages.push_back({builder::kPageFrameBytes, 0});
      out.pages[page].bytes += static_cast<std::uint32_t>(group_bytes[i]);
      out.groups[mesh.first_group + order.groups[i]].page = page;
    }
    for (std::size_t p = first_page; p < out.pages.size(); ++p) {
      out.pages[p].stored_bytes = static_cast<std::uint32_t>(std::lround(share * out.pages[p].bytes));
    }
  }
  return out;
}

}  // namespace meshlode::app
