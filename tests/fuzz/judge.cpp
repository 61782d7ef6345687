// SPDX-License-Identifier: GPL-3.0-or-later
// The structural judge and the exporter on any bytes: what `validate` and `extract` do with a hostile file. Both read
// what the runtime does not: the JSON sections, texts, and pages that were found wrong.
#include <vector>

#include "asset_mutator.h"
#include "harness.h"
#include "judge/validate/validate.h"
#include "out/export/choose_cuts.h"
#include "out/export/export.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace meshlode;
  const std::vector<std::uint8_t> bytes(data, data + size);
  const judge::ValidationReport report = judge::validate_asset(bytes);
  const auto asset = run::Asset::from_bytes(bytes);
  fuzz::require(asset.ok() || report.finding_count > 0, "the judge finds nothing in a file that does not open");
  if (!asset || asset->instances().size() > 1000) return 0;
  std::vector<out::LodChain> chains(asset->meshes().size());
  for (std::size_t m = 0; m < chains.size(); ++m) {
    chains[m].cuts = {out::choose_level_cut(*asset, MeshId(m), 0).clusters};
    const auto coarse = out::choose_level_cut(*asset, MeshId(m), 0xFFFF).clusters;
    if (!coarse.empty() && coarse != chains[m].cuts[0] && !chains[m].cuts[0].empty()) chains[m].cuts.push_back(coarse);
  }
  const auto glb = out::export_glb_lods(*asset, chains);
  fuzz::require(glb.ok() || !glb.error().message().empty(), "a refusal without a reason");
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, 0);
}
#endif
