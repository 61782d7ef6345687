// SPDX-License-Identifier: GPL-3.0-or-later
// What `verify` does with a hostile asset, against the sample scene, which eight bytes before the asset may change: the
// asset need not have been built from it.
#include <vector>

#include "asset_mutator.h"
#include "harness.h"
#include "judge/verify/verify.h"
#include "support/sample_asset.h"

namespace {

using namespace meshlode;

constexpr std::size_t kPrefix = 8;

/// The sample scene, or one that differs from it in what the bytes say.
scene::Scene source_of(const std::uint8_t* bytes) {
  static const scene::Scene sample = test::sample_scene();
  scene::Scene scene = sample;
  scene::SourceMesh& mesh = scene.meshes[bytes[1] % scene.meshes.size()];
  if (bytes[0] == 0 || mesh.primitives.empty()) return scene;
  scene::Primitive& primitive = mesh.primitives[0];
  if ((bytes[0] & 1U) != 0 && !primitive.positions.empty()) {
    Vec3d& moved = primitive.positions[bytes[2] % primitive.positions.size()];
    constexpr double kValues[] = {0.0, 1e-30, -7.5, 3e9, 1e38, -1e300};
    moved[bytes[3] % 3] = kValues[bytes[4] % std::size(kValues)];
  }
  if ((bytes[0] & 2U) != 0 && primitive.indices.size() >= 3) primitive.indices.resize(primitive.indices.size() - 3);
  if ((bytes[0] & 4U) != 0 && primitive.indices.size() >= 3) {
    const std::size_t first = bytes[5] % (primitive.indices.size() / 3) * 3;
    primitive.indices.insert(primitive.indices.end(), 3, primitive.indices[first]);
  }
  if ((bytes[0] & 8U) != 0) scene.instances.resize(bytes[6] % 8, scene.instances[0]);
  if ((bytes[0] & 16U) != 0) scene.materials.resize(1 + bytes[6] % 4, scene.materials[0]);
  if ((bytes[0] & 64U) != 0) mesh.primitives.push_back(scene::Primitive(mesh.primitives[0]));
  if ((bytes[0] & 32U) != 0) scene.meshes.resize(bytes[7] % 6);  // `mesh` and `primitive` are gone from here on
  if (scene.meshes.empty()) scene.instances.clear();
  for (scene::SourceMesh& m : scene.meshes) {
    for (scene::Primitive& p : m.primitives) {
      if (p.material.value >= scene.materials.size()) p.material = MaterialId(0U);
    }
  }
  for (scene::SceneInstance& instance : scene.instances) {
    if (instance.mesh.value >= scene.meshes.size()) instance.mesh = MeshId(0U);
  }
  return scene;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size <= kPrefix) return 0;
  const std::vector<std::uint8_t> bytes(data + kPrefix, data + size);
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset || asset->instances().size() > 100) return 0;
  judge::VerifyOptions options;
  options.uniform_cuts = 8;
  options.cameras = 4;
  options.deviation_cuts = 2;
  options.deviation_samples = 200;
  const judge::VerifyReport report = judge::verify_asset(*asset, source_of(data), options);
  std::uint64_t failures = 0;
  for (const judge::VerifyReport::Check& check : report.checks) failures += check.failures;
  fuzz::require(!report.checks.empty(), "nothing was checked");
  fuzz::require((failures == 0) == (report.finding_count == 0), "failed checks and findings disagree");
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, kPrefix);
}
#endif
