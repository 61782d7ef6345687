// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/judge_picture.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/try.h"
#include "draw/raster/coverage.h"
#include "draw/raster/cut_pages.h"
#include "draw/raster/legend.h"
#include "draw/raster/projection.h"
#include "judge/metrics/shaded_surface.h"
#include "judge/pictures/cameras.h"
#include "run/decode/decode.h"

namespace meshlode::judge {

namespace {

using draw::ClipVertex;

/// Weights of a triangle's corners at a picture point, perspective-correct: sum(b · (x, y, w)) ∝ (px, py, 1).
Vec3d corner_weights(const ClipVertex& a, const ClipVertex& b, const ClipVertex& c, double px, double py) {
  const Vec3d p(px, py, 1.0), va(a.x, a.y, a.w), vb(b.x, b.y, b.w), vc(c.x, c.y, c.w);
  Vec3d weights(glm::dot(p, glm::cross(vb, vc)), glm::dot(p, glm::cross(vc, va)), glm::dot(p, glm::cross(va, vb)));
  if (weights.x + weights.y + weights.z < 0.0) weights = -weights;
  for (int k = 0; k < 3; ++k) weights[k] = std::max(weights[k], 0.0);  // snapping moves edges by parts of a pixel
  const double sum = weights.x + weights.y + weights.z;
  return sum > 0.0 && sum < 1e300 ? weights / sum : Vec3d(1.0 / 3.0);
}

/// A pixel's point on the surface it shows, mesh space with the origin.
struct PixelPoint {
  std::uint32_t instance = 0xFFFFFFFFu;
  Vec3d point{0.0};
  Vec3d normal{0.0};           ///< for shading, mesh space, any length
  std::uint32_t triangle = 0;  ///< of its instance's surface: the cut's clusters one after another, or the source
  double b = 0.0, c = 0.0;     ///< weights of its second and third corner
};

/// Where each entry's triangles begin among those of its instance, cluster after cluster.
std::vector<std::uint32_t> first_triangles(const run::Asset& asset, std::span<const run::ClusterInstance> cut) {
  std::map<InstanceId, std::uint32_t> count_of;
  std::vector<std::uint32_t> first;
  first.reserve(cut.size());
  for (const run::ClusterInstance& entry : cut) {
    std::uint32_t& count = count_of[entry.instance];
    first.push_back(count);
    count += asset.clusters()[entry.cluster.value].triangle_count();
  }
  return first;
}

Result<std::vector<PixelPoint>> unproject(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                          const draw::VisibilityBuffer& drawn, const draw::Projection& projection) {
  TRY_LET(pages, draw::CutPages::load(asset, cut));
  std::vector<std::vector<std::uint32_t>> pixels_of(cut.size());
  for (std::size_t i = 0; i < drawn.pixel_count(); ++i) {
    if (drawn.item[i] < cut.size()) pixels_of[drawn.item[i]].push_back(static_cast<std::uint32_t>(i));
  }
  const std::vector<std::uint32_t> first = first_triangles(asset, cut);
  std::vector<PixelPoint> out(drawn.pixel_count());
  parallel_for_each_index(cut.size(), 4, [&](std::size_t item) {
    if (pixels_of[item].empty()) return;
    const format::InstanceRecord& instance = asset.instances()[cut[item].instance.value];
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    const draw::GridToClip to_clip = draw::make_grid_to_clip(projection, mesh, instance);
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    run::DecodedCluster cluster;
    pages->decode(asset, cut[item].cluster, cluster);
    run::ClusterAttributes attributes;
    run::decode_attributes(mesh, cluster, attributes);
    for (const std::uint32_t pixel : pixels_of[item]) {
      const auto& t = cluster.triangles[drawn.triangle[pixel]];
      const std::uint32_t column = pixel % drawn.width, row = pixel / drawn.width;
      const double px = column + 0.5 - 0.5 * drawn.width, py = row + 0.5 - 0.5 * drawn.height;
      const Vec3d weights =
          corner_weights(to_clip.project(cluster.position(t[0])), to_clip.project(cluster.position(t[1])),
                         to_clip.project(cluster.position(t[2])), px, py);
      Vec3d q(0.0);
      for (int k = 0; k < 3; ++k) q += Vec3d(cluster.position(t[static_cast<std::size_t>(k)])) * weights[k];
      const Vec3d a(cluster.position(t[0])), b(cluster.position(t[1])), c(cluster.position(t[2]));
      Vec3d normal = glm::cross(b - a, c - a);
      if (!attributes.normals.empty()) {
        normal = Vec3d(0.0);
        for (int k = 0; k < 3; ++k) normal += Vec3d(attributes.normals[t[static_cast<std::size_t>(k)]]) * weights[k];
      }
      out[pixel] = {cut[item].instance.value,
                    Vec3d(mesh.origin[0], mesh.origin[1], mesh.origin[2]) + step * q,
                    normal,
                    first[item] + drawn.triangle[pixel],
                    weights[1],
                    weights[2]};
    }
  });
  return out;
}

/// The points of the source's picture.
std::vector<PixelPoint> unproject_source(const run::Asset& asset, std::span<const SourceSurface> source,
                                         const draw::VisibilityBuffer& drawn, const draw::Projection& projection) {
  std::vector<PixelPoint> out(drawn.pixel_count());
  parallel_for_each_index(drawn.pixel_count(), 1024, [&](std::size_t i) {
    if (drawn.item[i] == draw::VisibilityBuffer::kNothing) return;
    const format::InstanceRecord& instance = asset.instances()[drawn.item[i]];
    const Surface& surface = source[instance.mesh].surface;
    const auto& t = surface.triangles[drawn.triangle[i]];
    const Vec3d corners[3] = {surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]};
    const std::size_t column = i % drawn.width, row = i / drawn.width;
    const auto x = static_cast<double>(column), y = static_cast<double>(row);
    const Vec3d weights = corner_weights(
        project_source(projection, instance, corners[0]), project_source(projection, instance, corners[1]),
        project_source(projection, instance, corners[2]), x + 0.5 - 0.5 * drawn.width, y + 0.5 - 0.5 * drawn.height);
    out[i].instance = drawn.item[i];
    out[i].point = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    out[i].triangle = drawn.triangle[i];
    out[i].b = weights[1];
    out[i].c = weights[2];
  });
  return out;
}

/// Pixels that a length in mesh units covers at a point of an instance: k · σ / max(distance, near).
double pixels_per_unit_at(const draw::Projection& projection, const format::InstanceRecord& instance, const Vec3d& p) {
  if (projection.is_orthographic) return projection.pixels_per_unit * instance.scale;
  const Vec3d from_eye = transform_point(instance, p) - projection.eye;
  return projection.pixels_per_unit * instance.scale / std::max(glm::length(from_eye), projection.near_distance);
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  const double sine = glm::length(glm::cross(a, b)), cosine = glm::dot(a, b);
  return std::atan2(sine, cosine) * (180.0 / 3.14159265358979323846);
}

struct Displacement {
  double px = 0.0, allowed = 0.0;
};

/// From a point of an instance to the nearest of its other surface, mesh units: infinite where there is none.
using DistanceOf = std::function<double(const PixelPoint&)>;

std::vector<Displacement> displace(const run::Asset& asset, const draw::Projection& projection,
                                   const std::vector<PixelPoint>& points, const PictureSource& source,
                                   double pixel_error, const DistanceOf& distance_of) {
  std::vector<Displacement> out(points.size());
  parallel_for_each_index(points.size(), 256, [&](std::size_t i) {
    if (points[i].instance >= asset.instances().size()) return;
    const format::InstanceRecord& instance = asset.instances()[points[i].instance];
    const double scale = pixels_per_unit_at(projection, instance, points[i].point);
    out[i].px = distance_of(points[i]) * scale;
    const double level0 = static_cast<double>(asset.meshes()[instance.mesh].level0_deviation) * scale;
    out[i].allowed = std::max(pixel_error, level0);
    if (instance.mesh < source.painted.size()) out[i].allowed += source.painted[instance.mesh].rounding * scale;
  });
  return out;
}

/// Whether a surface point may have moved through the near plane, as far as the promise lets it.
bool may_cross_near(const run::Asset& asset, const draw::Projection& projection, const PixelPoint& point,
                    double allowed_px) {
  const format::InstanceRecord& instance = asset.instances()[point.instance];
  const double world = allowed_px * instance.scale / pixels_per_unit_at(projection, instance, point.point);
  const double* m = instance.transform;
  double distance = 0.0;
  for (int row = 0; row < 3; ++row) {
    const double* r = m + 4 * row;
    distance += projection.forward[row] *
                (r[0] * point.point.x + r[1] * point.point.y + r[2] * point.point.z + r[3] - projection.eye[row]);
  }
  return distance - world <= projection.near_distance;
}

bool is_covered_around(const draw::VisibilityBuffer& buffer, std::uint32_t x, std::uint32_t y) {
  for (int dy = -kHoleRadius; dy <= kHoleRadius; ++dy) {
    for (int dx = -kHoleRadius; dx <= kHoleRadius; ++dx) {
      const std::int64_t px = std::int64_t{x} + dx, py = std::int64_t{y} + dy;
      if (px < 0 || py < 0 || px >= buffer.width || py >= buffer.height) return false;
      const std::size_t at = static_cast<std::size_t>(py) * buffer.width + static_cast<std::size_t>(px);
      if (buffer.item[at] == draw::VisibilityBuffer::kNothing) return false;
    }
  }
  return true;
}

/// \pre every pixel within kHoleRadius shows the source
bool may_cross_near_around(const run::Asset& asset, const draw::Projection& projection,
                           const std::vector<PixelPoint>& points, const std::vector<Displacement>& moves,
                           double tolerance, std::uint32_t x, std::uint32_t y) {
  for (std::uint32_t v = y - kHoleRadius; v <= y + kHoleRadius; ++v) {
    for (std::uint32_t u = x - kHoleRadius; u <= x + kHoleRadius; ++u) {
      const std::size_t at = std::size_t{v} * projection.size.width + u;
      if (may_cross_near(asset, projection, points[at], moves[at].allowed * tolerance)) return true;
    }
  }
  return false;
}

/// Every cluster of level 0, in every instance that can be drawn.
std::vector<run::ClusterInstance> finest_cut(const run::Asset& asset) {
  std::vector<run::ClusterInstance> finest;
  for (std::size_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    if ((instance.flags & format::kInstanceSingular) != 0) continue;
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
      if (asset.clusters()[c].level == 0) finest.push_back({InstanceId(i), ClusterId(c)});
    }
  }
  return finest;
}

/// What each pixel shows from one camera: of the cut, of level 0, of the source.
struct Pictures {
  draw::VisibilityBuffer full, truth;  ///< the cut's is the caller's
  std::vector<PixelPoint> cut_points, full_points, truth_points;
};

Result<Pictures> draw_pictures(const run::Asset& asset, const PictureSource& source,
                               std::span<const run::ClusterInstance> cut, const draw::VisibilityBuffer& drawn,
                               const run::Camera& camera, const draw::Projection& projection,
                               const draw::AlphaMasks& masks) {
  Pictures out;
  const std::vector<run::ClusterInstance> finest = finest_cut(asset);
  TRY_LET(full, draw::draw_cut(asset, finest, camera, masks));
  TRY_LET(cut_points, unproject(asset, cut, drawn, projection));
  TRY_LET(full_points, unproject(asset, finest, *full, projection));
  out.full = std::move(*full);
  out.cut_points = std::move(*cut_points);
  out.full_points = std::move(*full_points);
  out.truth = draw_source(asset, source.meshes, projection);
  out.truth_points = unproject_source(asset, source.meshes, out.truth, projection);
  return out;
}

/// Per pixel: of the cut's picture to the source, and of the source's picture to the cut.
struct Displacements {
  std::vector<Displacement> there, back;
};

/// The cut of each instance as a surface, for the way back.
std::map<std::uint32_t, std::vector<ClusterId>> clusters_of_instances(std::span<const run::ClusterInstance> cut) {
  std::map<std::uint32_t, std::vector<ClusterId>> clusters_of;
  for (const run::ClusterInstance& entry : cut) clusters_of[entry.instance.value].push_back(entry.cluster);
  return clusters_of;
}

Displacements find_displacements(const run::Asset& asset, const PictureSource& source,
                                 std::span<const run::ClusterInstance> cut, const Pictures& pictures,
                                 const draw::Projection& projection, double pixel_error) {
  std::map<std::uint32_t, TriangleTree> cut_of;
  for (const auto& [instance, clusters] : clusters_of_instances(cut)) {
    const MeshId mesh(asset.instances()[instance].mesh);
    cut_of.try_emplace(instance, surface_of_clusters(asset, source.decoded, mesh, clusters));
  }
  const auto distance = [](const TriangleTree* tree, const Vec3d& point) {
    return tree == nullptr ? HUGE_VAL : std::sqrt(tree->nearest(point).distance2);
  };
  const auto to_source = [&](const PixelPoint& p) {
    const std::uint32_t mesh = asset.instances()[p.instance].mesh;
    return distance(mesh < source.meshes.size() ? &*source.meshes[mesh].tree : nullptr, p.point);
  };
  const auto to_cut = [&](const PixelPoint& p) {
    const auto found = cut_of.find(p.instance);
    return distance(found != cut_of.end() ? &found->second : nullptr, p.point);
  };
  return {displace(asset, projection, pictures.cut_points, source, pixel_error, to_source),
          displace(asset, projection, pictures.truth_points, source, pixel_error, to_cut)};
}

/// The same in the product space. \pre source.painted is as long as source.meshes
Displacements find_painted_displacements(const run::Asset& asset, const PictureSource& source,
                                         std::span<const run::ClusterInstance> cut, const Pictures& pictures,
                                         const draw::Projection& projection, double pixel_error) {
  std::map<std::uint32_t, ProductSurface> cut_of;
  for (const auto& [instance, clusters] : clusters_of_instances(cut)) {
    const std::uint32_t mesh = asset.instances()[instance].mesh;
    if (mesh >= source.painted.size()) continue;
    cut_of.try_emplace(instance, shaded_surface_of_clusters(asset, source.decoded, MeshId(mesh), clusters),
                       source.painted[mesh].scales);
  }
  const auto distance = [](const ProductSurface* from, const ProductSurface* to, const PixelPoint& p) {
    return from == nullptr || to == nullptr ? HUGE_VAL : from->distance_to(*to, p.triangle, p.b, p.c);
  };
  const auto truth_of = [&](const PixelPoint& p) {
    const std::uint32_t mesh = asset.instances()[p.instance].mesh;
    return mesh < source.painted.size() ? &source.painted[mesh].surface : nullptr;
  };
  const auto drawn_of = [&](const PixelPoint& p) {
    const auto found = cut_of.find(p.instance);
    return found != cut_of.end() ? &found->second : nullptr;
  };
  return {displace(asset, projection, pictures.cut_points, source, pixel_error,
                   [&](const PixelPoint& p) { return distance(drawn_of(p), truth_of(p), p); }),
          displace(asset, projection, pictures.truth_points, source, pixel_error,
                   [&](const PixelPoint& p) { return distance(truth_of(p), drawn_of(p), p); })};
}

/// Pixels of the background that are holes: PictureReport::holes says which.
Result<std::uint64_t> count_holes(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                  const draw::VisibilityBuffer& drawn, const Pictures& pictures,
                                  const std::vector<Displacement>& back, const run::Camera& camera,
                                  const draw::Projection& projection, double tolerance) {
  std::uint64_t holes = 0;
  std::optional<draw::VisibilityBuffer> both_sides;  // drawn where it is asked for
  for (std::size_t i = 0; i < drawn.item.size(); ++i) {
    if (drawn.item[i] != draw::VisibilityBuffer::kNothing) continue;
    const auto x = static_cast<std::uint32_t>(i % drawn.width), y = static_cast<std::uint32_t>(i / drawn.width);
    if (!is_covered_around(pictures.truth, x, y)) continue;
    if (may_cross_near_around(asset, projection, pictures.truth_points, back, tolerance, x, y)) continue;
    if (!both_sides) {
      TRY_LET(buffer, draw::draw_cut(asset, cut, camera, {}, draw::Sides::kBoth));
      both_sides = std::move(*buffer);
    }
    if (both_sides->item[i] != draw::VisibilityBuffer::kNothing) ++holes;
  }
  return holes;
}

/// Silhouettes, depths and normals of the cut against level 0.
void compare_with_full(const draw::VisibilityBuffer& drawn, const Pictures& pictures, PictureReport& out) {
  const draw::VisibilityBuffer& full = pictures.full;
  out.depth_difference.resize(drawn.item.size(), -1.0F);
  out.normal_degrees.resize(drawn.item.size(), -1.0F);
  double normal_sum = 0.0;
  for (std::size_t i = 0; i < drawn.item.size(); ++i) {
    const bool is_cut = drawn.item[i] != draw::VisibilityBuffer::kNothing,
               is_full = full.item[i] != draw::VisibilityBuffer::kNothing;
    out.only_cut += is_cut && !is_full ? 1 : 0;
    out.only_source += is_full && !is_cut ? 1 : 0;
    if (!is_cut || !is_full) continue;
    if (drawn.depth[i] > 0) {
      const double difference = std::abs(double{drawn.depth[i] * 1.0} - full.depth[i] * 1.0);
      const double relative = difference / std::max(1.0, full.depth[i] * 1.0);
      out.largest_depth = std::max(out.largest_depth, relative);
      out.depth_difference[i] = static_cast<float>(relative);
    }
    const PixelPoint& p = pictures.cut_points[i];
    const PixelPoint& q = pictures.full_points[i];
    if (p.instance == q.instance && glm::dot(p.normal, p.normal) > 0.0 && glm::dot(q.normal, q.normal) > 0.0) {
      const double degrees = degrees_between(p.normal, q.normal);
      out.normal_degrees[i] = static_cast<float>(degrees);
      out.largest_normal_degrees = std::max(out.largest_normal_degrees, degrees);
      normal_sum += degrees;
      ++out.normals;
    }
  }
  out.mean_normal_degrees = out.normals > 0 ? normal_sum / static_cast<double>(out.normals) : 0.0;
}

/// How far anything moved, both ways, against what is allowed there.
void judge_displacements(const draw::VisibilityBuffer& drawn, const Pictures& pictures, const Displacements& moves,
                         double tolerance, PictureReport& out) {
  out.displacement_px.resize(drawn.item.size(), -1.0F);
  double sum = 0.0;
  for (std::size_t i = 0; i < drawn.item.size(); ++i) {
    const bool is_cut = drawn.item[i] != draw::VisibilityBuffer::kNothing;
    out.covered += is_cut ? 1 : 0;
    out.covered_source += pictures.truth.item[i] != draw::VisibilityBuffer::kNothing ? 1 : 0;
    if (is_cut) out.displacement_px[i] = static_cast<float>(moves.there[i].px);
    for (const Displacement& d : {moves.there[i], moves.back[i]}) {
      if (d.allowed == 0.0) continue;
      ++out.points;
      out.largest_px = std::max(out.largest_px, d.px);
      out.largest_share = std::max(out.largest_share, d.px / d.allowed);
      out.allowed_px = std::max(out.allowed_px, d.allowed);
      if (d.px > d.allowed * tolerance * (1.0 + 1e-9)) ++out.exceeded;
    }
    sum += moves.there[i].px;
  }
  out.mean_px = out.covered > 0 ? sum / static_cast<double>(out.covered) : 0.0;
}

}  // namespace

Result<PictureReport> judge_picture(const run::Asset& asset, const PictureSource& source,
                                    std::span<const run::ClusterInstance> cut, const draw::VisibilityBuffer& drawn,
                                    const run::Camera& camera, double pixel_error, const draw::AlphaMasks& masks) {
  TRY_LET(projection, draw::make_projection(camera));
  projection->far_distance = draw::scene_depth(asset, *projection);
  TRY_LET(pictures, draw_pictures(asset, source, cut, drawn, camera, *projection, masks));
  const Displacements moves = source.painted.empty()
                                  ? find_displacements(asset, source, cut, *pictures, *projection, pixel_error)
                                  : find_painted_displacements(asset, source, cut, *pictures, *projection, pixel_error);

  PictureReport out;
  compare_with_full(drawn, *pictures, out);
  judge_displacements(drawn, *pictures, moves, source.tolerance, out);
  TRY_LET(holes, count_holes(asset, cut, drawn, *pictures, moves.back, camera, *projection, source.tolerance));
  out.holes = *holes;
  return out;
}

draw::Image heat_map(std::span<const float> values, std::uint32_t width, std::uint32_t height, float full) {
  draw::Image image;
  image.width = width;
  image.height = height;
  image.rgba.assign(values.size() * 4, 255);
  constexpr std::uint32_t kSteps = 256;
  for (std::size_t i = 0; i < values.size(); ++i) {
    draw::Rgb color{0.85, 0.85, 0.85};
    if (values[i] >= 0.0F) {
      const double share = std::min(1.0, static_cast<double>(values[i]) / static_cast<double>(full));
      color = draw::level_color(static_cast<std::uint32_t>(share * (kSteps - 1)), kSteps);
    }
    for (std::size_t k = 0; k < 3; ++k) image.rgba[4 * i + k] = draw::to_display(color[k]);
  }
  return image;
}

}  // namespace meshlode::judge
