// SPDX-License-Identifier: GPL-3.0-or-later
// What the device's floats decide: the rounding mode that every shader declares, and far instances at the threshold.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include <gtest/gtest.h>

#include "draw/gpu/shaders.h"
#include "draw/gpu/vulkan/float_controls.h"
#include "gpu_support.h"
#include "judge/gpu/compare_frame.h"
#include "run/select/far_instance.h"
#include "run/select/random_dag.h"

namespace meshlode::draw::test {
namespace {

using Floats = GpuTest;
using meshlode::test::RandomSource;
using Words = std::vector<std::uint32_t>;

/// Instructions of one opcode: their operands.
std::vector<Words> find_instructions(const Words& module, std::uint32_t opcode) {
  std::vector<Words> out;
  for (std::size_t i = 5; i < module.size(); i += module[i] >> 16u) {
    if (module[i] >> 16u == 0) break;
    if ((module[i] & 0xFFFFu) != opcode) continue;
    out.emplace_back(module.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     module.begin() + static_cast<std::ptrdiff_t>(i + (module[i] >> 16u)));
  }
  return out;
}

TEST(FloatControls, EveryShaderDeclaresRoundingToNearestOnceForBothWidths) {
  EXPECT_GT(all_shaders().size(), 20U);
  for (const auto& [name, shader] : all_shaders()) {
    SCOPED_TRACE(name);
    const Words before(shader.begin(), shader.end()), module = declare_round_to_nearest_even(shader);
    ASSERT_EQ(module.size(), before.size() + 2 + 8);
    const auto entries = find_instructions(module, 15);
    ASSERT_EQ(entries.size(), 1U);
    std::vector<Words> modes, capabilities;
    for (const Words& mode : find_instructions(module, 16)) {
      if (mode[1] == 4462) modes.push_back(mode);
    }
    for (const Words& capability : find_instructions(module, 17)) {
      if (capability[0] == 4467) capabilities.push_back(capability);
    }
    EXPECT_EQ(modes, (std::vector<Words>{{entries[0][1], 4462, 32}, {entries[0][1], 4462, 64}}));
    EXPECT_EQ(capabilities.size(), 1U);
  }
}

TEST(FloatControls, LeavesAloneWhatIsNoModule) {
  EXPECT_TRUE(declare_round_to_nearest_even({}).empty());
  const auto shader = find_shader("sort.comp");
  Words old(shader.begin(), shader.end());
  old[1] = 0x00010300;  // before 1.4 it is an extension
  EXPECT_EQ(declare_round_to_nearest_even(old), old);
  for (std::size_t length = 0; length < 64; ++length) {
    const Words cut(shader.begin(), shader.begin() + static_cast<std::ptrdiff_t>(length));
    const Words out = declare_round_to_nearest_even(cut);  // and reads nothing behind the end
    EXPECT_TRUE(out == cut || out.size() == cut.size() + 10) << length;
  }
}

/// Instances of one mesh, each at the distance where the far bound is within a few ulp of passing, turned so that a
/// group with the largest error lies towards the eye.
std::vector<format::InstanceRecord> threshold_instances(const run::SelectTables& tables, const run::Camera& camera,
                                                        double pixel_error, std::uint32_t count, bool is_grown) {
  const format::MeshRecord& mesh = tables.meshes[0];
  std::vector<float> errors;
  const format::GroupRecord* coarse = nullptr;
  for (const format::GroupRecord& group : tables.groups) {
    errors.push_back(group.error);
    if (group.mesh == 0 && group.error < format::kInfiniteError && (coarse == nullptr || group.error > coarse->error)) {
      coarse = &group;
    }
  }
  const run::FarBound far = run::find_far_bound(tables, mesh, errors);
  if (far.only_root == format::kNone || coarse == nullptr) return {};
  const double k = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
  RandomSource random(31);
  std::vector<format::InstanceRecord> out;
  for (std::uint32_t i = 0; i < count; ++i) {
    // The axis from the root's centre to the group's, and two across it, go to three of the world; the first to the
    // eye.
    const Vec3d root(far.bound.center[0], far.bound.center[1], far.bound.center[2]);
    const Vec3d group(coarse->center[0], coarse->center[1], coarse->center[2]);
    const auto frame_of = [&](const Vec3d& first) {
      const Vec3d second = glm::normalize(glm::cross(first, random.direction()));
      return Mat3d(first, second, glm::cross(first, second));
    };
    const Mat3d from = frame_of(glm::length(group - root) > 0.0 ? glm::normalize(group - root) : random.direction());
    const Mat3d to = frame_of(glm::normalize(Vec3d(0.0, 0.0, 1.0) + random.in_cube(0.1)));
    const Mat3d turn = to * glm::transpose(from);
    const double error = static_cast<double>(is_grown ? far.bound.error : coarse->error);
    const double distance = (error * k / pixel_error + static_cast<double>(far.bound.radius)) * (1.0 + 0x1p-20) *
                            (1.0 + random.between(-3e-7, 3e-7));
    const Vec3d origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
    const Vec3d translation = camera.eye - to[0] * distance - turn * (root + origin);
    format::InstanceRecord instance{};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) instance.transform[4 * row + column] = turn[column][row];
      instance.transform[4 * row + 3] = translation[row];
    }
    instance.scale = meshlode::test::largest_singular_value(instance.transform);
    out.push_back(instance);
  }
  return out;
}

/// The instances in the place of those that the renderer's scene has: how many are drawn by another cut than the flat
/// rule's.
std::uint64_t count_other_cuts(Device& device, Renderer& renderer, const run::Asset& asset,
                               std::span<const format::InstanceRecord> instances, const run::Camera& camera,
                               double pixel_error) {
  std::vector<GpuInstance> table(instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i) {
    std::copy(instances[i].transform, instances[i].transform + 12, table[i].transform);
    table[i].scale = instances[i].scale;
    table[i].mesh = instances[i].mesh;
    table[i].flags = instances[i].flags;
  }
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(table.data()),
                                            table.size() * sizeof(GpuInstance));
  EXPECT_TRUE(device.upload(renderer.scene().instances, bytes));
  const auto frame = renderer.draw(camera, pixel_error, 0.0);
  EXPECT_TRUE(frame && frame->overflow == 0);
  const auto drawn = renderer.read_cut();
  EXPECT_TRUE(drawn);
  if (!drawn) return 0;
  run::SelectTables tables = run::tables_of(asset);
  tables.instances = instances;
  const std::vector<run::ClusterInstance> wanted = run::select_flat(tables, camera, pixel_error);
  std::vector<run::ClusterInstance> other;
  std::set_symmetric_difference(drawn->begin(), drawn->end(), wanted.begin(), wanted.end(), std::back_inserter(other));
  std::vector<bool> differs(instances.size(), false);
  for (const run::ClusterInstance& c : other) differs[c.instance.value] = true;
  return static_cast<std::uint64_t>(std::count(differs.begin(), differs.end(), true));
}

/// Instances where the shortcut's answer hangs on the last bits: the device's cut is the flat rule's. With the largest
/// error as it is stored for a bound the same instances tell.
TEST_F(Floats, InstancesAtTheThresholdAreDrawnByTheFlatRule) {
  constexpr std::uint32_t kCount = 1500;
  builder::PipelineOptions as_searched;  // of this asset a pixel error is known at which the largest error tells
  as_searched.keep_layers = false;
  const auto asset = run::Asset::from_vector(build_file(MESHLODE_DATA "/crystal.glb", as_searched));
  ASSERT_TRUE(asset);
  const run::SelectTables tables = run::tables_of(*asset);
  run::Camera camera;
  camera.eye = {0.0, 0.0, 0.0};
  camera.target = {0.0, 0.0, -1.0};
  camera.width = camera.height = 4;  // few pixels to draw: the cut is what is asked
  camera.near_distance = 1e-6;
  const auto scene = upload_scene(*device_, *asset, threshold_instances(tables, camera, 1.0, kCount, true));
  ASSERT_TRUE(scene);
  RendererOptions options{.width = camera.width, .height = camera.height, .frustum = false};
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer) << renderer.error().message();
  const double pixel_errors[] = {5e-4, 3e-3};
  for (const double pixel_error : pixel_errors) {
    for (const bool is_grown : {true, false}) {
      const auto instances = threshold_instances(tables, camera, pixel_error, kCount, is_grown);
      EXPECT_EQ(count_other_cuts(*device_, *renderer, *asset, instances, camera, pixel_error), 0U)
          << pixel_error << (is_grown ? " at the bound" : " at the largest error");
    }
  }
  std::vector<std::uint8_t> table(sizeof(GpuMesh));
  ASSERT_TRUE(device_->download(scene->meshes, table));
  GpuMesh mesh{};
  std::memcpy(&mesh, table.data(), sizeof mesh);
  mesh.coarse_error = 0.0F;
  for (const format::GroupRecord& group : asset->groups()) {
    if (group.error < format::kInfiniteError) mesh.coarse_error = std::max(mesh.coarse_error, group.error);
  }
  ASSERT_TRUE(device_->upload(scene->meshes, bytes_of(mesh)));
  std::uint64_t ungrown = 0;
  for (const double pixel_error : pixel_errors) {
    const auto instances = threshold_instances(tables, camera, pixel_error, kCount, false);
    ungrown += count_other_cuts(*device_, *renderer, *asset, instances, camera, pixel_error);
  }
  EXPECT_GT(ungrown, 0U) << "the search finds what the growth prevents";
}

}  // namespace
}  // namespace meshlode::draw::test
