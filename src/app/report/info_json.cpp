// SPDX-License-Identifier: GPL-3.0-or-later
// `info --format json`: the keys here are a promise; docs/schemas/info.schema.json lists them.
#include <map>

#include "app/report/info.h"
#include "base/hash.h"
#include "base/json_writer.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

/// An id, or null for "none".
void id_field(JsonWriter& w, const char* name, std::uint32_t id) {
  w.key(name);
  if (id == format::kNone) {
    w.null();
  } else {
    w.value(id);
  }
}

void write_totals(JsonWriter& w, const run::Asset& asset, const AssetInfo& info) {
  w.key("totals");
  w.begin_object();
  w.field("meshes", asset.meshes().size());
  w.field("instances", asset.instances().size());
  w.field("source_triangles", info.source_triangles);
  w.field("source_vertices", info.source_vertices);
  w.field("stored_triangles", info.stored_triangles);
  w.field("stored_vertices", info.stored_vertices);
  w.field("clusters", asset.clusters().size());
  w.field("groups", asset.groups().size());
  w.field("levels", info.levels);
  w.field("roots", info.roots);
  w.field("max_roots_per_mesh", info.max_roots_per_mesh);
  w.field("stuck_groups", info.stuck_groups);
  w.field("pages", asset.pages().size());
  w.key("bytes_per_source_triangle");
  if (info.source_triangles == 0) {
    w.null();
  } else {
    w.value(static_cast<double>(info.geometry_bytes) / static_cast<double>(info.source_triangles));
  }
  w.end_object();
}

void write_materials(JsonWriter& w, const run::Asset& asset) {
  w.key("materials");
  w.begin_array();
  for (const format::MaterialRecord& material : asset.materials()) {
    w.begin_object();
    w.field("name", asset.string(material.name));
    id_field(w, "source_index", material.source_index);
    w.field("alpha_mode", format::name_of(material.alpha_mode));
    w.field("alpha_cutoff", material.alpha_cutoff);
    w.field("double_sided", material.double_sided != 0);
    w.array_field("base_color", material.base_color);
    id_field(w, "base_color_texture", material.base_color_texture);
    id_field(w, "base_color_uv_set", material.base_color_uv_set);
    w.end_object();
  }
  w.end_array();
}

void size_field(JsonWriter& w, const char* key, std::uint32_t side) {
  w.key(key);
  if (side > 0) {
    w.value(side);
  } else {
    w.null();
  }
}

void write_image(JsonWriter& w, const run::Asset& asset, const ImageInfo& image) {
  const format::BlobRecord& blob = asset.blobs()[image.blob];
  w.begin_object();
  w.field("name", asset.string(blob.name));
  w.field("mime_type", asset.string(blob.mime_type));
  w.field("source_index", blob.source_index);
  w.field("bytes", blob.bytes);
  size_field(w, "width", image.width);
  size_field(w, "height", image.height);
  w.key("gpu_bytes");
  if (image.gpu_bytes) {
    w.value(*image.gpu_bytes);
  } else {
    w.null();
  }
  w.key("source");
  if (image.source) {
    w.begin_object();
    w.field("mime_type", image.source->mime_type);
    w.field("bytes", image.source->bytes);
    size_field(w, "width", image.source->width);
    size_field(w, "height", image.source->height);
    w.field("gpu_bytes", image.source_gpu_bytes);
    w.end_object();
  } else {
    w.null();
  }
  w.end_object();
}

void write_textures_and_images(JsonWriter& w, const run::Asset& asset, const AssetInfo& info) {
  w.key("textures");
  w.begin_array();
  for (const TextureInfo& texture : read_textures(asset.scene_json())) {
    w.begin_object();
    w.field("name", texture.name);
    w.field("image", texture.image);
    w.field("sampler", texture.sampler);
    w.end_object();
  }
  w.end_array();
  w.key("images");
  w.begin_array();
  for (const ImageInfo& image : info.images) write_image(w, asset, image);
  w.end_array();
}

void write_instances(JsonWriter& w, const run::Asset& asset) {
  w.key("instances");
  w.begin_array();
  for (const format::InstanceRecord& instance : asset.instances()) {
    w.begin_object();
    w.field("name", asset.string(instance.name));
    w.field("mesh", instance.mesh);
    w.field("node", instance.node);
    w.array_field("transform", instance.transform);  // row-major 3×4
    w.field("scale", instance.scale);
    w.field("mirrored", (instance.flags & format::kInstanceMirrored) != 0);
    w.field("singular", (instance.flags & format::kInstanceSingular) != 0);
    w.end_object();
  }
  w.end_array();
}

void write_level(JsonWriter& w, const LevelInfo& level) {
  w.begin_object();
  w.field("level", level.level);
  w.field("clusters", level.clusters);
  w.field("triangles", level.triangles);
  w.field("vertices", level.vertices);
  w.field("full_clusters", level.full_clusters);
  w.field("fill", level.fill);
  w.field("groups", level.groups);
  w.field("stuck_groups", level.stuck_groups);
  w.field("error_min", level.error_min);
  w.field("error_max", level.error_max);
  w.field("normal_deviation_max", level.normal_deviation_max);
  w.field("uv_deviation_max", level.uv_deviation_max);
  w.end_object();
}

/// Errors: the largest of a group that is not terminal.
void write_promises(JsonWriter& w, const run::Asset& asset, std::uint32_t id) {
  const format::MeshRecord& mesh = asset.meshes()[id];
  const format::PromiseMeshRecord& promise = asset.promises()[id];
  const bool has_appearance = (promise.promises & format::kPromisesAppearance) != 0;
  float texels = 0.0F, appearance = 0.0F;
  for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
    if ((asset.groups()[g].flags & format::kGroupTerminal) != 0) continue;
    texels = std::max(texels, asset.promise_errors()[g].texel_error);
    appearance = std::max(appearance, asset.promise_errors()[g].appearance_error);
  }
  w.key("promises");
  w.begin_object();
  w.key("uv_object");
  w.begin_array();
  for (std::uint32_t k = 0; k < mesh.uv_set_count; ++k) {
    w.begin_array();
    for (const float along : promise.uv_object[k]) w.value(along);
    w.end_array();
  }
  w.end_array();
  w.field("level0_texels", promise.level0_texels);
  w.field("largest_texel_error", texels);
  if (has_appearance) {
    w.field("normal_object", promise.normal_object);
    w.field("level0_appearance", promise.level0_appearance);
    w.field("largest_appearance_error", appearance);
  }
  w.end_object();
}

void write_mesh(JsonWriter& w, const run::Asset& asset, std::uint32_t id, const MeshInfo& info) {
  const format::MeshRecord& mesh = asset.meshes()[id];
  w.begin_object();
  w.field("name", asset.string(mesh.name));
  if (info.part_of) w.field("part_of", *info.part_of);
  w.field("source_triangles", mesh.source_triangles);
  w.field("source_vertices", mesh.source_vertices);
  w.field("stored_triangles", info.triangles);
  w.field("stored_vertices", info.vertices);
  w.field("clusters", info.clusters);
  w.field("groups", mesh.group_count);
  w.field("diagonal", mesh.diagonal);
  w.array_field("origin", mesh.origin);
  w.field("grid_log2", mesh.grid.log2);
  w.field("grid_mantissa", mesh.grid.mantissa);
  w.field("error_tier", format::name_of(mesh.error_tier));
  w.field("level0_deviation", mesh.level0_deviation);
  w.field("normals", format::name_of(mesh.normal_mode));
  w.field("normal_scale", mesh.normal_scale);
  w.key("uv_sets");
  w.begin_array();
  for (std::uint32_t k = 0; k < mesh.uv_set_count && k < format::kMaxUvSets; ++k) w.value(mesh.uv_set_source[k]);
  w.end_array();
  w.field("has_color", mesh.has_color != 0);
  if (!asset.promises().empty()) write_promises(w, asset, id);
  w.key("dropped");
  w.begin_object();
  w.field("degenerate", mesh.dropped_degenerate);
  w.field("duplicate", mesh.dropped_duplicate);
  w.field("repaired", mesh.dropped_repaired);
  w.end_object();
  w.field("grid_collapsed", mesh.grid_collapsed);
  w.field("roots", info.roots);
  w.field("root_triangles", info.root_triangles);
  w.field("stuck_groups", info.stuck_groups);
  std::map<std::string, std::uint64_t> reasons;
  for (const StuckGroupInfo& stuck : info.stuck) ++reasons[format::name_of(stuck.reason)];
  w.key("stuck_reasons");
  w.begin_object();
  for (const auto& [reason, count] : reasons) w.field(reason, count);
  w.end_object();
  w.key("levels");
  w.begin_array();
  for (const LevelInfo& level : info.levels) write_level(w, level);
  w.end_array();
  w.end_object();
}

/// Bytes of decoded pages; fractions of a byte where a stream ends inside one.
void write_page_bits(JsonWriter& w, const PageBits& bits) {
  const auto field = [&](const char* name, std::uint64_t count) { w.field(name, static_cast<double>(count) / 8.0); };
  field("total", bits.total());
  field("heads", bits.heads);
  field("materials", bits.materials);
  field("positions", bits.positions);
  field("normals", bits.normals);
  field("uvs", bits.uvs);
  field("colors", bits.colors);
  field("topology", bits.topology);
  field("padding", bits.padding);
}

void write_byte_map(JsonWriter& w, const ByteMap& map) {
  w.begin_object();
  w.field("table_bytes", map.table_bytes);
  w.field("stored_page_bytes", map.stored_page_bytes);
  w.field("head_bytes", map.head_bytes);
  w.field("alignment_bytes", map.alignment_bytes);
  w.field("page_alignment_bytes", map.page_alignment_bytes);
  w.field("blob_alignment_bytes", map.blob_alignment_bytes);
  w.key("pages");
  w.begin_object();
  write_page_bits(w, map.total);
  w.end_object();
  w.key("levels");
  w.begin_array();
  for (std::size_t level = 0; level < map.levels.size(); ++level) {
    w.begin_object();
    w.field("level", level);
    w.field("stored", map.stored_by_level[level]);
    write_page_bits(w, map.levels[level]);
    w.end_object();
  }
  w.end_array();
  w.end_object();
}

}  // namespace

std::string info_json(const run::Asset& asset, const AssetInfo& info, bool list_stuck) {
  const MetaInfo& meta = info.meta;
  const format::FileHeader& header = asset.header();
  Hash128 hash{};
  for (std::size_t i = 0; i < hash.size(); ++i) hash[i] = header.content_hash[i];

  JsonWriter w;
  w.begin_object();
  w.field("format_version", header.version);
  w.field("content_hash", to_hex(hash));
  w.field("file_bytes", header.file_bytes);
  w.field("geometry_bytes", info.geometry_bytes);
  w.field("image_bytes", info.image_bytes);
  w.field("image_gpu_bytes", info.image_gpu_bytes);
  w.field("source_image_bytes", info.source_image_bytes);
  w.field("source_image_gpu_bytes", info.source_image_gpu_bytes);
  w.field("generator", meta.generator);
  w.key("source");
  w.begin_object();
  w.field("file", meta.source_file);
  w.field("hash", meta.source_hash);
  w.end_object();
  w.key("settings");
  w.raw(meta.settings);
  write_totals(w, asset, info);
  w.key("dropped");
  w.begin_object();
  w.field("degenerate", info.dropped_degenerate);
  w.field("duplicate", info.dropped_duplicate);
  w.field("repaired", info.dropped_repaired);
  w.end_object();
  w.key("left_out");
  w.raw(meta.left_out);
  w.key("plan");
  w.raw(meta.plan);
  write_materials(w, asset);
  write_textures_and_images(w, asset, info);
  write_instances(w, asset);
  w.key("meshes");
  w.begin_array();
  for (std::uint32_t m = 0; m < info.meshes.size(); ++m) write_mesh(w, asset, m, info.meshes[m]);
  w.end_array();
  if (list_stuck) {
    w.key("stuck");
    w.begin_array();
    for (const MeshInfo& mesh : info.meshes) {
      for (const StuckGroupInfo& stuck : mesh.stuck) {
        w.begin_object();
        w.field("mesh", stuck.mesh);
        w.field("group", stuck.group);
        w.field("level", stuck.level);
        w.field("reason", format::name_of(stuck.reason));
        w.field("clusters", stuck.clusters);
        w.field("triangles", stuck.triangles);
        w.end_object();
      }
    }
    w.end_array();
  }
  w.key("byte_map");
  if (info.byte_map) {
    write_byte_map(w, *info.byte_map);
  } else {
    w.null();
  }
  w.key("sections");
  w.begin_array();
  for (const format::SectionEntry& section : asset.sections()) {
    w.begin_object();
    w.field("name", section_name(section.id));
    w.field("bytes", section.bytes);
    w.field("bytes_decoded", section_decoded_bytes(asset, section));
    w.end_object();
  }
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace meshlode::app
