// SPDX-License-Identifier: GPL-3.0-or-later
// An asset measured by another tier is the asset that a build with that tier writes, to the byte.
#include "app/measure/measure_asset.h"

#include <array>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "builder/builder.h"
#include "lab/samples/samples.h"

namespace meshlode::app {
namespace {

using builder::PipelineOptions;
using format::ErrorTier;
using Bytes = std::vector<std::uint8_t>;

constexpr std::array kTiers{ErrorTier::kQem, ErrorTier::kMeasured, ErrorTier::kCertified};

Bytes built(const scene::Scene& scene, const PipelineOptions& options) {
  builder::PipelineReport report;
  Result<Bytes> bytes = builder::build_lode(scene, options, {}, report);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message();
  return bytes ? std::move(*bytes) : Bytes();
}

Result<Bytes> measured(const Bytes& bytes, const scene::Scene& scene, ErrorTier tier) {
  const Result<run::Asset> asset = run::Asset::from_vector(bytes);
  if (!asset) return asset.error();
  return measure_asset(*asset, scene, tier);
}

ErrorCode refusal(const Bytes& bytes, const scene::Scene& scene, ErrorTier tier = ErrorTier::kMeasured) {
  const Result<Bytes> out = measured(bytes, scene, tier);
  return out ? ErrorCode{} : out.error().code;
}

/// From each tier to each. `set_tier` gives one to the options.
void expect_as_built(const scene::Scene& scene, PipelineOptions options,
                     const std::function<void(PipelineOptions&, ErrorTier)>& set_tier) {
  std::vector<Bytes> of_tier;
  for (const ErrorTier tier : kTiers) {
    set_tier(options, tier);
    of_tier.push_back(built(scene, options));
  }
  for (const Bytes& from : of_tier) {
    for (std::size_t to = 0; to < kTiers.size(); ++to) {
      const Result<Bytes> out = measured(from, scene, kTiers[to]);
      ASSERT_TRUE(out.ok()) << out.error().message();
      EXPECT_TRUE(*out == of_tier[to]) << to;
    }
  }
}

void set_whole(PipelineOptions& options, ErrorTier tier) {
  options.error_tier = tier;
}

scene::Scene scene_of(const scene::Primitive& shape) {
  return lab::as_scene(lab::as_mesh(shape));
}

TEST(MeasureAsset, IsWhatABuildWithTheTierWrites) {
  expect_as_built(scene_of(lab::make_rock(24)), {}, set_whole);
  PipelineOptions odd;
  odd.codec = format::Codec::kStrips;
  odd.attributes = AttributeChoice::kAll;
  odd.grid_step = 0.01;  // where needles stay
  expect_as_built(scene_of(lab::make_loose_pieces(200)), odd, set_whole);
}

TEST(MeasureAsset, SettingsOfMeshesThatDifferByTheirTierAloneAreGone) {
  scene::Scene scene = scene_of(lab::make_rock(9));
  for (int i = 0; i < 3; ++i) scene.meshes.push_back(scene.meshes.front());
  PipelineOptions options;
  options.mesh_options.assign(4, options);
  options.mesh_options[1].normal_error = options.mesh_options[3].normal_error = 1.0;
  const auto set_all = [](PipelineOptions& all, ErrorTier tier) {
    all.error_tier = tier;
    for (builder::MeshOptions& own : all.mesh_options) own.error_tier = tier;
  };
  expect_as_built(scene, options, set_all);
  PipelineOptions mixed = options;
  mixed.mesh_options[2].error_tier = mixed.mesh_options[3].error_tier = ErrorTier::kQem;
  set_all(options, ErrorTier::kCertified);
  const Result<Bytes> out = measured(built(scene, mixed), scene, ErrorTier::kCertified);
  ASSERT_TRUE(out.ok());
  EXPECT_TRUE(*out == built(scene, options));
}

TEST(MeasureAsset, SameForAnyThreadCount) {
  const scene::Scene scene = scene_of(lab::make_rock(16));
  const Bytes from = built(scene, {});
  const Result<Bytes> all = measured(from, scene, ErrorTier::kCertified);
  Result<Bytes> one = Error{};
  tbb::task_arena(1).execute([&] { one = measured(from, scene, ErrorTier::kCertified); });
  ASSERT_TRUE(all.ok() && one.ok());
  EXPECT_TRUE(*all == *one);
}

TEST(MeasureAsset, RefusesAnotherSource) {
  const scene::Scene scene = scene_of(lab::make_rock(9));
  const Bytes asset = built(scene, {});
  for (const ErrorTier tier : kTiers) {
    scene::Scene other = scene;
    other.meshes.front().primitives.front().positions.front() *= 1.01;
    EXPECT_EQ(refusal(asset, other, tier), ErrorCode::kCheckFailed);
    other = scene;
    other.meshes.front().primitives.front().indices.resize(3);
    EXPECT_EQ(refusal(asset, other, tier), ErrorCode::kCheckFailed);
    other = scene;
    for (Vec3d& p : other.meshes.front().primitives.front().positions) p *= 1e30;
    EXPECT_EQ(refusal(asset, other, tier), ErrorCode::kCheckFailed);
    other.meshes.clear();
    EXPECT_EQ(refusal(asset, other, tier), ErrorCode::kCheckFailed);
    EXPECT_EQ(refusal(asset, scene_of(lab::make_plane(4)), tier), ErrorCode::kCheckFailed);
  }
  EXPECT_EQ(refusal(asset, scene), ErrorCode{});
}

TEST(MeasureAsset, RefusesPromises) {
  const scene::Scene scene = scene_of(lab::make_rock(9));
  PipelineOptions options;
  options.promise = format::Promise::kTexels;
  EXPECT_EQ(refusal(built(scene, options), scene), ErrorCode::kUnsupported);
}

/// A byte of each part of the file: refused when it is opened, or when its content is held against its hash.
TEST(MeasureAsset, RefusesADamagedAsset) {
  const scene::Scene scene = scene_of(lab::make_rock(9));
  const Bytes asset = built(scene, {});
  std::size_t refused = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    Bytes changed = asset;
    changed[i * (asset.size() - 1) / 63] ^= 0x10;
    const Result<Bytes> out = measured(changed, scene, ErrorTier::kQem);
    if (out) {
      EXPECT_EQ(out->size(), asset.size());  // between sections
    } else {
      ++refused;
    }
  }
  EXPECT_GE(refused, 60U);
}

}  // namespace
}  // namespace meshlode::app
