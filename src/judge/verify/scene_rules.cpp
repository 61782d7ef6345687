// SPDX-License-Identifier: GPL-3.0-or-later
// What surrounds the geometry: materials, instances, images and the source's name for itself (V106 … V113).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "format/grid.h"
#include "format/names.h"
#include "judge/validate/file_tables.h"
#include "judge/verify/converted_images.h"
#include "judge/verify/source_rules.h"
#include "judge/verify/texel_budget.h"

namespace meshlode::judge {

namespace {

bool is_same_material(const run::Asset& asset, const format::MaterialRecord& stored,
                      const scene::SceneMaterial& source) {
  bool same = asset.string(stored.name) == source.name && stored.source_index == source.source_index &&
              static_cast<std::uint32_t>(stored.alpha_mode) == static_cast<std::uint32_t>(source.alpha_mode) &&
              stored.alpha_cutoff == source.alpha_cutoff && (stored.double_sided != 0) == source.double_sided &&
              stored.base_color_texture == source.base_color_texture &&
              stored.base_color_uv_set == source.base_color_uv_set;
  for (int i = 0; i < 4; ++i) same = same && stored.base_color[i] == source.base_color[i];
  return same;
}

bool is_same_transform(const format::InstanceRecord& stored, const Mat4d& source) {
  bool is_finite = true;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) is_finite = is_finite && std::isfinite(source[column][row]);
  }
  bool same = true;
  bool zero = true;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double value = stored.transform[4 * row + column];
      same = same && value == source[column][row];
      zero = zero && value == 0.0;
    }
  }
  // What cannot be drawn is stored as zeros and marked.
  const bool marked = (stored.flags & format::kInstanceSingular) != 0;
  return same || (zero && marked) || (!is_finite && marked);
}

bool has_any_aggregate(const run::Asset& asset) {
  return std::any_of(asset.groups().begin(), asset.groups().end(),
                     [](const format::GroupRecord& group) { return (group.flags & format::kGroupAggregate) != 0; });
}

/// The source's, byte for byte; with materials behind its own where aggregates have some that stand for their pieces.
bool is_same_document(const run::Asset& asset, const scene::Scene& source) {
  if (asset.scene_json() == source.document) return true;
  if (!has_any_aggregate(asset)) return false;
  using Json = nlohmann::json;
  const Json theirs = Json::parse(source.document, nullptr, false);
  Json ours = Json::parse(asset.scene_json(), nullptr, false);
  if (!theirs.is_object() || !ours.is_object() || !ours.contains("materials")) return false;
  Json& materials = ours["materials"];
  const std::size_t count = theirs.contains("materials") ? theirs["materials"].size() : 0;
  if (!materials.is_array() || materials.size() < count) return false;
  materials.erase(materials.begin() + static_cast<std::ptrdiff_t>(count), materials.end());
  if (!theirs.contains("materials")) ours.erase("materials");
  return ours == theirs;
}

void check_materials(const run::Asset& asset, const scene::Scene& source, RuleLog& log) {
  log.expect(
      asset.materials().size() == source.materials.size() ||
          (has_any_aggregate(asset) && asset.materials().size() > source.materials.size()),
      Rule::kV106, [] { return std::string("materials"); },
      [&] {
        return differs("stored", std::uint64_t{asset.materials().size()}, "source",
                       std::uint64_t{source.materials.size()});
      });
  for (std::size_t i = source.materials.size(); i < asset.materials().size(); ++i) {
    const format::MaterialRecord& material = asset.materials()[i];
    log.expect(
        material.alpha_mode == format::AlphaMode::kOpaque && material.double_sided != 0 &&
            material.base_color_texture == format::kNone,
        Rule::kV106, [&] { return place("material", i); },
        [] { return std::string("is not the source's, and none that stands for an aggregate"); });
  }
  const std::size_t count = std::min(asset.materials().size(), source.materials.size());
  for (std::size_t i = 0; i < count; ++i) {
    log.expect(
        is_same_material(asset, asset.materials()[i], source.materials[i]), Rule::kV106,
        [&] { return place("material", i); }, [] { return std::string("is not the source's"); });
  }
}

void check_instances(const run::Asset& asset, const scene::Scene& source, RuleLog& log) {
  log.expect(
      asset.instances().size() == source.instances.size(), Rule::kV107, [] { return std::string("instances"); },
      [&] {
        return differs("stored", std::uint64_t{asset.instances().size()}, "source",
                       std::uint64_t{source.instances.size()});
      });
  const std::size_t count = std::min(asset.instances().size(), source.instances.size());
  for (std::size_t i = 0; i < count; ++i) {
    const format::InstanceRecord& stored = asset.instances()[i];
    const scene::SceneInstance& instance = source.instances[i];
    const auto at = [&] { return place("instance", i); };
    log.expect(stored.mesh == instance.mesh.value && stored.node == instance.node &&
                   asset.string(stored.name) == instance.name,
               Rule::kV107, at, [] { return std::string("names another mesh, node or name"); });
    log.expect(is_same_transform(stored, instance.transform), Rule::kV107, at,
               [] { return std::string("has another transform"); });
  }
}

void check_blobs(const run::Asset& asset, const scene::Scene& source, const StatedTextures& textures, RuleLog& log) {
  log.expect(
      asset.blobs().size() == source.blobs.size(), Rule::kV109, [] { return std::string("blobs"); },
      [&] {
        return differs("stored", std::uint64_t{asset.blobs().size()}, "source", std::uint64_t{source.blobs.size()});
      });
  const std::size_t count = std::min(asset.blobs().size(), source.blobs.size());
  for (std::size_t i = 0; i < count; ++i) {
    const format::BlobRecord& stored = asset.blobs()[i];
    const scene::SceneBlob& blob = source.blobs[i];
    const auto kind =
        blob.kind == scene::SceneBlob::Kind::kImage ? format::BlobKind::kImage : format::BlobKind::kBuffer;
    const auto bytes = asset.blob_bytes(stored);
    const std::string_view mime_type = asset.string(stored.mime_type);
    const bool is_named =
        stored.kind == kind && stored.source_index == blob.source_index && asset.string(stored.name) == blob.name;
    const bool same = is_named && mime_type == blob.mime_type &&
                      std::equal(bytes.begin(), bytes.end(), blob.bytes.begin(), blob.bytes.end());
    std::string fault = same ? "" : "is not the source's";
    if (!same && is_named && kind == format::BlobKind::kImage && textures.is_any()) {
      fault = find_image_fault(bytes, mime_type, blob, textures);
    }
    log.expect(
        fault.empty(), Rule::kV109, [&] { return place("blob", i); }, [&] { return fault; });
  }
  log.expect(
      is_same_document(asset, source), Rule::kV109, [] { return std::string("section SCNE"); },
      [] { return std::string("is not the source's scene document"); });
}

/// Whether a corner's normal is not its triangle's: beyond one degree shading would tell. Triangles without area say
/// nothing.
bool has_own_shading(const scene::SourceMesh& mesh) {
  constexpr double kCosine = 0.99984;
  for (const scene::Primitive& primitive : mesh.primitives) {
    if (primitive.normals.empty()) continue;
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      const Vec3d a = primitive.positions[primitive.indices[i]];
      const Vec3d n = glm::cross(primitive.positions[primitive.indices[i + 1]] - a,
                                 primitive.positions[primitive.indices[i + 2]] - a);
      const double n_length = std::sqrt(glm::dot(n, n));
      if (!(n_length > 0.0) || !std::isfinite(n_length)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d normal(primitive.normals[primitive.indices[i + k]]);
        const double length = std::sqrt(glm::dot(normal, normal));
        if (length > 0.0 && std::isfinite(length) && glm::dot(normal, n) < kCosine * length * n_length) return true;
      }
    }
  }
  return false;
}

bool has_color(const scene::Primitive& primitive) {
  return std::any_of(primitive.colors.begin(), primitive.colors.end(), [](const Vec4f& c) { return c != Vec4f(1.0F); });
}

void check_attributes(const run::Asset& asset, const MetaFacts& facts, const scene::Scene& source, RuleLog& log) {
  for (std::size_t m = 0; m < std::min(asset.meshes().size(), source.meshes.size()); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    const MetaFacts::OfMesh& own = facts.of_mesh(m);
    if (mesh.cluster_count == 0 || own.attributes == "none") continue;
    const auto is_dropped = [&](const std::string& name) {
      return std::find(own.dropped.begin(), own.dropped.end(), name) != own.dropped.end();
    };
    const auto at = [&] { return place("mesh", m); };
    log.expect(mesh.normal_mode != format::NormalMode::kNone || is_dropped("NORMAL"), Rule::kV110, at,
               [] { return std::string("normals are left out"); });
    log.expect(
        mesh.normal_mode == format::NormalMode::kStored || is_dropped("NORMAL") || !has_own_shading(source.meshes[m]),
        Rule::kV110, at, [] { return std::string("normals differ from the triangles' own and are not stored"); });
    for (const scene::Primitive& primitive : source.meshes[m].primitives) {
      log.expect(mesh.has_color != 0 || is_dropped("COLOR_0") || !has_color(primitive), Rule::kV110, at,
                 [] { return std::string("colours are not stored"); });
      if (primitive.material.value >= source.materials.size()) continue;
      for (std::uint32_t set = 0; set < scene::kMaxUvSets; ++set) {
        const bool is_used =
            (source.materials[primitive.material.value].uv_sets_used >> set & 1U) != 0 && !primitive.uvs[set].empty();
        const auto* end = mesh.uv_set_source + mesh.uv_set_count;
        log.expect(
            !is_used || is_dropped("TEXCOORD_" + std::to_string(set)) || std::find(mesh.uv_set_source, end, set) != end,
            Rule::kV110, at, [&] { return "TEXCOORD_" + std::to_string(set) + " is sampled and not stored"; });
      }
    }
  }
}

void check_caps(const run::Asset& asset, const MetaFacts& facts, RuleLog& log) {
  const std::uint64_t triangles = facts.cluster_triangles.value_or(format::kMaxClusterTriangles);
  const std::uint64_t vertices = facts.cluster_vertices.value_or(format::kMaxClusterVertices);
  for (std::size_t c = 0; c < asset.clusters().size(); ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[c];
    log.expect(
        cluster.triangle_count() <= triangles && cluster.vertex_count() <= vertices, Rule::kV111,
        [&] { return place("cluster", c); },
        [&] {
          return differs("triangles", std::uint64_t{cluster.triangle_count()}, "vertices",
                         std::uint64_t{cluster.vertex_count()}) +
                 "; the caps are " + std::to_string(triangles) + " and " + std::to_string(vertices);
        });
  }
}

void check_tiers(const run::Asset& asset, const MetaFacts& facts, RuleLog& log) {
  log.check(Rule::kV112);
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const std::string& setting = facts.of_mesh(m).error_tier;
    if (setting.empty() || asset.meshes()[m].cluster_count == 0) continue;
    const format::ErrorTier tier = asset.meshes()[m].error_tier;
    log.expect(
        value_in(format::kErrorTierNames, setting) == tier, Rule::kV112, [&] { return place("mesh", m); },
        [&] { return "tier " + std::to_string(static_cast<std::uint32_t>(tier)) + " is not \"" + setting + "\""; });
  }
}

struct Budgets {
  std::optional<double> position, normal, uv;  ///< uv in UV units
};

Budgets budgets_of(const MetaFacts::OfMesh& facts) {
  return {facts.position_error, facts.normal_error, facts.uv_error_unit == "uv" ? facts.uv_error : std::nullopt};
}

/// V104 and V105 measure every vertex of level 0 against the bounds of the mesh's record; here those bounds are held
/// against what was asked for, budgets in texels with the source's images at hand.
void check_budgets(const run::Asset& asset, const MetaFacts& facts, const scene::Scene& source,
                   std::span<const run::DecodedCluster> clusters, RuleLog& log) {
  log.check(Rule::kV113);
  std::vector<std::optional<double>> texels;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const MetaFacts::OfMesh& own = facts.of_mesh(m);
    texels.push_back(own.uv_error_unit == "texels" ? own.uv_error : std::nullopt);
  }
  check_texel_budget(asset, source, texels, clusters, log);
  constexpr double kRounding = 1.0 + 1e-6;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    const format::MeshRecord& mesh = asset.meshes()[m];
    if (mesh.cluster_count == 0) continue;
    const Budgets budgets = budgets_of(facts.of_mesh(m));
    const std::optional<double>& position = budgets.position;
    const std::optional<double>& normal = budgets.normal;
    const double uv = budgets.uv.value_or(0.0);
    const bool is_in_uv = budgets.uv.has_value();
    const auto at = [&] { return place("mesh", m); };
    if (position) {
      log.expect(double{mesh.level0_deviation} <= *position * kRounding, Rule::kV113, at, [&] {
        return differs("level-0 deviation", double{mesh.level0_deviation}, "position_error", *position);
      });
    }
    if (normal && mesh.normal_mode == format::NormalMode::kStored && mesh.normal_scale > 0) {
      const double degrees = std::sqrt(2.0) / mesh.normal_scale * 180.0 / 3.14159265358979323846;
      log.expect(degrees <= *normal * kRounding, Rule::kV113, at,
                 [&] { return differs("largest angle", degrees, "normal_error", *normal); });
    }
    std::array<bool, scene::kMaxUvSets> is_finest{};
    if (is_in_uv) is_finest = has_finest_step(asset, MeshId(m), clusters);
    for (std::uint32_t set = 0; is_in_uv && set < mesh.uv_set_count; ++set) {
      const double half_step = 0.5 * format::exp2_exact(mesh.uv_log2[set]);
      log.expect(half_step <= uv * kRounding || is_finest[set], Rule::kV113, at,
                 [&] { return differs("half a UV step", half_step, "uv_error", uv); });
    }
  }
}

}  // namespace

void check_scene(const run::Asset& asset, const scene::Scene& source, std::span<const run::DecodedCluster> clusters,
                 RuleLog& log) {
  check_materials(asset, source, log);
  check_instances(asset, source, log);
  const MetaFacts facts = read_meta_facts(asset.meta_json());
  check_blobs(asset, source, read_stated_textures(facts.textures), log);
  log.check(Rule::kV110);
  check_attributes(asset, facts, source, log);
  check_caps(asset, facts, log);
  check_tiers(asset, facts, log);
  check_budgets(asset, facts, source, clusters, log);
  const std::string& hash = facts.source_hash;
  log.expect(
      hash == source.source_hash, Rule::kV108, [] { return std::string("section META: /source/hash"); },
      [&] { return "is \"" + hash + "\", the source given has \"" + source.source_hash + "\""; });
}

}  // namespace meshlode::judge
