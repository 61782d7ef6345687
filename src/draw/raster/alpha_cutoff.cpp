// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/alpha_cutoff.h"

#include <algorithm>
#include <cmath>

#include "draw/textures/texture_image.h"

namespace meshlode::draw {

namespace {

constexpr double kLargestQuotient = 70368744177664.0;  ///< 2^46: the quotient of doubles is off by less than 1
/// Weights below this count as 0, so that nobody's rounding of denormals matters; sums must be well above.
constexpr double kLeastWeight = 1e-280, kLeastSum = 1e-260, kLargestSum = 1e250;

double weigh(const double (&weight)[3], double a, double b, double c) {
  return (weight[0] * a + weight[1] * b) + weight[2] * c;
}

/// Of the three corners; their sum is positive.
void find_weights(const MaskedTriangle& t, double px, double py, double (&weight)[3]) {
  double x[3], y[3];
  for (std::size_t k = 0; k < 3; ++k) {
    x[k] = t.x[k] - px * t.w[k];
    y[k] = t.y[k] - py * t.w[k];
  }
  weight[0] = x[1] * y[2] - x[2] * y[1];
  weight[1] = x[2] * y[0] - x[0] * y[2];
  weight[2] = x[0] * y[1] - x[1] * y[0];
  const bool is_back = (weight[0] + weight[1]) + weight[2] < 0.0;
  for (double& w : weight) {
    if (is_back) w = -w;
    if (!(w >= kLeastWeight)) w = 0.0;  // snapping moves edges by parts of a pixel
  }
  const double sum = (weight[0] + weight[1]) + weight[2];
  if (!(sum >= kLeastSum && sum <= kLargestSum)) weight[0] = weight[1] = weight[2] = 1.0;
}

}  // namespace

std::int64_t floor_quotient(double value, double divisor) {
  if (!(std::abs(value) <= kLargestQuotient * divisor)) return 0;
  double q = std::floor(value / divisor);
  while (q * divisor > value) q -= 1.0;
  while ((q + 1.0) * divisor <= value) q += 1.0;
  return static_cast<std::int64_t>(q);
}

std::optional<MaskedTriangle> find_mask(const AlphaMasks& masks, const format::MeshRecord& mesh,
                                        const run::DecodedCluster& cluster, std::uint32_t triangle,
                                        const GridToClip& to_clip) {
  if (masks.is_empty()) return std::nullopt;
  const std::uint32_t index = masks.of_material[cluster.triangle_material[triangle]];
  if (index == format::kNone) return std::nullopt;
  MaskedTriangle out;
  out.mask = &masks.masks[index];
  std::uint32_t stored_set = mesh.uv_set_count;
  for (std::uint32_t set = mesh.uv_set_count; set-- > 0;) {
    if (mesh.uv_set_source[set] == out.mask->uv_set) stored_set = set;
  }
  const bool has_image = out.mask->image != format::kNone && stored_set < mesh.uv_set_count;
  if (has_image) {
    out.image = &masks.images[out.mask->image];
    out.uv_log2 = mesh.uv_log2[stored_set];
  }
  const std::uint32_t uv_channel = 3U + (mesh.normal_mode == format::NormalMode::kStored ? 3U : 0U) + 2U * stored_set;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = cluster.triangles[triangle][k];
    const ClipVertex clip = to_clip.project(cluster.position(vertex));
    out.x[k] = clip.x;
    out.y[k] = clip.y;
    out.w[k] = clip.w;
    const std::int32_t* channels = &cluster.channels[std::size_t{vertex} * cluster.channel_count];
    if (has_image) {
      out.u[k] = channels[uv_channel];
      out.v[k] = channels[uv_channel + 1];
    }
    if (mesh.has_color != 0) out.alpha[k] = static_cast<std::uint8_t>(channels[cluster.channel_count - 1]);
  }
  return out;
}

bool passes_alpha(const MaskedTriangle& t, double px, double py) {
  double weight[3];
  find_weights(t, px, py, weight);
  const double sum = (weight[0] + weight[1]) + weight[2];
  const double alpha = weigh(weight, t.alpha[0], t.alpha[1], t.alpha[2]);
  const std::int64_t vertex_alpha = std::clamp<std::int64_t>(floor_quotient(alpha + 0.5 * sum, sum), 0, 255);
  if (t.image == nullptr) return 255 * vertex_alpha >= t.mask->threshold;
  const double unit = std::ldexp(1.0, t.uv_log2);
  const double u = weigh(weight, t.u[0], t.u[1], t.u[2]), v = weigh(weight, t.v[0], t.v[1], t.v[2]);
  const auto texel = [&](const std::array<double, 3>& row, std::uint32_t count, Wrap wrap) {
    const double at = (row[0] * unit * u + row[1] * unit * v) + row[2] * sum;
    return wrap_texel(floor_quotient(at, sum), count, wrap);
  };
  const std::size_t x = texel(t.mask->row_u, t.image->width, t.mask->wrap[0]);
  const std::size_t y = texel(t.mask->row_v, t.image->height, t.mask->wrap[1]);
  return t.image->texels[y * t.image->width + x] * vertex_alpha >= t.mask->threshold;
}

}  // namespace meshlode::draw
