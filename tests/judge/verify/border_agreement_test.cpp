// SPDX-License-Identifier: GPL-3.0-or-later
// Builder and judge hold a border to the same definition, each by its own code: on random open surfaces and what became
// of them, rightly or not, one accepts what the other does.
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/border_rule.h"
#include "builder/simplify/simplify.h"
#include "drawn_surface.h"
#include "judge/validate/borders.h"
#include "run/decode/decode.h"
#include "support/open_surface.h"

namespace meshlode::judge {
namespace {

using test::Corner;
using test::Patch;
using test::Random;

builder::SimplifyInput as_input(const test::IntegerMesh& mesh) {
  builder::SimplifyInput input;
  std::map<Corner, std::uint32_t> first;  // what lies on one point of the grid is one position
  std::vector<std::uint32_t> name;
  for (const Vec3i& p : mesh.positions) {
    const auto [at, is_new] = first.emplace(Corner{p.x, p.y, p.z}, static_cast<std::uint32_t>(input.positions.size()));
    name.push_back(at->second);
    if (!is_new) continue;
    input.wedge_position.push_back(at->second);
    input.positions.push_back(p);
    input.witnesses.push_back({{p}, 1});
  }
  input.is_locked.assign(input.positions.size(), 0);
  input.is_wedge_shared.assign(input.positions.size(), 0);
  for (const auto& t : mesh.triangles) input.triangles.push_back({name[t[0]], name[t[1]], name[t[2]]});
  if (input.triangles.size() > 100) input.triangles.resize(100);  // one cluster
  input.triangle_material.assign(input.triangles.size(), 0);
  return input;
}

template <class Surface>
Patch as_patch(const Surface& surface) {
  Patch patch;
  for (const builder::WedgeTriangle& t : surface.triangles) {
    test::Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3i& p = surface.positions[surface.wedge_position[t[k]]];
      corners[k] = {p.x, p.y, p.z};
    }
    patch.push_back(corners);
  }
  return patch;
}

bool judge_accepts(const builder::SimplifyInput& finer, const builder::SimplifyResult& coarser) {
  const run::Asset asset = test::asset_of({as_patch(finer)}, as_patch(coarser));
  const auto clusters = run::decode_all(asset);
  EXPECT_TRUE(clusters.ok());
  return prove_borders(asset, build_surface(asset, MeshId(0U), *clusters)).violations.empty();
}

/// What a faulty builder might have made of it.
void spoil(builder::SimplifyResult& result, Random& random) {
  const std::size_t t = random.below(result.triangles.size());
  switch (random.below(4)) {
    case 0: result.triangles.erase(result.triangles.begin() + static_cast<std::ptrdiff_t>(t)); break;
    case 1: std::swap(result.triangles[t][0], result.triangles[t][1]); break;
    case 2: result.triangles[t][0] = result.triangles[random.below(result.triangles.size())][1]; break;
    default: {
      // A corner of its own, a little off: a crack.
      result.positions.push_back(result.positions[result.wedge_position[result.triangles[t][2]]] + Vec3i(1, 0, 0));
      result.wedge_position.push_back(static_cast<std::uint32_t>(result.positions.size() - 1));
      result.triangles[t][2] = static_cast<std::uint32_t>(result.wedge_position.size() - 1);
    }
  }
}

TEST(BorderAgreement, BuilderAndJudgeAcceptTheSame) {
  int accepted = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    Random random(seed);
    const builder::SimplifyInput input =
        as_input(test::make_open_surface(test::random_surface_options(random, 7), random));
    builder::SimplifyOptions options;
    options.target_triangles = static_cast<std::uint32_t>(input.triangles.size() / (1 + random.below(6)));
    builder::SimplifyResult result = builder::simplify_group(input, options);
    if (result.triangles.size() < 2) continue;
    ASSERT_TRUE(builder::keeps_border(input, result)) << "seed " << seed;
    ASSERT_TRUE(judge_accepts(input, result)) << "seed " << seed;
    spoil(result, random);
    const bool is_accepted = builder::keeps_border(input, result);
    ASSERT_EQ(judge_accepts(input, result), is_accepted) << "seed " << seed << ", spoiled";
    ++(is_accepted ? accepted : refused);
  }
  EXPECT_GT(accepted, 20) << "beside a border that was simplified, another shape of it is a border too";
  EXPECT_GT(refused, 120);
}

}  // namespace
}  // namespace meshlode::judge
