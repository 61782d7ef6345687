// SPDX-License-Identifier: GPL-3.0-or-later
// <meshlode/meshlode_build.h> over <meshlode/build.h>: C's pointers and counts become spans, and enumerators that C
// writes as numbers are looked at before they are one.
#include <meshlode/meshlode_build.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <meshlode/build.h>

#include "base/guarded.h"
#include "base/output_files.h"
#include "base/try.h"

namespace meshlode {
namespace {

/// A view of what lies in a scene_input: names and arrays are the caller's, tables of views are here.
struct SceneViews {
  std::vector<std::vector<PrimitiveInput>> primitives;
  std::vector<MeshInput> meshes;
  std::vector<MaterialInput> materials;
  std::vector<InstanceInput> instances;
};

Error usage(std::string where, const char* detail) {
  return {ErrorCode::kUsage, std::move(where), detail};
}

std::string at(const char* array, std::size_t index) {
  return std::string(array) + '[' + std::to_string(index) + ']';
}

std::string_view text_of(const char* text) {
  return text == nullptr ? std::string_view() : std::string_view(text);
}

template <class T>
std::span<const T> numbers(const T* first, std::size_t components, std::size_t count) {
  return first == nullptr ? std::span<const T>() : std::span<const T>(first, components * count);
}

/// As many as fit 32-bit ids, so that no product of a count wraps around.
Status check_table(const void* first, std::size_t count, const std::string& where) {
  if (count > std::numeric_limits<std::uint32_t>::max()) return usage(where, "is more than there are ids for");
  if (count > 0 && first == nullptr) return usage(where, "has a count and no elements");
  return Ok{};
}

Result<PrimitiveInput> view(const meshlode_primitive_input& in, const std::string& where) {
  TRY(check_table(&in, in.vertex_count, where + ".vertex_count"));
  TRY(check_table(in.indices, in.triangle_count, where + ".indices"));
  PrimitiveInput out;
  out.positions = numbers(in.positions, 3, in.vertex_count);
  out.positions_double = numbers(in.positions_double, 3, in.vertex_count);
  out.normals = numbers(in.normals, 3, in.vertex_count);
  for (std::size_t k = 0; k < out.uvs.size(); ++k) out.uvs[k] = numbers(in.uvs[k], 2, in.vertex_count);
  out.colors = numbers(in.colors, 4, in.vertex_count);
  out.indices = numbers(in.indices, 3, in.triangle_count);
  out.material = in.material;
  return out;
}

MaterialInput view(const meshlode_material_input& in) {
  MaterialInput out;
  out.name = text_of(in.name);
  std::copy(std::begin(in.base_color), std::end(in.base_color), out.base_color.begin());
  out.alpha_mode = static_cast<format::AlphaMode>(in.alpha_mode);  // checked with the scene
  out.alpha_cutoff = in.alpha_cutoff;
  out.double_sided = in.double_sided != 0;
  out.uv_sets_used = in.uv_sets_used;
  return out;
}

InstanceInput view(const meshlode_instance_input& in) {
  InstanceInput out;
  out.name = text_of(in.name);
  out.mesh = in.mesh;
  std::copy(std::begin(in.transform), std::end(in.transform), out.transform.begin());
  return out;
}

Status view_meshes(const meshlode_scene_input& scene, SceneViews& out) {
  for (std::size_t m = 0; m < scene.mesh_count; ++m) {
    const meshlode_mesh_input& mesh = scene.meshes[m];
    const std::string where = at("meshes", m);
    const Status has_all = check_table(mesh.primitives, mesh.primitive_count, where + ".primitives");
    if (!has_all) return has_all;
    std::vector<PrimitiveInput>& primitives = out.primitives.emplace_back();
    for (std::size_t p = 0; p < mesh.primitive_count; ++p) {
      TRY_LET(primitive, view(mesh.primitives[p], where + "." + at("primitives", p)));
      primitives.push_back(*primitive);
    }
    out.meshes.push_back({text_of(mesh.name), {}});
  }
  for (std::size_t m = 0; m < scene.mesh_count; ++m) out.meshes[m].primitives = out.primitives[m];
  return Ok{};
}

Result<SceneInput> view_scene(const meshlode_scene_input* scene, SceneViews& views) {
  if (scene == nullptr) return usage("scene", "is not there");
  TRY(check_table(scene->meshes, scene->mesh_count, "meshes"));
  TRY(check_table(scene->materials, scene->material_count, "materials"));
  TRY(check_table(scene->instances, scene->instance_count, "instances"));
  TRY(view_meshes(*scene, views));
  for (std::size_t i = 0; i < scene->material_count; ++i) views.materials.push_back(view(scene->materials[i]));
  for (std::size_t i = 0; i < scene->instance_count; ++i) views.instances.push_back(view(scene->instances[i]));
  SceneInput out;
  out.name = text_of(scene->name);
  out.meshes = views.meshes;
  out.materials = views.materials;
  out.instances = views.instances;
  return out;
}

Result<BuildOptions> read_options(const meshlode_build_options& in) {
  const auto limit = [](const char* field) { return usage(field, "is not one of its enumerators"); };
  if (in.error_tier > 2 && in.error_tier != MESHLODE_TIER_OF_PRESET) return limit("error_tier");
  if (in.preset > 2) return limit("preset");
  if (in.strip_effort > 3) return limit("strip_effort");
  if (in.page_order > 1) return limit("page_order");
  if (in.attributes > 2) return limit("attributes");
  if (in.aggregate > 4) return limit("aggregate");
  if (in.promise > 2) return limit("promise");
  BuildOptions out;
  if (in.error_tier != MESHLODE_TIER_OF_PRESET) out.error_tier = static_cast<format::ErrorTier>(in.error_tier);
  out.preset = static_cast<Preset>(in.preset);
  out.strip_effort = static_cast<StripEffort>(in.strip_effort);
  out.attributes = static_cast<AttributeChoice>(in.attributes);
  out.keep = in.keep;
  out.drop = in.drop;
  out.codec = static_cast<format::Codec>(in.codec);  // as wide as C's, and checked there
  out.cluster_triangles = in.cluster_triangles;
  out.group_clusters = in.group_clusters;
  out.page_size = in.page_size;
  out.page_order = static_cast<PageOrder>(in.page_order);
  out.root_bytes = in.root_bytes;
  out.page_hints = in.page_hints != 0;
  out.grid_step = in.grid_step;
  out.position_error = in.position_error;
  out.normal_error = in.normal_error;
  out.uv_error = in.uv_error;
  out.uv_error_unit = in.uv_error_is_texels != 0 ? UvErrorUnit::kTexels : UvErrorUnit::kUv;
  out.repair = in.repair != 0;
  out.linear_colors = in.linear_colors != 0;
  out.keep_topology = in.keep_topology != 0;
  out.lock_borders = in.lock_borders != 0;
  out.keep_layers = in.keep_layers != 0;
  out.aggregate = static_cast<AggregateChoice>(in.aggregate);
  out.aggregate_names = text_of(in.aggregate_names);
  out.promise = static_cast<format::Promise>(in.promise);
  out.max_memory_bytes = in.max_memory_bytes;
  out.thread_count = in.thread_count;
  return out;
}

Result<std::vector<std::uint8_t>> build_bytes(const meshlode_scene_input* scene, const meshlode_build_options* given) {
  meshlode_build_options options;
  meshlode_build_defaults(&options);
  if (given != nullptr) options = *given;
  SceneViews views;
  TRY_LET(input, view_scene(scene, views));
  TRY_LET(read, read_options(options));
  std::atomic<bool> is_cancelled = false;  // the two are not called from the same thread
  if (options.on_progress != nullptr) {
    read->on_progress = [&](const BuildProgress& progress) {
      if (!is_cancelled && options.on_progress(progress.fraction, options.user) != 0) is_cancelled = true;
    };
    read->should_cancel = [&] { return is_cancelled.load(); };
  }
  return build_asset(*input, *read);
}

Status build_to_buffer(const meshlode_scene_input* scene, const meshlode_build_options* options, void** bytes,
                       std::size_t* size) {
  if (bytes == nullptr || size == nullptr) return usage("bytes", "has no place");
  TRY_LET(built, build_bytes(scene, options));
  void* const copy = std::malloc(built->size());  // at least a header, so never empty
  if (copy == nullptr) return out_of_memory({});
  std::memcpy(copy, built->data(), built->size());
  *bytes = copy;
  *size = built->size();
  return Ok{};
}

Status build_to_file(const meshlode_scene_input* scene, const meshlode_build_options* options, const char* path) {
  if (path == nullptr) return usage("path", "is not there");
  OutputFiles files;
  if (Status free = files.claim(path); !free) return free;
  TRY_LET(built, build_bytes(scene, options));
  return files.write(path, *built);
}

meshlode_status status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUsage: return MESHLODE_USAGE;
    case ErrorCode::kIo: return MESHLODE_IO;
    case ErrorCode::kInvalid: return MESHLODE_INVALID;
    case ErrorCode::kUnsupported: return MESHLODE_UNSUPPORTED;
    case ErrorCode::kBuildFailed:
    case ErrorCode::kCheckFailed: break;
  }
  return MESHLODE_BUILD_FAILED;
}

meshlode_status report(const Status& result, meshlode_error* error) {
  const meshlode_status status = result ? MESHLODE_OK : status_of(result.error().code);
  if (error == nullptr) return status;
  const std::string text = result ? std::string() : result.error().message();
  error->status = status;
  std::size_t size = std::min(text.size(), sizeof error->text - 1);
  // Not in the middle of a character of UTF-8.
  while (size > 0 && size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) --size;
  std::memcpy(error->text, text.data(), size);
  error->text[size] = '\0';
  return status;
}

}  // namespace
}  // namespace meshlode

extern "C" {

void meshlode_build_defaults(meshlode_build_options* options) {
  const meshlode::BuildOptions defaults;
  *options = {};
  options->error_tier = MESHLODE_TIER_OF_PRESET;
  options->strip_effort = static_cast<uint32_t>(defaults.strip_effort);
  options->preset = static_cast<uint32_t>(defaults.preset);
  options->attributes = static_cast<uint32_t>(defaults.attributes);
  options->keep = defaults.keep;
  options->drop = defaults.drop;
  options->codec = static_cast<uint32_t>(defaults.codec);
  options->cluster_triangles = defaults.cluster_triangles;
  options->group_clusters = defaults.group_clusters;
  options->page_size = defaults.page_size;
  options->page_order = static_cast<uint32_t>(defaults.page_order);
  options->root_bytes = defaults.root_bytes;
  options->page_hints = defaults.page_hints ? 1 : 0;
  options->grid_step = defaults.grid_step;
  options->position_error = defaults.position_error;
  options->normal_error = defaults.normal_error;
  options->uv_error = defaults.uv_error;
  options->uv_error_is_texels = defaults.uv_error_unit == meshlode::UvErrorUnit::kTexels ? 1 : 0;
  options->repair = defaults.repair ? 1 : 0;
  options->linear_colors = defaults.linear_colors ? 1 : 0;
  options->keep_topology = defaults.keep_topology ? 1 : 0;
  options->keep_layers = defaults.keep_layers ? 1 : 0;
  options->lock_borders = defaults.lock_borders ? 1 : 0;
  options->aggregate = static_cast<uint32_t>(defaults.aggregate);
  options->aggregate_names = nullptr;
  options->promise = static_cast<uint32_t>(defaults.promise);
  options->max_memory_bytes = defaults.max_memory_bytes;
  options->thread_count = defaults.thread_count;
}

meshlode_status meshlode_build_to_buffer(const meshlode_scene_input* scene, const meshlode_build_options* options,
                                         void** bytes, size_t* size, meshlode_error* error) {
  const auto build = [&] { return meshlode::build_to_buffer(scene, options, bytes, size); };
  return meshlode::report(meshlode::guarded({}, build), error);
}

void meshlode_build_free(void* bytes) {
  std::free(bytes);
}

meshlode_status meshlode_build_to_file(const meshlode_scene_input* scene, const meshlode_build_options* options,
                                       const char* path, meshlode_error* error) {
  const auto build = [&] { return meshlode::build_to_file(scene, options, path); };
  return meshlode::report(meshlode::guarded({}, build), error);
}

}  // extern "C"
