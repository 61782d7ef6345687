// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/judged_sample.h"

#include <cstdio>
#include <cstdlib>

#include "builder/hierarchy/hierarchy.h"
#include "builder/write/write.h"
#include "support/sample_asset.h"

namespace meshlode::test {

namespace {

template <class T>
T value_or_abort(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "judged sample: %s\n", result.error().message().c_str());
    std::abort();
  }
  return std::move(*result);
}

}  // namespace

std::vector<std::uint8_t> judged_sample_bytes(format::Codec codec, bool has_promises) {
  const scene::Scene scene = sample_scene();
  builder::WriteInput input;
  for (const SampleMesh& sample : {sample_patch(), sample_sphere(), sample_tetrahedron()}) {
    const builder::Hierarchy hierarchy = builder::build_hierarchy(sample.dag, sample.mesh);
    input.meshes.push_back(value_or_abort(builder::encode_mesh(sample.mesh, sample.dag, hierarchy, {})));
    input.mesh_names.push_back(sample.mesh.name);
  }
  builder::PreparedMesh empty;  // one triangle that is a point: nothing is left of it
  empty.name = "empty";
  empty.source_triangles = 1;
  empty.source_vertices = 3;
  empty.dropped_degenerate = 1;
  input.meshes.push_back(value_or_abort(builder::encode_mesh(empty, {}, {}, {})));
  input.mesh_names.emplace_back("empty");
  input.scene = &scene;
  input.meta_json =
      R"({"generator":"a test","source":{"file":"sample.glb","hash":")" + scene.source_hash +
      R"("},"settings":{"error_tier":"qem","cluster_triangles":256,"normal_error":0.1,"uv_error":0.0001,"uv_error_unit":"uv"},"plan":[],"left_out":[]})";
  if (has_promises) add_promises(input);
  return write_by(std::move(input), codec);
}

}  // namespace meshlode::test
