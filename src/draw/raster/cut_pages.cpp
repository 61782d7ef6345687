// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/cut_pages.h"

#include "base/parallel.h"
#include "base/try.h"

namespace meshlode::draw {

namespace {

std::uint32_t page_of(const run::Asset& asset, ClusterId cluster) {
  return asset.groups()[asset.clusters()[cluster.value].coarser_group].page;
}

}  // namespace

Result<CutPages> CutPages::load(const run::Asset& asset, std::span<const run::ClusterInstance> cut) {
  std::vector<std::uint8_t> is_needed(asset.pages().size(), 0);
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const bool is_known =
        cut[i].instance.value < asset.instances().size() && cut[i].cluster.value < asset.clusters().size();
    const std::uint32_t mesh = is_known ? asset.instances()[cut[i].instance.value].mesh : format::kNone;
    const auto covers = [&](const format::MeshRecord& m) {
      return cut[i].cluster.value - m.first_cluster < m.cluster_count;
    };
    if (!is_known || !covers(asset.meshes()[mesh])) {
      return Error{ErrorCode::kUsage, "cut entry " + std::to_string(i), "no such cluster in this instance"};
    }
    is_needed[page_of(asset, cut[i].cluster)] = 1;
  }
  std::uint64_t bytes = 0;
  for (std::size_t page = 0; page < is_needed.size(); ++page)
    bytes += is_needed[page] != 0 ? asset.pages()[page].bytes : 0;
  TRY(run::check_decoded_bytes(asset, bytes));
  CutPages out;
  out.pages_.resize(asset.pages().size());
  std::vector<std::optional<Error>> errors(asset.pages().size());
  parallel_for_each_index(asset.pages().size(), 1, [&](std::size_t page) {
    if (is_needed[page] == 0) return;
    Result<run::PageBytes> loaded = run::load_page(asset, PageId(page));
    if (loaded) {
      out.pages_[page].emplace(std::move(*loaded));
    } else {
      errors[page] = loaded.error();
    }
  });
  for (const std::optional<Error>& error : errors) {
    if (error) return *error;
  }
  return out;
}

void CutPages::decode(const run::Asset& asset, ClusterId cluster, run::DecodedCluster& out) const {
  run::decode_cluster(asset, *pages_[page_of(asset, cluster)], cluster, out);
}

}  // namespace meshlode::draw
