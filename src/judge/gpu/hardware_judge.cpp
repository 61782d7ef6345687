// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/hardware_judge.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "draw/gpu/gpu_camera.h"
#include "draw/raster/alpha_cutoff.h"
#include "draw/raster/cut_pages.h"
#include "draw/raster/projection.h"
#include "judge/gpu/hardware_freedom.h"

namespace meshlode::judge {

namespace {

constexpr std::int32_t kBandRows = 16;

/// A triangle of the cut that hardware may show.
struct Shown {
  TriangleFreedom freedom;
  std::array<Vec3i, 3> corner;  ///< grid integers: an edge is known by its instance and their ends
  std::uint32_t instance = 0, item = 0, triangle = 0;
  std::optional<draw::MaskedTriangle> mask;
};

/// What a triangle may do at a pixel.
struct Candidate {
  std::uint32_t shown = 0;
  TriangleFreedom::Sample sample;
};

std::vector<Shown> find_shown(const run::Asset& asset, const run::ClusterInstance& entry, std::uint32_t item,
                              const draw::CutPages& pages, const draw::Projection& projection,
                              const draw::AlphaMasks& masks, std::uint32_t subpixel_bits) {
  std::vector<Shown> out;
  const format::InstanceRecord& instance = asset.instances()[entry.instance.value];
  if ((instance.flags & format::kInstanceSingular) != 0) return out;
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  run::DecodedCluster cluster;
  pages.decode(asset, entry.cluster, cluster);
  const draw::GridToClip to_clip = draw::make_grid_to_clip(projection, mesh, instance);
  const bool is_mirrored = (instance.flags & format::kInstanceMirrored) != 0;
  for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
    const auto [a, b, c] = cluster.triangles[t];
    const std::array<Vec3i, 3> corner = {cluster.position(a), cluster.position(b), cluster.position(c)};
    const TriangleFreedom freedom({to_clip.project(corner[0]), to_clip.project(corner[1]), to_clip.project(corner[2])},
                                  projection.size, subpixel_bits);
    if (freedom.is_empty() || freedom.columns().is_empty() || freedom.rows().is_empty()) continue;
    const bool is_double_sided = asset.materials()[cluster.triangle_material[t]].double_sided != 0;
    const bool is_front = (freedom.area() < 0.0) != is_mirrored;
    if (!is_double_sided && !is_front && !freedom.is_facing_open()) continue;
    out.push_back({freedom, corner, entry.instance.value, item, t, draw::find_mask(masks, mesh, cluster, t, to_clip)});
  }
  return out;
}

class PictureJudge {
 public:
  PictureJudge(std::span<const Shown> shown, const draw::VisibilityBuffer& drawn,
               const draw::VisibilityBuffer& reference)
      : shown_(shown), drawn_(drawn), reference_(reference) {}

  /// Rows of one band, with the triangles that touch it.
  void judge(std::int32_t band, std::span<const std::uint32_t> triangles, Comparison& out) const {
    const auto width = static_cast<std::int32_t>(drawn_.width), height = static_cast<std::int32_t>(drawn_.height);
    const std::int32_t first = band * kBandRows, last = std::min(first + kBandRows, height) - 1;
    std::vector<std::vector<Candidate>> of_pixel(static_cast<std::size_t>(width) *
                                                 static_cast<std::size_t>(last - first + 1));
    const auto index_of = [&](std::int32_t x, std::int32_t y) {
      return static_cast<std::size_t>(y - first) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    for (const std::uint32_t index : triangles) {
      const TriangleFreedom& freedom = shown_[index].freedom;
      const std::int32_t low = std::max(first, freedom.rows().first), high = std::min(last, freedom.rows().last);
      for (std::int32_t y = low; y <= high; ++y) {
        for (std::int32_t x = freedom.columns().first; x <= freedom.columns().last; ++x) {
          const auto sample = freedom.at(x, y);
          if (!sample || !passes_alpha_at(shown_[index], x, y)) continue;
          of_pixel[index_of(x, y)].push_back({index, *sample});
        }
      }
    }
    for (std::int32_t y = first; y <= last; ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        judge_pixel(x, y, of_pixel[index_of(x, y)], out);
      }
    }
  }

 private:
  [[nodiscard]] bool passes_alpha_at(const Shown& shown, std::int32_t x, std::int32_t y) const {
    return !shown.mask || draw::passes_alpha(*shown.mask, x + 0.5 - 0.5 * drawn_.width, y + 0.5 - 0.5 * drawn_.height);
  }

  void judge_pixel(std::int32_t x, std::int32_t y, std::span<const Candidate> candidates, Comparison& out) const {
    const std::size_t at = static_cast<std::size_t>(y) * drawn_.width + static_cast<std::size_t>(x);
    const bool has = drawn_.item[at] != draw::VisibilityBuffer::kNothing;
    const double depth = has ? static_cast<double>(drawn_.depth[at]) : -1e300;
    out.items += reference_.item[at] != draw::VisibilityBuffer::kNothing ? 1 : 0;
    std::string why;
    if (has) {
      const auto own = std::find_if(candidates.begin(), candidates.end(),
                                    [&](const Candidate& c) { return is(c, drawn_.item[at], drawn_.triangle[at]); });
      if (own == candidates.end()) {
        why = "its triangle cannot cover it";
      } else if (depth < own->sample.low || depth > own->sample.high) {
        why = "its triangle's depths there are " + range(own->sample);
      }
    }
    for (const Candidate& c : candidates) {
      if (why.empty() && c.sample.is_certain && c.sample.low > depth)
        why = "a nearer one covers it, " + range(c.sample);
    }
    if (why.empty() && is_closed_before(x, y, depth, candidates)) why = "nearer ones that share edges cover it";
    if (why.empty()) return;
    if (out.differences++ > 0) return;
    out.first = "pixel " + std::to_string(x) + "," + std::to_string(y) + ": " +
                (has ? "item " + std::to_string(drawn_.item[at]) + " triangle " + std::to_string(drawn_.triangle[at]) +
                           " depth " + std::to_string(drawn_.depth[at])
                     : std::string("nothing")) +
                ", but " + why + "; the CPU's depth is " + std::to_string(reference_.depth[at]);
  }

  [[nodiscard]] bool is(const Candidate& c, std::uint32_t item, std::uint32_t triangle) const {
    return shown_[c.shown].item == item && shown_[c.shown].triangle == triangle;
  }
  [[nodiscard]] static std::string range(const TriangleFreedom::Sample& s) {
    return std::to_string(static_cast<std::int64_t>(s.low)) + " to " +
           std::to_string(static_cast<std::int64_t>(s.high));
  }

  /// Whether triangles nearer than `depth` cover the pixel together: the one that the CPU shows there, and across each
  /// edge that passes within reach of the sample the one that shares it, which moves with it. Their outline then passes
  /// nowhere near, so the sample stays as often inside as it is in the CPU's picture.
  [[nodiscard]] bool is_closed_before(std::int32_t x, std::int32_t y, double depth,
                                      std::span<const Candidate> candidates) const {
    const std::size_t at = static_cast<std::size_t>(y) * drawn_.width + static_cast<std::size_t>(x);
    const auto is_nearer = [&](const Candidate& c) {
      return c.sample.low > depth && !shown_[c.shown].freedom.is_facing_open();
    };
    std::vector<const Candidate*> group;
    for (const Candidate& c : candidates) {
      if (is(c, reference_.item[at], reference_.triangle[at]) && is_nearer(c)) group.push_back(&c);
    }
    for (std::size_t i = 0; i < group.size(); ++i) {
      const Shown& own = shown_[group[i]->shown];
      const std::uint32_t near = own.freedom.edges_near(x, y, group[i]->sample.reach);
      if ((near & 8u) != 0) return false;  // the near plane ends it there
      for (std::uint32_t k = 0; k < 3; ++k) {
        if ((near >> k & 1u) == 0) continue;
        const auto across = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) {
          return is_nearer(c) && joins(own, k, shown_[c.shown]);
        });
        if (across == candidates.end()) return false;
        if (std::find(group.begin(), group.end(), &*across) == group.end()) group.push_back(&*across);
      }
    }
    return !group.empty();
  }

  /// The other triangle has edge k too, and lies on its other side on the screen.
  [[nodiscard]] static bool joins(const Shown& own, std::uint32_t k, const Shown& other) {
    if (own.instance != other.instance || (own.item == other.item && own.triangle == other.triangle)) return false;
    const bool is_alike = (own.freedom.area() > 0.0) == (other.freedom.area() > 0.0);
    const Vec3i &from = own.corner[k], &to = own.corner[(k + 1) % 3];
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3i &a = other.corner[j], &b = other.corner[(j + 1) % 3];
      if (is_alike ? a == to && b == from : a == from && b == to) return true;
    }
    return false;
  }

  std::span<const Shown> shown_;
  const draw::VisibilityBuffer& drawn_;
  const draw::VisibilityBuffer& reference_;
};

}  // namespace

Result<Comparison> judge_hardware_pixels(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                                         const draw::VisibilityBuffer& drawn, const run::Camera& camera,
                                         const draw::AlphaMasks& masks, std::uint32_t subpixel_bits) {
  auto projection = draw::make_projection(camera);
  if (!projection) return projection.error();
  projection->far_distance = draw::scene_depth(asset, *projection);
  const auto pages = draw::CutPages::load(asset, cut);
  if (!pages) return pages.error();
  const auto reference = draw::draw_cut(asset, cut, camera, masks);
  if (!reference) return reference.error();

  std::vector<std::vector<Shown>> parts(cut.size());
  parallel_for_each_index(cut.size(), 8, [&](std::size_t i) {
    parts[i] = find_shown(asset, cut[i], static_cast<std::uint32_t>(i), *pages, *projection, masks, subpixel_bits);
  });
  std::vector<Shown> shown;
  for (std::vector<Shown>& part : parts) {
    shown.insert(shown.end(), part.begin(), part.end());
    part = {};
  }
  const std::size_t band_count = (std::size_t{camera.height} + kBandRows - 1) / kBandRows;
  std::vector<std::vector<std::uint32_t>> bands(band_count);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const draw::PixelRange rows = shown[i].freedom.rows();
    for (std::int32_t band = rows.first / kBandRows; band <= rows.last / kBandRows; ++band) {
      bands[static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::vector<Comparison> found(band_count);
  const PictureJudge judge(shown, drawn, *reference);
  parallel_for_each_index(
      band_count, 1, [&](std::size_t band) { judge.judge(static_cast<std::int32_t>(band), bands[band], found[band]); });
  Comparison out;
  for (const Comparison& part : found) {
    out.items += part.items;
    if (out.differences == 0) out.first = part.first;
    out.differences += part.differences;
  }
  return out;
}

Result<Comparison> compare_hardware(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                    double pixel_error, std::uint32_t subpixel_bits) {
  const auto depth = draw::depth_of_scene(asset, camera);
  if (!depth) return depth.error();
  const auto frame = renderer.draw(camera, pixel_error, *depth);
  if (!frame) return frame.error();
  const auto cut = renderer.read_cut();
  if (!cut) return cut.error();
  const auto pixels = renderer.read_pixels_of_cut();
  if (!pixels) return pixels.error();
  auto out = judge_hardware_pixels(asset, *cut, *pixels, camera, *renderer.scene().alpha_masks, subpixel_bits);
  if (!out) return out.error();
  const std::vector<run::ClusterInstance> expected = run::select_flat(asset, camera, pixel_error);
  if (frame->hardware_items != expected.size() || *cut != expected) {
    if (out->differences++ == 0) out->first = "another cut";
  }
  return out;
}

}  // namespace meshlode::judge
