// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/layers/find_gaps.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "base/id_table.h"
#include "base/parallel.h"
#include "base/random.h"
#include "builder/gap_label.h"
#include "builder/layers/placed_shapes.h"

namespace meshlode::builder {

namespace {

/// Of a mesh's diagonal. At an error of a wider gap the whole mesh is fifty pixels wide. FlightHelmet shows another
/// surface at 0.026% of its pixels (docs/log/layers.md); a reach of 1/128 missed gaps and had five times the pixels of
/// this one when it was chosen.
constexpr double kWidestReach = 0.02;
/// Of the reach. What is nearer than the grid's step lies in one plane.
constexpr double kLeastGap = 2e-3;
/// Rays: one pair for every square of so much of the diagonal, for every tenth triangle at least, and no more than
/// these for one triangle. A mesh of large triangles has few of them.
constexpr double kSpacing = 0.01, kFewestRays = 0.1, kMostRays = 4.0;
/// Of a mesh of many instances each ray looks around so many.
constexpr std::size_t kPlaces = 2;

/// A triangle that rays start from.
struct Caster {
  TriangleCorners corners{};
  Vec3d normal{0.0};
  double area = 0.0;  ///< in units of the diagonal
  std::uint64_t hash = 0;
};

Caster caster_of(const Shape& shape, std::uint32_t triangle) {
  Caster caster;
  caster.corners = canonical_corners(shape, triangle);
  for (const Vec3d& p : caster.corners) {
    for (int k = 0; k < 3; ++k) {
      caster.hash = hash_word(caster.hash, std::bit_cast<std::uint64_t>(p[k] * shape.per_unit + 0.0));
    }
  }
  const Vec3d e = (caster.corners[1] - caster.corners[0]) * shape.per_unit;
  const Vec3d f = (caster.corners[2] - caster.corners[0]) * shape.per_unit;
  const Vec3d n = glm::cross(e, f);
  const double twice = std::sqrt(glm::dot(n, n)), diagonal = shape.diagonal * shape.per_unit;
  if (!(twice > 0.0)) return caster;
  caster.normal = n / twice;
  caster.area = 0.5 * twice / (diagonal * diagonal);
  return caster;
}

/// Point i of a triangle's: its middle, and then the R2 sequence (Roberts 2018), folded into it.
Vec3d sample_point(const TriangleCorners& corners, std::uint32_t i) {
  double u = 1.0 / 3.0, v = u;
  if (i > 0) {
    u = 0.5 + 0.7548776662466927 * i;
    v = 0.5 + 0.5698402909980532 * i;
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
  }
  return corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
}

class GapFinder {
 public:
  GapFinder(const scene::Scene& scene, std::span<const std::uint8_t> wants, std::span<const std::uint8_t> stands_alone)
      : placed_(scene, stands_alone), gaps_(scene.meshes.size()) {
    for (std::size_t i = 0; i < gaps_.size(); ++i) {
      gaps_[i].reach = kWidestReach * placed_.shape(i).diagonal;
      if (wants[i] != 0) gaps_[i].codes.resize(placed_.shape(i).triangles.size(), 0);
    }
  }

  void cast_from(std::uint32_t mesh) {
    constexpr std::size_t kChunk = 1024;
    parallel_for_each_chunk(placed_.shape(mesh).triangles.size(), kChunk,
                            [&](std::size_t, std::size_t begin, std::size_t end) {
                              for (std::size_t t = begin; t < end; ++t) cast(mesh, static_cast<std::uint32_t>(t));
                            });
  }

  std::vector<MeshGaps> take() {
    for (std::size_t mesh = 0; mesh < gaps_.size(); ++mesh) {
      MeshGaps& gaps = gaps_[mesh];
      // What lies under another surface is seen neither from there nor, one-sided, from behind: it need not keep above
      // what is below it, and so has a side to move to.
      for (std::uint32_t t = 0; t < gaps.codes.size(); ++t) {
        const GapPair pair = GapPair::of_byte(gaps.codes[t]);
        if (pair.above != 0 && !placed_.shape(mesh).faces_both_ways(t)) gaps.codes[t] = GapPair{pair.above, 0}.byte();
      }
      const bool has_some =
          std::any_of(gaps.codes.begin(), gaps.codes.end(), [](std::uint8_t code) { return code != 0; });
      if (!has_some) gaps.codes = {};
    }
    return std::move(gaps_);
  }

 private:
  void cast(std::uint32_t mesh, std::uint32_t triangle) {
    const Shape& shape = placed_.shape(mesh);
    const Caster caster = caster_of(shape, triangle);
    if (!(caster.area > 0.0)) return;
    SplitMix64 random(caster.hash);
    const double due = std::clamp(caster.area / (kSpacing * kSpacing), kFewestRays, kMostRays) + random.unit();
    const bool is_asked = !gaps_[mesh].codes.empty();
    const std::size_t places = placed_.place_count(mesh);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(due); ++i) {
      const Vec3d from = sample_point(caster.corners, i);
      const std::uint64_t first = places == 0 ? 0 : random.below(places);
      const LayerRay ray{from,
                         caster.normal * gaps_[mesh].reach,
                         caster.normal,
                         shape.faces_both_ways(triangle),
                         kLeastGap,
                         mesh,
                         shape.look_of(triangle)};
      LayerHits hits;
      if (is_asked) placed_.meet_itself(mesh, ray, hits);
      for (std::size_t k = 0; k < std::min(kPlaces, places) && !hits.is_crowded; ++k) {
        placed_.meet_others(mesh, (first + k) % places, ray, hits);
      }
      if (hits.is_crowded) return;
      for (const LayerHit* hit : {&hits.ahead, &hits.behind}) {
        if (hit->mesh == kNoId) continue;
        mark(mesh, triangle, hit->at * gaps_[mesh].reach, hit == &hits.ahead);
        mark(hit->mesh, hit->triangle, hit->gap, hit->is_from_above);
      }
    }
  }

  /// The narrowest gap of those that are found counts, whoever finds it first.
  void mark(std::uint32_t mesh, std::uint32_t triangle, double gap, bool is_above) {
    MeshGaps& gaps = gaps_[mesh];
    if (gaps.codes.empty()) return;
    const std::uint32_t code = code_of_gap(gap, gaps.reach);
    const GapPair found = is_above ? GapPair{code, 0} : GapPair{0, code};
    const std::atomic_ref<std::uint8_t> kept(gaps.codes[triangle]);
    std::uint8_t before = kept.load(std::memory_order_relaxed), after = 0;
    do {
      GapPair both = GapPair::of_byte(before);
      both.narrow(found);
      after = both.byte();
    } while (after != before && !kept.compare_exchange_weak(before, after, std::memory_order_relaxed));
  }

  PlacedShapes placed_;
  std::vector<MeshGaps> gaps_;
};

}  // namespace

GapSummary summarize(const MeshGaps& gaps) {
  constexpr std::size_t kMostListed = 16;
  GapSummary out;
  std::uint32_t widest = kNarrowestGap, narrowest = 1;
  for (std::uint32_t t = 0; t < gaps.codes.size(); ++t) {
    if (gaps.codes[t] == 0) continue;
    ++out.triangles;
    const GapPair pair = GapPair::of_byte(gaps.codes[t]);
    for (const std::uint32_t code : {pair.above, pair.below}) {
      if (code == 0) continue;
      widest = std::min(widest, code);
      narrowest = std::max(narrowest, code);
    }
    if (out.first.size() < kMostListed) out.first.push_back(t);
  }
  if (out.triangles == 0) return out;
  out.narrowest = gap_of_code(narrowest, gaps.reach);
  out.widest = gap_of_code(widest, gaps.reach);
  return out;
}

std::vector<MeshGaps> find_gaps(const scene::Scene& scene, std::span<const std::uint8_t> wants) {
  const bool any = std::any_of(wants.begin(), wants.end(), [](std::uint8_t want) { return want != 0; });
  // A label has no room for more materials.
  const bool has_too_many = scene.materials.size() > kMaterialBits;
  const bool is_plain = scene.meshes.size() == 1 && plain_look(scene.meshes[0], scene.materials) != kNoId;
  if (!any || is_plain || has_too_many) return std::vector<MeshGaps>(scene.meshes.size());
  std::vector<std::uint8_t> stands_alone(scene.meshes.size(), 0);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) stands_alone[i] = scene.meshes[i].is_deformed ? 1 : 0;
  GapFinder finder(scene, wants, stands_alone);
  for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) finder.cast_from(mesh);
  return finder.take();
}

}  // namespace meshlode::builder
