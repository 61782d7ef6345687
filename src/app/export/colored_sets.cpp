// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/colored_sets.h"

#include <algorithm>
#include <tuple>

#include "app/export/cut_geometry.h"
#include "app/export/float_positions.h"
#include "app/export/glb_file.h"
#include "app/export/packing.h"
#include "base/json_writer.h"
#include "base/try.h"

namespace meshlode::app {
namespace {

/// Two buffer views and two accessors: positions, then indices.
struct WrittenPrimitive {
  GlbBinary::Range positions, indices;
  std::size_t position_count = 0, index_count = 0, material = 0;
  Vec3f low{0.0F}, high{0.0F};
};

struct WrittenMesh {
  MeshId mesh;
  Vec3d translation{0.0};  ///< what float positions could not hold
  std::vector<WrittenPrimitive> primitives;
};

using Material = std::tuple<std::string, std::array<float, 3>>;

struct Document {
  GlbBinary binary;
  std::vector<Material> materials;
  std::vector<WrittenMesh> meshes;
};

std::size_t material_of(const ColoredSet& set, Document& document) {
  const Material material(set.name, set.color);
  const auto found = std::find(document.materials.begin(), document.materials.end(), material);
  if (found != document.materials.end()) return static_cast<std::size_t>(found - document.materials.begin());
  document.materials.push_back(material);
  return document.materials.size() - 1;
}

Result<WrittenPrimitive> write_primitive(const run::Asset& asset, const format::MeshRecord& record,
                                         const CutPrimitive& primitive, const Vec3d& baked, GlbBinary& binary) {
  const auto positions = bake_positions(record, primitive.vertices, baked);
  if (!positions) {
    return Error{ErrorCode::kUnsupported, std::string(asset.string(record.name)),
                 "a position does not fit glTF's 32-bit floats"};
  }
  WrittenPrimitive out;
  out.low = out.high = positions->front();
  for (const Vec3f& p : *positions) {
    out.low = glm::min(out.low, p);
    out.high = glm::max(out.high, p);
  }
  out.positions = binary.append_values(std::span<const Vec3f>(*positions));
  out.position_count = positions->size();
  out.indices = binary.append_values(std::span<const std::uint32_t>(primitive.indices));
  out.index_count = primitive.indices.size();
  return out;
}

Status add_mesh(const run::Asset& asset, MeshId mesh, std::span<const ColoredSet> sets, Document& document) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<std::vector<CutPrimitive>> parts;
  std::vector<std::size_t> materials;
  for (const ColoredSet& set : sets) {
    if (set.mesh != mesh || set.clusters.empty()) continue;
    TRY_LET(primitives, gather_cut(asset, mesh, set.clusters));
    parts.push_back(std::move(*primitives));
    materials.push_back(material_of(set, document));
  }
  if (parts.empty()) return Ok{};
  const Vec3d baked = choose_origin(record, parts);
  WrittenMesh written{mesh, Vec3d(record.origin[0], record.origin[1], record.origin[2]) - baked, {}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const CutPrimitive& primitive : parts[i]) {
      TRY_LET(one, write_primitive(asset, record, primitive, baked, document.binary));
      one->material = materials[i];
      written.primitives.push_back(*one);
    }
  }
  document.meshes.push_back(std::move(written));
  return Ok{};
}

void write_materials(JsonWriter& w, const Document& document) {
  w.key("materials");
  w.begin_array();
  for (const auto& [name, color] : document.materials) {
    w.begin_object();
    w.field("name", name);
    w.field("doubleSided", true);
    w.key("pbrMetallicRoughness");
    w.begin_object();
    w.array_field("baseColorFactor", std::array{color[0], color[1], color[2], 1.0F});
    w.field("metallicFactor", 0);
    w.field("roughnessFactor", 1);
    w.end_object();
    w.end_object();
  }
  w.end_array();
}

void write_views_and_accessors(JsonWriter& w, const Document& document) {
  const auto for_each = [&](const auto& action) {
    w.begin_array();
    for (const WrittenMesh& mesh : document.meshes) {
      for (const WrittenPrimitive& p : mesh.primitives) action(p);
    }
    w.end_array();
  };
  const auto view = [&](const GlbBinary::Range& range, ViewTarget target) {
    w.begin_object();
    w.field("buffer", 0);
    w.field("byteOffset", range.offset);
    w.field("byteLength", range.bytes);
    w.field("target", static_cast<int>(target));
    w.end_object();
  };
  w.key("bufferViews");
  for_each([&](const WrittenPrimitive& p) {
    view(p.positions, ViewTarget::kVertices);
    view(p.indices, ViewTarget::kIndices);
  });
  std::size_t next = 0;
  w.key("accessors");
  for_each([&](const WrittenPrimitive& p) {
    w.begin_object();
    w.field("bufferView", next++);
    w.field("componentType", kFloat);
    w.field("count", p.position_count);
    w.field("type", "VEC3");
    w.array_field("min", std::array{p.low.x, p.low.y, p.low.z});
    w.array_field("max", std::array{p.high.x, p.high.y, p.high.z});
    w.end_object();
    w.begin_object();
    w.field("bufferView", next++);
    w.field("componentType", kUnsignedInt);
    w.field("count", p.index_count);
    w.field("type", "SCALAR");
    w.end_object();
  });
}

void write_meshes(JsonWriter& w, const run::Asset& asset, const Document& document) {
  std::size_t accessor = 0;
  w.key("meshes");
  w.begin_array();
  for (const WrittenMesh& mesh : document.meshes) {
    w.begin_object();
    w.field("name", asset.string(asset.meshes()[mesh.mesh.value].name));
    w.key("primitives");
    w.begin_array();
    for (const WrittenPrimitive& p : mesh.primitives) {
      w.begin_object();
      w.key("attributes");
      w.begin_object();
      w.field("POSITION", accessor++);
      w.end_object();
      w.field("indices", accessor++);
      w.field("material", p.material);
      w.end_object();
    }
    w.end_array();
    w.end_object();
  }
  w.end_array();
}

/// A node per drawn instance, and a child that moves the mesh to its far-away origin where it has one.
void write_nodes(JsonWriter& w, const run::Asset& asset, const Document& document) {
  std::vector<std::size_t> roots;
  std::size_t next = 0;
  w.key("nodes");
  w.begin_array();
  for (std::size_t m = 0; m < document.meshes.size(); ++m) {
    const WrittenMesh& mesh = document.meshes[m];
    const bool is_moved = mesh.translation != Vec3d(0.0);
    for (const format::InstanceRecord& instance : asset.instances()) {
      if (instance.mesh != mesh.mesh.value || (instance.flags & format::kInstanceSingular) != 0) continue;
      std::array<double, 16> matrix{};
      for (std::size_t column = 0; column < 4; ++column) {
        for (std::size_t row = 0; row < 3; ++row) matrix[column * 4 + row] = instance.transform[row * 4 + column];
      }
      matrix[15] = 1.0;
      roots.push_back(next++);
      w.begin_object();
      w.field("name", asset.string(instance.name));
      w.array_field("matrix", matrix);
      if (is_moved) {
        w.array_field("children", std::array{next++});
        w.end_object();
        w.begin_object();
        w.array_field("translation", std::array{mesh.translation.x, mesh.translation.y, mesh.translation.z});
      }
      w.field("mesh", m);
      w.end_object();
    }
  }
  w.end_array();
  w.key("scenes");
  w.begin_array();
  w.begin_object();
  if (!roots.empty()) w.array_field("nodes", roots);
  w.end_object();
  w.end_array();
  w.field("scene", 0);
}

}  // namespace

Result<std::vector<std::uint8_t>> export_colored_sets(const run::Asset& asset, std::span<const ColoredSet> sets) {
  Document document;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    TRY(add_mesh(asset, MeshId(m), sets, document));
  }
  // A mesh without an instance that can be drawn has no node, and a list without elements is not glTF.
  std::erase_if(document.meshes, [&](const WrittenMesh& mesh) {
    return std::none_of(asset.instances().begin(), asset.instances().end(), [&](const format::InstanceRecord& i) {
      return i.mesh == mesh.mesh.value && (i.flags & format::kInstanceSingular) == 0;
    });
  });
  JsonWriter w;
  w.begin_object();
  w.key("asset");
  w.begin_object();
  w.field("version", "2.0");
  w.field("generator", "meshlode");
  w.end_object();
  if (!document.meshes.empty()) {
    write_materials(w, document);
    write_views_and_accessors(w, document);
    write_meshes(w, asset, document);
    write_nodes(w, asset, document);
  }
  if (!document.binary.bytes().empty()) {
    w.key("buffers");
    w.begin_array();
    w.begin_object();
    w.field("byteLength", document.binary.bytes().size());
    w.end_object();
    w.end_array();
  }
  w.end_object();
  return assemble_glb(w.text(), document.binary.bytes());
}

}  // namespace meshlode::app
