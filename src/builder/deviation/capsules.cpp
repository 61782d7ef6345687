// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/capsules.h"

#include <algorithm>
#include <vector>

namespace meshlode::builder {

namespace {

// A distance in the tree's frame, where the surface's coordinates are below one: differences, products and the root
// lose less than 16 times 2^-24 of the distance and of one. Whoever is outside by less than that is not passed over.
constexpr float kAllowance = 0x1p-19F;

float distance_to_segment(const Vec3f& p, const Vec3f& from, const Vec3f& along) {
  const Vec3f away = p - from;
  const float length2 = glm::dot(along, along);
  const float t = length2 > 0.0F ? std::clamp(glm::dot(away, along) / length2, 0.0F, 1.0F) : 0.0F;
  const Vec3f rest = away - along * t;
  return std::sqrt(glm::dot(rest, rest));
}

/// The sum of segments that have no direction: each is turned to go with the first.
class MeanSegment {
 public:
  void add(const Vec3f& from, const Vec3f& to) {
    const bool is_against = count_ > 0.0F && glm::dot(to - from, to_ - from_) < 0.0F;
    from_ += is_against ? to : from;
    to_ += is_against ? from : to;
    count_ += 1.0F;
  }
  [[nodiscard]] Capsule thin() const {
    const Vec3f from = from_ / count_;
    return {from, to_ / count_ - from, 0.0F};
  }

 private:
  Vec3f from_{0.0F}, to_{0.0F};
  float count_ = 0.0F;
};

}  // namespace

bool has_hub(std::span<const std::array<std::uint32_t, 3>> triangles, std::size_t position_count) {
  if (triangles.size() < kHubTriangles) return false;
  std::vector<std::uint32_t> uses(position_count, 0);
  for (const auto& t : triangles) {
    for (const std::uint32_t corner : t) {
      if (++uses[corner] >= kHubTriangles) return true;
    }
  }
  return false;
}

Capsule capsule_around(std::span<const std::array<Vec3f, 3>> triangles) {
  MeanSegment mean;
  for (const auto& corners : triangles) {
    std::size_t longest = 0;
    float longest2 = -1.0F;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f edge = corners[(k + 1) % 3] - corners[k];
      if (glm::dot(edge, edge) > longest2) {
        longest2 = glm::dot(edge, edge);
        longest = k;
      }
    }
    mean.add(corners[longest], corners[(longest + 1) % 3]);
  }
  Capsule capsule = mean.thin();
  for (const auto& corners : triangles) {
    for (const Vec3f& p : corners) {
      // The distance to a segment is convex: what holds the corners holds what is between them.
      capsule.radius = std::max(capsule.radius, distance_to_segment(p, capsule.from, capsule.along) + kAllowance);
    }
  }
  return capsule;
}

Capsule capsule_around(std::span<const Capsule> capsules) {
  MeanSegment mean;
  for (const Capsule& inner : capsules) {
    if (!inner.is_empty()) mean.add(inner.from, inner.from + inner.along);
  }
  Capsule capsule = mean.thin();
  for (const Capsule& inner : capsules) {
    if (inner.is_empty()) continue;
    for (const Vec3f& end : {inner.from, inner.from + inner.along}) {
      capsule.radius =
          std::max(capsule.radius, distance_to_segment(end, capsule.from, capsule.along) + inner.radius + kAllowance);
    }
  }
  return capsule;
}

Lanes distances2_to_capsules(const FourCapsules& four, const Vec3f& point) {
  const auto load = [](const std::array<float, 4>& from) { return load_lanes(from.data()); };
  const Lanes ax = load(four.along[0]), ay = load(four.along[1]), az = load(four.along[2]);
  const Lanes px = lanes(point.x) - load(four.from[0]), py = lanes(point.y) - load(four.from[1]),
              pz = lanes(point.z) - load(four.from[2]);
  const Lanes length2 = max_lanes(ax * ax + ay * ay + az * az, lanes(1e-35F));
  const Lanes t = min_lanes(max_lanes((px * ax + py * ay + pz * az) / length2, lanes(0.0F)), lanes(1.0F));
  const Lanes x = px - ax * t, y = py - ay * t, z = pz - az * t;
  const Lanes away2 = x * x + y * y + z * z;
  Lanes away;
  for (int k = 0; k < 4; ++k) away[k] = std::sqrt(away2[k]);
  const Lanes outside = max_lanes(away * lanes(1.0F - kAllowance) - load(four.radius), lanes(0.0F));
  return outside * outside;
}

}  // namespace meshlode::builder
