// SPDX-License-Identifier: GPL-3.0-or-later
// The structural judge, the exporter and the reports on any bytes: what `validate`, `extract`, `info` and `compare` do
// with a hostile file. They read what the runtime does not: the JSON sections, texts, and pages that were found wrong.
#include <string>
#include <string_view>
#include <vector>

#include "app/compare/compare.h"
#include "app/export/choose_cuts.h"
#include "app/export/export.h"
#include "asset_mutator.h"
#include "harness.h"
#include "judge/validate/validate.h"

namespace {

/// Both documents are JSON whatever the file holds, and an asset is equal to itself.
void print_reports(const meshlode::run::Asset& asset) {
  using namespace meshlode;
  const auto judge = [](std::string_view text, std::string_view schema, const std::string& document) {
    const auto budget = app::read_budget(text, schema);
    fuzz::require(budget.ok() && app::judge_budget(*budget, document).ok(), "a document is no JSON");
  };
  const app::AssetComparison same = app::compare_assets(asset, asset);
  fuzz::require(same.is_content_equal && same.settings.empty() && same.meshes_added.empty() &&
                    same.meshes_removed.empty() && same.images.changed.empty(),
                "an asset differs from itself");
  judge("any(meshes).any(by_level).error_max.change!=0, any(settings).key==a", app::compare_schema(),
        app::comparison_json(same));
  fuzz::require(!app::comparison_text(same).empty(), "no text");
  judge("any(meshes).stuck_groups>0, any(stuck).triangles>1", app::info_schema(),
        app::info_json(asset, app::describe_asset(asset), true));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meshlode;
  const std::vector<std::uint8_t> bytes(data, data + size);
  const judge::ValidationReport report = judge::validate_asset(bytes);
  const auto asset = run::Asset::from_bytes(bytes);
  fuzz::require(asset.ok() || report.finding_count > 0, "the judge finds nothing in a file that does not open");
  if (!asset || asset->instances().size() > 1000) return 0;
  print_reports(*asset);
  std::vector<app::LodChain> chains(asset->meshes().size());
  for (std::size_t m = 0; m < chains.size(); ++m) {
    chains[m].cuts = {app::choose_level_cut(*asset, MeshId(m), 0).clusters};
    const auto coarse = app::choose_level_cut(*asset, MeshId(m), 0xFFFF).clusters;
    if (!coarse.empty() && coarse != chains[m].cuts[0] && !chains[m].cuts[0].empty()) chains[m].cuts.push_back(coarse);
  }
  const auto glb = app::export_glb_lods(*asset, chains);
  fuzz::require(glb.ok() || !glb.error().message().empty(), "a refusal without a reason");
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, 0);
}
#endif
