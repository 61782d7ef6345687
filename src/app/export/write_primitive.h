// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a cut, material by material, as primitives of a glTF mesh.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "app/export/cut_geometry.h"
#include "app/export/glb_file.h"
#include "app/export/gltf_document.h"
#include "app/export/packing.h"
#include "base/vec.h"
#include "run/read/asset.h"

namespace meshlode::app {

class PrimitiveWriter {
 public:
  /// All of them outlive this. Views and accessors go to the document, what they show to `binary`.
  PrimitiveWriter(const run::Asset& asset, GltfJson& document, GlbBinary& binary, Packing packing)
      : asset_(asset), document_(document), binary_(binary), packing_(packing) {}

  /// Positions relative to the mesh's frame are moved by `baked` (choose_origin()) and, where the step of a
  /// QuantizedFrame is given, counted in it. Errors: kUnsupported where one does not fit a float, kInvalid where the
  /// document lacks the material.
  [[nodiscard]] Result<GltfJson> write(const format::MeshRecord& record, CutPrimitive& primitive, const Vec3d& baked,
                                       double step);

  /// Bytes of what was compressed, once it is not: the length of buffer 1, which holds none of them.
  [[nodiscard]] std::size_t fallback_bytes() const { return fallback_bytes_; }

 private:
  Status add_positions(const format::MeshRecord& record, const run::DecodedCluster& vertices, const Vec3d& baked,
                       double step, GltfJson& attributes);
  void add_texcoords(const format::MeshRecord& record, const run::ClusterAttributes& floats, MaterialId material,
                     std::size_t count, GltfJson& attributes);
  void add_colors(const run::DecodedCluster& vertices, GltfJson& attributes);
  std::size_t add_vertices(const VertexStream& stream, const char* type, GltfJson extra = GltfJson::object());
  std::size_t add_compressed_view(std::span<const std::uint8_t> compressed, std::size_t count, std::size_t stride,
                                  const char* filter, ViewTarget target);
  std::size_t add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertex_count);
  [[nodiscard]] int texcoords_needed(MaterialId material);

  const run::Asset& asset_;
  GltfJson& document_;
  GlbBinary& binary_;
  Packing packing_;
  std::size_t fallback_bytes_ = 0;
  std::map<std::uint32_t, int> texcoords_;  ///< that materials ask for: each is walked once
};

}  // namespace meshlode::app
