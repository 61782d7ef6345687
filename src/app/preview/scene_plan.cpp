// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/preview/scene_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

#include "app/preview/estimate.h"
#include "app/textures/shrink.h"
#include "base/parallel.h"
#include "base/try.h"
#include "builder/encode/encode.h"
#include "builder/encode/uv_grid.h"
#include "builder/needs.h"
#include "builder/plan/features.h"
#include "builder/plan/texel_sizes.h"
#include "builder/prepare/prepare.h"
#include "builder/stage_options.h"
#include "builder/survey.h"
#include "draw/textures/image.h"

namespace meshlode::app {

namespace {

using Texels = std::span<const std::array<double, scene::kMaxUvSets>>;

/// Bits of the integers 0 … count.
int bits_for(double count) {
  return count >= 1.0 ? std::ilogb(count) + 1 : 0;
}

/// What one mesh is planned with.
class MeshPlanner {
 public:
  MeshPlanner(const scene::Scene& scene, std::size_t index, const builder::PipelineOptions& options, Texels texels)
      : mesh_(scene.meshes[index]),
        options_(options),
        own_(options.of_mesh(index)),
        plan_(builder::plan_mesh(mesh_, scene.materials, builder::request_of(options.of_mesh(index), options.promise),
                                 builder::mesh_label(mesh_, index))) {
    out_.label = builder::mesh_label(mesh_, index);
    choose_uv_steps(texels);
  }

  Result<PlannedMesh> run() {
    const builder::MeshCounts counts = builder::count_mesh(mesh_);
    out_.triangles = counts.triangles;
    for (const scene::Primitive& primitive : mesh_.primitives) out_.vertices += primitive.positions.size();
    out_.is_whole = counts.triangles > 0 && counts.triangles <= options_.max_cluster_triangles &&
                    counts.vertices <= options_.max_cluster_vertices;
    out_.layout = plan_.layout;
    TRY_LET(grid, builder::plan_grid(mesh_, builder::prepare_options(own_)));
    out_.grid = grid->grid;
    facts_ = size_facts(mesh_, *grid);
    const SizeEstimate size = estimate(plan_.layout);
    out_.bytes = size.total();
    if (grid->largest_side > 0.0) add_positions(*grid, size.positions);
    for (builder::PlanDecision& decision : plan_.decisions) add(std::move(decision), size);
    return std::move(out_);
  }

 private:
  [[nodiscard]] SizeEstimate estimate(const builder::AttributeLayout& layout) const {
    return estimate_size(mesh_, layout, facts_, builder::normal_scale_of(encode_), uv_log2_,
                         options_.max_cluster_triangles);
  }

  /// The step of every set that the source has, kept or not.
  void choose_uv_steps(Texels texels) {
    builder::AttributeLayout all;
    for (std::uint32_t set = 0; set < scene::kMaxUvSets; ++set) {
      all.uv_set_source[all.uv_set_count++] = static_cast<std::uint8_t>(set);
    }
    encode_ = builder::encode_options(options_, own_, mesh_, all, texels);
    for (std::size_t set = 0; set < scene::kMaxUvSets; ++set) {
      builder::UvRange range;
      for (const scene::Primitive& primitive : mesh_.primitives) {
        for (const Vec2f& uv : primitive.uvs[set]) {
          range.add(uv.x);
          range.add(uv.y);
        }
      }
      const double error = encode_.uv_error[set];
      uv_log2_[set] = builder::choose_uv_log2(range, error > 0.0 ? error : builder::default_uv_error(range));
      uv_extent_[set] = range.is_empty ? 0.0 : double{range.max} - double{range.min};
    }
  }

  void add_positions(const builder::GridPlan& grid, double bytes) {
    char text[96];
    std::snprintf(text, sizeof text, "step %u * 2^%d, at most %d bits per coordinate", grid.grid.mantissa,
                  grid.grid.log2, bits_for(grid.largest_side / grid.grid.step()));
    builder::PlanDecision decision{out_.label + ": POSITION", true, "always stored", false, "POSITION"};
    if (own_.grid_step > 0.0) decision.reason = "the grid that was given";
    if (own_.position_error > 0.0) decision.reason = "the budget that was given";
    out_.attributes.push_back({std::move(decision), text, bytes});
  }

  void add(builder::PlanDecision decision, const SizeEstimate& size) {
    PlannedAttribute item;
    const std::string name = decision.attribute;
    item.decision = std::move(decision);
    const bool kept = item.decision.kept;
    builder::AttributeLayout with = plan_.layout;
    if (name == "NORMAL") {
      if (kept) item.precision = normal_precision();
      item.bytes = size.normals;
      with.has_normal = true;
    } else if (name == "COLOR_0") {
      if (kept) item.precision = "8 bits a channel";
      item.bytes = size.colors;
      with.has_color = true;
    } else if (name.starts_with("TEXCOORD_")) {
      const auto set = static_cast<std::uint32_t>(name.back() - '0');
      if (kept) item.precision = uv_precision(set);
      for (std::uint32_t k = 0; k < plan_.layout.uv_set_count; ++k) {
        if (plan_.layout.uv_set_source[k] == set) item.bytes = size.uvs[k];
      }
      if (!kept) with.uv_set_source[with.uv_set_count++] = static_cast<std::uint8_t>(set);
    }
    if (!kept) item.bytes = std::max(0.0, estimate(with).total() - size.total());
    out_.attributes.push_back(std::move(item));
  }

  [[nodiscard]] std::string normal_precision() const {
    char text[96];
    std::snprintf(text, sizeof text, "within %g degrees, at most %d bits per coordinate", own_.normal_error,
                  bits_for(2.0 * builder::normal_scale_of(encode_)));
    return text;
  }

  [[nodiscard]] std::string uv_precision(std::uint32_t set) const {
    char text[96];
    std::snprintf(text, sizeof text, "step 2^%d, at most %d bits per coordinate", uv_log2_[set],
                  bits_for(uv_extent_[set] / format::exp2_exact(uv_log2_[set])));
    return text;
  }

  const scene::SourceMesh& mesh_;
  const builder::PipelineOptions& options_;
  const builder::MeshOptions& own_;
  builder::MeshPlan plan_;
  builder::EncodeOptions encode_;
  std::array<std::int32_t, scene::kMaxUvSets> uv_log2_{};
  std::array<double, scene::kMaxUvSets> uv_extent_{};
  SizeFacts facts_;
  PlannedMesh out_;
};

std::vector<PlannedImage> plan_images(const scene::Scene& scene, const builder::TextureChoice& choice) {
  std::vector<PlannedImage> images;
  for (const scene::SceneBlob& blob : scene.blobs) {
    if (blob.kind != scene::SceneBlob::Kind::kImage) continue;
    PlannedImage& image = images.emplace_back();
    image.name = blob.name;
    image.mime_type = blob.mime_type;
    image.source_index = blob.source_index;
    image.bytes = blob.bytes.size();
    image.size = image.stored_size = read_image_size(blob.bytes);
    image.gpu_bytes = image.stored_gpu_bytes = find_gpu_bytes(blob.bytes);
    const auto header = draw::read_image_header(blob.bytes);
    if (!header) continue;  // what is not decoded keeps its size
    const auto [width, height] = fit_size(header->width, header->height, choice.longest_side);
    image.stored_size = ImageSize{width, height};
    image.stored_gpu_bytes = gpu_bytes_of(*image.stored_size);
  }
  return images;
}

}  // namespace

Result<ScenePlan> plan_scene(const scene::Scene& scene, const builder::PipelineOptions& options) {
  const auto texels = builder::texels_of_materials(scene);
  std::vector<Result<PlannedMesh>> planned(scene.meshes.size(), Error{});
  parallel_for_each_index(planned.size(), 1,
                          [&](std::size_t i) { planned[i] = MeshPlanner(scene, i, options, texels).run(); });
  ScenePlan plan;
  for (Result<PlannedMesh>& mesh : planned) {
    if (!mesh) return mesh.error();
    plan.meshes.push_back(std::move(*mesh));
  }
  plan.images = plan_images(scene, options.textures);
  plan.features = builder::list_features(scene, options.textures);
  const std::vector<builder::AggregateDecision> aggregates = builder::decide_aggregates(scene, options);
  const std::vector<builder::MeshGaps> gaps = builder::find_layers(scene, aggregates, options);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    if (!gaps[i].codes.empty()) {
      plan.features.push_back(
          builder::describe_gaps(gaps[i], plan.meshes[i].triangles, builder::mesh_label(scene.meshes[i], i)));
    }
    const builder::AggregateDecision& aggregate = aggregates[i];
    if (aggregate.reason.empty()) continue;
    plan.features.push_back(
        {builder::mesh_label(scene.meshes[i], i) + ": aggregate", aggregate.is_aggregate,
         aggregate.is_aggregate ? "thinned out by coverage: " + aggregate.reason : aggregate.reason});
  }
  for (builder::PlanDecision& decision : builder::unknown_names(scene, options))
    plan.features.push_back(std::move(decision));
  return plan;
}

}  // namespace meshlode::app
