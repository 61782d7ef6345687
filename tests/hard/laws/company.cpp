// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes are built one by one and share nothing but the file: a neighbour changes none of a mesh's content.
#include <utility>

#include "lab/samples/samples.h"
#include "laws/outcomes.h"
#include "laws/same_mesh.h"

namespace meshlode::test::hard {

LawResult check_company(const Built& base) {
  if (base.sample.scene.meshes.size() != 1) return not_asked("not one mesh");
  scene::SourceMesh neighbour = lab::as_mesh(lab::make_rock(10), "neighbour");
  for (const bool is_first : {false, true}) {
    Sample sample = base.sample;
    auto& meshes = sample.scene.meshes;
    meshes.insert(is_first ? meshes.begin() : meshes.end(), neighbour);
    const MeshId own(is_first ? 1U : 0U);
    for (scene::SceneInstance& instance : sample.scene.instances) instance.mesh = own;
    const Result<Built> other = build_sample(std::move(sample));
    if (!other) return broken("refused: " + other.error().message());
    const Comparison compared = compare_meshes(*base.asset, MeshId(0U), *other->asset, own);
    if (!compared.difference.empty()) return broken(compared.difference);
  }
  return kept();
}

}  // namespace meshlode::test::hard
