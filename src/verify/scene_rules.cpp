// SPDX-License-Identifier: GPL-3.0-or-later
// What surrounds the geometry: materials, instances, images and the source's name for itself (V106 … V109).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "validate/file_tables.h"
#include "verify/source_rules.h"

namespace meshlode {

namespace {

bool is_same_material(const Asset& asset, const format::MaterialRecord& stored, const SceneMaterial& source) {
  bool same = asset.string(stored.name) == source.name && stored.source_index == source.source_index &&
              static_cast<std::uint32_t>(stored.alpha_mode) == static_cast<std::uint32_t>(source.alpha_mode) &&
              stored.alpha_cutoff == source.alpha_cutoff && (stored.double_sided != 0) == source.double_sided &&
              stored.base_color_texture == source.base_color_texture && stored.base_color_uv_set == source.base_color_uv_set;
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

void check_materials(const Asset& asset, const Scene& source, RuleLog& log) {
  log.expect(asset.materials().size() == source.materials.size(), "V106", [] { return std::string("materials"); }, [&] {
    return differs("stored", std::uint64_t{asset.materials().size()}, "source", std::uint64_t{source.materials.size()});
  });
  const std::size_t count = std::min(asset.materials().size(), source.materials.size());
  for (std::size_t i = 0; i < count; ++i) {
    log.expect(is_same_material(asset, asset.materials()[i], source.materials[i]), "V106", [&] { return place("material", i); },
               [] { return std::string("is not the source's"); });
  }
}

void check_instances(const Asset& asset, const Scene& source, RuleLog& log) {
  log.expect(asset.instances().size() == source.instances.size(), "V107", [] { return std::string("instances"); }, [&] {
    return differs("stored", std::uint64_t{asset.instances().size()}, "source", std::uint64_t{source.instances.size()});
  });
  const std::size_t count = std::min(asset.instances().size(), source.instances.size());
  for (std::size_t i = 0; i < count; ++i) {
    const format::InstanceRecord& stored = asset.instances()[i];
    const SceneInstance& instance = source.instances[i];
    const auto at = [&] { return place("instance", i); };
    log.expect(stored.mesh == instance.mesh.value && stored.node == instance.node && asset.string(stored.name) == instance.name,
               "V107", at, [] { return std::string("names another mesh, node or name"); });
    log.expect(is_same_transform(stored, instance.transform), "V107", at, [] { return std::string("has another transform"); });
  }
}

void check_blobs(const Asset& asset, const Scene& source, RuleLog& log) {
  log.expect(asset.blobs().size() == source.blobs.size(), "V109", [] { return std::string("blobs"); }, [&] {
    return differs("stored", std::uint64_t{asset.blobs().size()}, "source", std::uint64_t{source.blobs.size()});
  });
  const std::size_t count = std::min(asset.blobs().size(), source.blobs.size());
  for (std::size_t i = 0; i < count; ++i) {
    const format::BlobRecord& stored = asset.blobs()[i];
    const SceneBlob& blob = source.blobs[i];
    const auto kind = blob.kind == SceneBlob::Kind::kImage ? format::BlobKind::kImage : format::BlobKind::kBuffer;
    const auto bytes = asset.blob_bytes(stored);
    const bool same = stored.kind == kind && stored.source_index == blob.source_index && asset.string(stored.name) == blob.name &&
                      asset.string(stored.mime_type) == blob.mime_type && std::equal(bytes.begin(), bytes.end(), blob.bytes.begin(), blob.bytes.end());
    log.expect(same, "V109", [&] { return place("blob", i); }, [] { return std::string("is not the source's"); });
  }
  log.expect(asset.scene_json() == source.document, "V109", [] { return std::string("section SCNE"); },
             [] { return std::string("is not the source's scene document"); });
}

}  // namespace

void check_scene(const Asset& asset, const Scene& source, RuleLog& log) {
  check_materials(asset, source, log);
  check_instances(asset, source, log);
  check_blobs(asset, source, log);
  const std::string hash = source_hash_of(asset.meta_json());
  log.expect(hash == source.source_hash, "V108", [] { return std::string("section META: /source/hash"); },
             [&] { return "is \"" + hash + "\", the source given has \"" + source.source_hash + "\""; });
}

}  // namespace meshlode
