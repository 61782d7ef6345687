// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a cut, material by material, as primitives of a glTF mesh.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "app/export/cut_geometry.h"
#include "app/export/glb_file.h"
#include "app/export/gltf_document.h"
#include "base/vec.h"
#include "run/read/asset.h"

namespace meshlode::app {

class PrimitiveWriter {
 public:
  /// All of them outlive this. Views and accessors go to the document, what they show to `binary`.
  PrimitiveWriter(const run::Asset& asset, GltfJson& document, GlbBinary& binary)
      : asset_(asset), document_(document), binary_(binary) {}

  /// Positions relative to the mesh's frame are moved by `baked` (choose_origin()). Errors: kUnsupported where one does
  /// not fit a float, kInvalid where the document lacks the material.
  [[nodiscard]] Result<GltfJson> write(const format::MeshRecord& record, const CutPrimitive& primitive,
                                       const Vec3d& baked);

 private:
  Status add_positions(const format::MeshRecord& record, const run::DecodedCluster& vertices, const Vec3d& baked,
                       GltfJson& attributes);
  void add_texcoords(const format::MeshRecord& record, const run::ClusterAttributes& floats, MaterialId material,
                     std::size_t count, GltfJson& attributes);
  void add_colors(const run::DecodedCluster& vertices, GltfJson& attributes);
  std::size_t add_vertices(int component, const char* type, std::size_t count, GlbBinary::Range range, GltfJson extra);
  std::size_t add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertex_count);
  [[nodiscard]] int texcoords_needed(MaterialId material);

  const run::Asset& asset_;
  GltfJson& document_;
  GlbBinary& binary_;
  std::map<std::uint32_t, int> texcoords_;  ///< that materials ask for: each is walked once
};

}  // namespace meshlode::app
