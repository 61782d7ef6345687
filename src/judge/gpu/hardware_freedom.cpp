// SPDX-License-Identifier: GPL-3.0-or-later
// The argument of docs/gpu.md in short. Hardware rasterizes a polygon whose corners are those of the exact one, each
// moved a little: E in clip coordinates, e on the screen. Where the moved polygon covers the sample p, p is a convex
// combination of moved corners; the same combination of the exact ones is a point q of the exact triangle, and |p - q|
// is at most the same combination of the moves. So hardware's depth at p is the exact depth at some q of the triangle
// within reach of p, up to the arithmetic of depth itself; and no edge can cross p that exactly passes farther than
// reach from it.
#include "judge/gpu/hardware_freedom.h"

#include <algorithm>
#include <cmath>

namespace meshlode::judge {

namespace {

using draw::ClipVertex;

constexpr double kE = kFixedFunctionError;
/// Of conversion to binary32, perspective divide, viewport scale and offset.
constexpr double kProjectionOperations = 4.0;
/// Of one clipping plane: t = d0 / (d0 - d1) is off by 4, which moves the new corner along its edge by up to 4 of both
/// ends together, and p0 + t (p1 - p0) adds 3 of them.
constexpr double kClipOperations = 14.0;
/// Setting up and evaluating the plane of depth over the screen.
constexpr double kInterpolationOperations = 8.0;
/// Corners farther out than this are clipped by any device: viewportBoundsRange and a picture's side.
constexpr double kFarthestCorner = 65536.0;
constexpr double kDepthUnits = 4294967296.0;
constexpr double kLargestFloat = 1e36;

struct ClipCorner {
  ClipVertex v;
  int edge = 0;
};

struct ClipPolygon {
  std::array<ClipCorner, TriangleFreedom::kMaxCorners + 1> corners;
  std::size_t count = 0;
};

/// Sutherland and Hodgman, 1974, keeping whose edge is whose.
template <class Distance>
ClipPolygon cut(const ClipPolygon& in, const Distance& distance) {
  ClipPolygon out;
  for (std::size_t i = 0; i < in.count; ++i) {
    const ClipCorner& a = in.corners[i];
    const ClipCorner& b = in.corners[(i + 1) % in.count];
    const double da = distance(a.v), db = distance(b.v);
    if (da >= 0.0) out.corners[out.count++] = a;
    if ((da >= 0.0) == (db >= 0.0)) continue;
    const double t = da / (da - db);
    const ClipVertex v{a.v.x + t * (b.v.x - a.v.x), a.v.y + t * (b.v.y - a.v.y), a.v.z + t * (b.v.z - a.v.z),
                       a.v.w + t * (b.v.w - a.v.w)};
    out.corners[out.count++] = {v, da >= 0.0 ? TriangleFreedom::kCut : a.edge};
  }
  return out;
}

/// Planes of the view volume that some corner is beyond, or so near that rounding may say so.
double count_planes(const std::array<ClipVertex, 3>& v, draw::ImageSize size) {
  const double half_x = 0.5 * size.width, half_y = 0.5 * size.height;
  double count = 0.0;
  const auto add = [&](const auto& distance, const auto& scale) {
    count += std::any_of(v.begin(), v.end(), [&](const ClipVertex& c) { return distance(c) <= 16.0 * kE * scale(c); });
  };
  const auto depth = [](const ClipVertex& c) { return std::abs(c.w) + std::abs(c.z); };
  const auto across = [&](const ClipVertex& c) { return half_x * std::abs(c.w) + std::abs(c.x); };
  const auto down = [&](const ClipVertex& c) { return half_y * std::abs(c.w) + std::abs(c.y); };
  add([](const ClipVertex& c) { return c.w - c.z; }, depth);
  add([](const ClipVertex& c) { return c.z; }, [](const ClipVertex&) { return 0.0; });
  add([&](const ClipVertex& c) { return half_x * c.w - c.x; }, across);
  add([&](const ClipVertex& c) { return half_x * c.w + c.x; }, across);
  add([&](const ClipVertex& c) { return half_y * c.w - c.y; }, down);
  add([&](const ClipVertex& c) { return half_y * c.w + c.y; }, down);
  return count;
}

/// Whether the segment comes into the square around p.
bool meets_square(double ax, double ay, double bx, double by, double px, double py, double reach) {
  double first = 0.0, last = 1.0;
  const double from[2] = {ax - px, ay - py}, along[2] = {bx - ax, by - ay};
  for (int axis = 0; axis < 2; ++axis) {
    for (const double sign : {1.0, -1.0}) {  // sign · (from + t · along) <= reach
      const double room = reach - sign * from[axis], speed = sign * along[axis];
      if (speed > 0.0) {
        last = std::min(last, room / speed);
      } else if (speed < 0.0) {
        first = std::max(first, room / speed);
      } else if (room < 0.0) {
        return false;
      }
    }
  }
  return first <= last;
}

}  // namespace

double TriangleFreedom::Plane::change(double reach) const {
  return (std::abs(a) + std::abs(b)) * reach;
}

TriangleFreedom::TriangleFreedom(const std::array<ClipVertex, 3>& v, draw::ImageSize size,
                                 std::uint32_t subpixel_bits) {
  double x = 0.0;
  for (const ClipVertex& c : v) {
    x = std::max({x, std::abs(c.x), std::abs(c.y)});
    largest_w_ = std::max(largest_w_, std::abs(c.w));
    largest_z_ = std::max(largest_z_, std::abs(c.z));
  }
  if (!(x <= kLargestFloat && largest_w_ <= kLargestFloat && largest_z_ <= kLargestFloat)) return;
  clip(v, size);
  if (count_ == 0) return;
  const double side = std::max(size.width, size.height);
  operations_ = kProjectionOperations + kClipOperations * count_planes(v, size);
  clip_error_ = kE * operations_ * (x + side * largest_w_);
  double low_x = corners_[0].x, high_x = low_x, low_y = corners_[0].y, high_y = low_y;
  for (std::size_t i = 0; i < count_; ++i) {
    low_x = std::min(low_x, corners_[i].x);
    high_x = std::max(high_x, corners_[i].x);
    low_y = std::min(low_y, corners_[i].y);
    high_y = std::max(high_y, corners_[i].y);
    min_z_ = std::min(min_z_, corners_[i].z);
    max_z_ = std::max(max_z_, corners_[i].z);
    max_inverse_w_ = std::max(max_inverse_w_, corners_[i].inverse_w);
  }
  extent_ = std::min(std::max(high_x - low_x, high_y - low_y), kFarthestCorner);
  // A step of the device's grid, whichever way it rounds; the CPU's picture has to be one of those that are allowed.
  const int bits = static_cast<int>(std::min<std::uint32_t>(subpixel_bits, draw::kSubpixelBits));
  interpolation_ = kE * kInterpolationOperations * (extent_ + side);
  snap_ = std::ldexp(1.0, -bits) + interpolation_;
  find_planes();
  find_facing();
  find_bounds(size);
}

void TriangleFreedom::clip(const std::array<ClipVertex, 3>& v, draw::ImageSize size) {
  ClipPolygon polygon;
  for (int k = 0; k < 3; ++k) polygon.corners[static_cast<std::size_t>(k)] = {v[static_cast<std::size_t>(k)], k};
  polygon.count = 3;
  polygon = cut(polygon, [](const ClipVertex& c) { return c.w - c.z; });
  polygon = cut(polygon, [](const ClipVertex& c) { return c.z; });
  if (polygon.count < 3) return;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const auto& [c, edge] = polygon.corners[i];
    if (!(c.w > 0.0)) return;  // cannot be: see ClipVertex
    corners_[i] = {0.5 * size.width + c.x / c.w, 0.5 * size.height + c.y / c.w, std::clamp(c.z / c.w, 0.0, 1.0),
                   1.0 / c.w, edge};
  }
  count_ = polygon.count;
}

void TriangleFreedom::find_planes() {
  area_ = 0.0;
  std::size_t best = 0;
  double best_area = 0.0, extent2 = 0.0;
  const Corner& o = corners_[0];
  for (std::size_t i = 1; i + 1 < count_; ++i) {
    const Corner &b = corners_[i], &c = corners_[i + 1];
    const double area = (b.x - o.x) * (c.y - o.y) - (c.x - o.x) * (b.y - o.y);
    area_ += area;
    if (std::abs(area) > std::abs(best_area)) {
      best = i;
      best_area = area;
    }
    for (const Corner* p : {&b, &c}) {
      extent2 = std::max(extent2, (p->x - o.x) * (p->x - o.x) + (p->y - o.y) * (p->y - o.y));
    }
  }
  has_planes_ = std::abs(best_area) > 1e-9 * extent2;
  if (!has_planes_) return;
  const Corner &b = corners_[best], &c = corners_[best + 1];
  const auto plane = [&](double vo, double vb, double vc) {
    Plane out;
    out.a = ((vb - vo) * (c.y - o.y) - (vc - vo) * (b.y - o.y)) / best_area;
    out.b = ((vc - vo) * (b.x - o.x) - (vb - vo) * (c.x - o.x)) / best_area;
    out.c = vo - out.a * o.x - out.b * o.y;
    return out;
  };
  z_ = plane(o.z, b.z, c.z);
  inverse_w_ = plane(o.inverse_w, b.inverse_w, c.inverse_w);
}

void TriangleFreedom::find_facing() {
  double room = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Corner &before = corners_[(i + count_ - 1) % count_], &at = corners_[i], &after = corners_[(i + 1) % count_];
    const double move = snap_ + clip_error_ * at.inverse_w, next = snap_ + clip_error_ * after.inverse_w;
    room += move * (std::abs(after.x - before.x) + std::abs(after.y - before.y)) + 2.0 * move * next;
  }
  is_facing_open_ = !(std::abs(area_) > room);
  // Barycentric coordinates are quotients by the area of what was rounded, a difference of products of lengths.
  if (!is_facing_open_) {
    weight_error_ = std::min(1.0, kE * kInterpolationOperations * extent_ * extent_ / (std::abs(area_) - room));
  }
}

void TriangleFreedom::find_bounds(draw::ImageSize size) {
  double low_x = corners_[0].x, high_x = low_x, low_y = corners_[0].y, high_y = low_y, reach = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Corner& c = corners_[i];
    const double r = snap_ + clip_error_ * c.inverse_w;
    low_x = std::min(low_x, c.x);
    high_x = std::max(high_x, c.x);
    low_y = std::min(low_y, c.y);
    high_y = std::max(high_y, c.y);
    reach = std::max(reach, r);
  }
  const auto range = [&](double low, double high, std::uint32_t count) {
    const double side = count;
    const double first = std::clamp(std::ceil(low - reach - 0.5), 0.0, side);
    const double last = std::clamp(std::floor(high + reach - 0.5), -1.0, side - 1.0);
    return draw::PixelRange{static_cast<std::int32_t>(first), static_cast<std::int32_t>(last)};
  };
  columns_ = range(low_x, high_x, size.width);
  rows_ = range(low_y, high_y, size.height);
}

/// |p - q| <= snap + clip_error · (1 / w at q), and 1 / w at q is at most what it is at p and its change between them.
double TriangleFreedom::reach_at(double x, double y) const {
  const double most = snap_ + clip_error_ * max_inverse_w_;
  if (!has_planes_) return most;
  const double share = 1.0 - clip_error_ * inverse_w_.change(1.0);
  return share > 0.0 ? std::min(most, (snap_ + clip_error_ * inverse_w_.at(x, y)) / share) : most;
}

std::optional<TriangleFreedom::Sample> TriangleFreedom::at(std::int32_t pixel_x, std::int32_t pixel_y) const {
  const double px = pixel_x + 0.5, py = pixel_y + 0.5;
  Sample out;
  out.reach = reach_at(px, py);
  if (count_ == 0 || !(out.reach >= 0.0)) return std::nullopt;
  // Inside every edge by more than the reach, or outside one.
  const double sign = area_ > 0.0 ? 1.0 : -1.0;
  bool is_inside = has_planes_ && !is_facing_open_;
  for (std::size_t i = 0; i < count_; ++i) {
    const Corner &a = corners_[i], &b = corners_[(i + 1) % count_];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double distance = sign * (dx * (py - a.y) - dy * (px - a.x)),
                 width = out.reach * (std::abs(dx) + std::abs(dy));
    is_inside = is_inside && distance > width;
    if (has_planes_ && distance < -width) return std::nullopt;
  }
  double low = 1e300, high = -1e300;
  if (is_inside) {
    const double z = z_.at(px, py), change = z_.change(out.reach);
    low = z - change;
    high = z + change;
    out.is_certain = true;
  } else {
    // The part of the triangle within the square, corner by corner: depths there are convex combinations of corners'.
    std::array<Corner, kMaxCorners + 5> part{}, next{};
    std::copy_n(corners_.begin(), count_, part.begin());
    std::size_t count = count_;
    for (int side = 0; side < 4 && count > 0; ++side) {
      const auto room = [&](const Corner& c) {
        const double offset = side < 2 ? c.x - px : c.y - py;
        return out.reach - (side % 2 == 0 ? offset : -offset);
      };
      std::size_t kept = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const Corner &a = part[i], &b = part[(i + 1) % count];
        const double da = room(a), db = room(b);
        if (da >= 0.0) next[kept++] = a;
        if ((da >= 0.0) == (db >= 0.0)) continue;
        const double t = da / (da - db);
        next[kept++] = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z),
                        a.inverse_w + t * (b.inverse_w - a.inverse_w), 0};
      }
      part = next;
      count = kept;
    }
    if (count == 0) return std::nullopt;
    for (std::size_t i = 0; i < count; ++i) {
      low = std::min(low, part[i].z);
      high = std::max(high, part[i].z);
    }
  }
  const double vague = weight_error_ * (max_z_ - min_z_);
  low = std::max(low - vague, std::min(low, min_z_));
  high = std::min(high + vague, std::max(high, max_z_));
  // Barycentric coordinates may be those of the corners before they were rounded: the plane's own depth at p, which
  // lies beyond the triangle where rounding alone has made it cover p.
  if (!is_inside && has_planes_) {
    const double z = z_.at(px, py), change = z_.change(interpolation_) + vague;
    low = std::min(low, z - change);
    high = std::max(high, z + change);
  }
  // What clip coordinates are off moves z / w too; then interpolation, relative to the largest depth that it sees.
  const double inverse_w =
      std::min(max_inverse_w_,
               has_planes_ ? std::max(inverse_w_.at(px, py), 0.0) + inverse_w_.change(out.reach) : max_inverse_w_);
  const double error = kE * operations_ * inverse_w * (largest_z_ + std::max(high, 0.0) * largest_w_) +
                       kE * kInterpolationOperations * max_z_;
  // Shaders write at most 1 - 2^-24, cut down to a unit.
  out.low = std::min(std::max(low - error, 0.0), 1.0 - 0x1p-24) * kDepthUnits - 2.0;
  out.high = std::min(high + error, 1.0) * kDepthUnits + 2.0;
  return out;
}

std::uint32_t TriangleFreedom::edges_near(std::int32_t pixel_x, std::int32_t pixel_y, double reach) const {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Corner &a = corners_[i], &b = corners_[(i + 1) % count_];
    if (!meets_square(a.x, a.y, b.x, b.y, pixel_x + 0.5, pixel_y + 0.5, reach)) continue;
    out |= a.edge == kCut ? 8u : 1u << static_cast<std::uint32_t>(a.edge);
  }
  return out;
}

}  // namespace meshlode::judge
