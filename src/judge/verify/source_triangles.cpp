// SPDX-License-Identifier: GPL-3.0-or-later
// I1: every source triangle is in exactly one level-0 cluster. The source is quantized here once more and both sides
// are sorted by (material, corners on the grid): equal keys must occur equally often, after what may be dropped (exact
// degenerates and exact duplicates) was found from the source alone. Every exact position has one point on the grid:
// the one nearest to it, or the one that the writer's rule for needles gives it (moved_vertices.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <string>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/parallel.h"
#include "format/grid.h"
#include "judge/metrics/drawn_triangles.h"
#include "judge/metrics/triangle_corners.h"
#include "judge/verify/locked_borders.h"
#include "judge/verify/moved_vertices.h"
#include "judge/verify/source_rules.h"
#include "judge/verify/triangle_key.h"

namespace meshlode::judge {

namespace {

/// Beyond this many different triangles on one place of the grid, their attributes are not told apart.
constexpr std::size_t kMaxClassesCompared = 1024;

struct Corner {
  Vec3d position{0.0};
  std::array<float, 3 + 2 * scene::kMaxUvSets + 4>
      attributes{};  ///< normal, uv sets, colour: those that the asset stores
  auto operator<=>(const Corner& other) const {
    for (int i = 0; i < 3; ++i) {
      if (const auto order = position[i] <=> other.position[i]; order != 0) return order;
    }
    for (std::size_t i = 0; i < attributes.size(); ++i) {
      if (const auto order = attributes[i] <=> other.attributes[i]; order != 0) return order;
    }
    return std::partial_ordering::equivalent;
  }
  bool operator==(const Corner& other) const { return (*this <=> other) == 0; }
};

using ExactTriangle = std::array<Corner, 3>;

/// A triangle of the source.
struct SourcePlace {
  std::uint32_t primitive, triangle;
};
/// A triangle of level 0.
struct StoredPlace {
  std::uint32_t cluster, triangle;
};

struct SourceTriangle {
  TriangleKey key;
  SourcePlace place;
};
struct StoredTriangle {
  TriangleKey key;
  StoredPlace place;
};

/// Keys are six times as large as places: they are made for one range of keys at a time, in so many ranges.
constexpr std::size_t kRanges = 16;
/// Triangles of level 0 that the ranges are chosen by.
constexpr std::size_t kRangeSamples = 4096;

class SourceMatcher {
 public:
  SourceMatcher(const run::Asset& asset, MeshId mesh, const scene::SourceMesh& source,
                std::span<const run::DecodedCluster> clusters, RuleLog& log)
      : asset_(asset),
        mesh_id_(mesh),
        mesh_(asset.meshes()[mesh.value]),
        source_(source),
        clusters_(clusters),
        log_(log),
        step_(format::exp2_exact(mesh_.grid.log2) * mesh_.grid.mantissa),
        origin_(mesh_.origin[0], mesh_.origin[1], mesh_.origin[2]),
        vertices_(origin_, step_) {}

  SourceCounts run(bool wants_border) {
    check_counts();
    gather_source();
    gather_stored();
    choose_ranges();
    find_moved();
    check_moves();
    match();
    check_dropped();
    if (wants_border) {
      for (const Vec3d& p : find_open_border(source_corners())) counts_.border.push_back(vertices_.point_of(p));
    }
    return std::move(counts_);
  }

 private:
  [[nodiscard]] std::string where() const { return place("mesh", mesh_id_.value); }
  [[nodiscard]] bool stores_normals() const { return mesh_.normal_mode == format::NormalMode::kStored; }

  void check_counts() {
    std::uint64_t triangles = source_.drops.repaired;
    std::uint64_t vertices = 0;
    for (const scene::Primitive& primitive : source_.primitives) {
      triangles += primitive.indices.size() / 3;
      vertices += primitive.positions.size();
    }
    const auto at = [&] { return where(); };
    log_.expect(mesh_.source_triangles == triangles, Rule::kV103, at,
                [&] { return differs("source_triangles", mesh_.source_triangles, "source", triangles); });
    log_.expect(mesh_.source_vertices == vertices, Rule::kV103, at,
                [&] { return differs("source_vertices", mesh_.source_vertices, "source", vertices); });
    log_.expect(asset_.string(mesh_.name) == source_.name, Rule::kV103, at,
                [&] { return "name is not \"" + source_.name + "\""; });
    log_.expect(mesh_.dropped_repaired == source_.drops.repaired, Rule::kV102, at, [&] {
      return differs("dropped_repaired", mesh_.dropped_repaired, "repaired by import", source_.drops.repaired);
    });
  }

  void gather_source() {
    std::size_t count = 0;
    for (const scene::Primitive& primitive : source_.primitives) count += primitive.indices.size() / 3;
    sources_.reserve(count);
    for (std::uint32_t p = 0; p < source_.primitives.size(); ++p) {
      for (std::uint32_t t = 0; t < source_.primitives[p].indices.size() / 3; ++t) sources_.push_back({p, t});
    }
    const std::vector<std::uint8_t> is_drawn = find_drawn(source_corners());
    Box3d box;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (is_drawn[i] == 0) continue;
      sources_[kept++] = sources_[i];
      for (const Vec3d& corner : corners_of(sources_[kept - 1])) box.add(corner);
    }
    degenerate_ = sources_.size() - kept;
    sources_.resize(kept);
    counts_.source_triangles = sources_.size();
    const auto at = [&] { return where(); };
    const double diagonal = kept > 0 ? std::sqrt(glm::dot(box.size(), box.size())) : 0.0;
    log_.expect(std::fabs(mesh_.diagonal - diagonal) <= 1e-9 * diagonal, Rule::kV103, at,
                [&] { return differs("diagonal", mesh_.diagonal, "source", diagonal); });
  }

  [[nodiscard]] TriangleCorners source_corners() const {
    return {sources_.size(), [this](std::size_t i) { return corners_of(sources_[i]); }};
  }

  [[nodiscard]] std::array<Vec3d, 3> corners_of(const SourcePlace& s) const {
    const scene::Primitive& primitive = source_.primitives[s.primitive];
    const std::uint32_t* index = &primitive.indices[3 * std::size_t{s.triangle}];
    return {primitive.positions[index[0]], primitive.positions[index[1]], primitive.positions[index[2]]};
  }

  /// Where the points nearest to the source's vertices do not explain level 0, the vertices that the writer moves do,
  /// or explain more of it.
  void find_moved() {
    const std::size_t unexplained = count_unexplained();
    if (unexplained == 0) return;
    MovedVertices nearest = std::exchange(vertices_, MovedVertices(origin_, step_));
    vertices_.find(source_corners());
    if (vertices_.empty()) return;
    deal_sources();
    if (count_unexplained() <= unexplained) return;
    vertices_ = std::move(nearest);
    deal_sources();
  }

  /// Calls visit(key, of the source, of level 0) for each distinct triangle on the grid, in the order of keys.
  template <class Visit>
  void for_each_key(const Visit& visit) const {
    std::vector<SourceTriangle> sources;
    std::vector<StoredTriangle> stored;
    for (std::size_t range = 0; range <= range_ends_.size(); ++range) {
      gather_range(sources_, source_range_, range, sources);
      gather_range(stored_, stored_range_, range, stored);
      for (std::size_t i = 0, j = 0; i < sources.size() || j < stored.size();) {
        const bool take_source = j == stored.size() || (i < sources.size() && sources[i].key <= stored[j].key);
        const TriangleKey key = take_source ? sources[i].key : stored[j].key;
        const std::size_t i0 = i;
        const std::size_t j0 = j;
        while (i < sources.size() && sources[i].key == key) ++i;
        while (j < stored.size() && stored[j].key == key) ++j;
        visit(key, std::span(sources).subspan(i0, i - i0), std::span(stored).subspan(j0, j - j0));
      }
    }
  }

  /// The triangles of a range with their keys, sorted; equal ones by their places, which ascend.
  template <class Place, class Triangle>
  void gather_range(const std::vector<Place>& places, const std::vector<std::uint8_t>& range_of, std::size_t range,
                    std::vector<Triangle>& out) const {
    out.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (range_of[i] == range) out.push_back({key_of(places[i]), places[i]});
    }
    std::stable_sort(out.begin(), out.end(), [](const Triangle& a, const Triangle& b) { return a.key < b.key; });
  }

  [[nodiscard]] std::uint8_t range_of(const TriangleKey& key) const {
    return static_cast<std::uint8_t>(std::upper_bound(range_ends_.begin(), range_ends_.end(), key) -
                                     range_ends_.begin());
  }

  void choose_ranges() {
    std::vector<TriangleKey> keys;
    const std::size_t step = std::max<std::size_t>(1, stored_.size() / kRangeSamples);
    for (std::size_t i = 0; i < stored_.size(); i += step) keys.push_back(key_of(stored_[i]));
    std::sort(keys.begin(), keys.end());
    if (step > 1) {
      for (std::size_t k = 1; k < kRanges; ++k) range_ends_.push_back(keys[k * keys.size() / kRanges]);
    }
    stored_range_.resize(stored_.size());
    for (std::size_t i = 0; i < stored_.size(); ++i) stored_range_[i] = range_of(key_of(stored_[i]));
    deal_sources();
  }

  /// Into ranges, by where the vertices are on the grid.
  void deal_sources() {
    source_range_.resize(sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i) source_range_[i] = range_of(key_of(sources_[i]));
  }

  /// Distinct triangles on the grid that only the source or only level 0 has. How often each is there need not be
  /// compared: a moved vertex goes to a point that is nearest to no other, so its triangles are unknown as long as it
  /// is not found.
  [[nodiscard]] std::size_t count_unexplained() const {
    std::size_t count = 0;
    for_each_key([&](const TriangleKey&, std::span<const SourceTriangle> sources,
                     std::span<const StoredTriangle> stored) { count += sources.empty() || stored.empty() ? 1 : 0; });
    return count;
  }

  [[nodiscard]] TriangleKey key_of(const SourcePlace& s) const {
    const std::array<Vec3d, 3> corner = corners_of(s);
    return {source_.primitives[s.primitive].material.value,
            rotate_to_smallest(
                {vertices_.point_of(corner[0]), vertices_.point_of(corner[1]), vertices_.point_of(corner[2])})};
  }

  [[nodiscard]] TriangleKey key_of(const StoredPlace& s) const {
    const run::DecodedCluster& cluster = clusters_[s.cluster];
    GridCorners grid{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3i p = cluster.position(cluster.triangles[s.triangle][k]);
      grid[k] = {p.x, p.y, p.z};
    }
    return {cluster.triangle_material[s.triangle], rotate_to_smallest(grid)};
  }

  void check_moves() {
    double moved2 = 0.0;
    for (const SourcePlace& s : sources_) {
      for (const Vec3d& p : corners_of(s)) {
        const GridPoint q = vertices_.point_of(p);
        const Vec3d moved = Vec3d(q[0], q[1], q[2]) * step_ - (p - origin_);
        moved2 = std::max(moved2, glm::dot(moved, moved));
      }
    }
    const double moved = std::sqrt(moved2);
    const double stored = mesh_.level0_deviation;  // a float, rounded up
    log_.expect(
        stored >= moved * (1.0 - 1e-12) && stored <= moved * (1.0 + 0x1p-22) + 0x1p-148, Rule::kV105,
        [&] { return where(); },
        [&] { return differs("level0_deviation", double{mesh_.level0_deviation}, "largest move of a vertex", moved); });
  }

  void gather_stored() {
    for (std::uint32_t c = mesh_.first_cluster; c < mesh_.first_cluster + mesh_.cluster_count; ++c) {
      if (asset_.clusters()[c].own_group != format::kNone) continue;
      for (std::uint32_t t = 0; t < clusters_[c].triangles.size(); ++t) stored_.push_back({c, t});
    }
    counts_.level0_triangles = stored_.size();
  }

  /// The source's corner with the attributes that the asset stores, as prepared: -0 is 0, missing ones have defaults.
  [[nodiscard]] Corner exact_corner(const scene::Primitive& primitive, std::uint32_t vertex,
                                    const Vec3f& flat_normal) const {
    Corner corner;
    corner.position = primitive.positions[vertex] + 0.0;
    std::size_t slot = 0;
    const auto put = [&](float value) { corner.attributes[slot++] = value == 0.0F ? 0.0F : value; };
    if (stores_normals()) {
      const Vec3f n = primitive.normals.empty() ? flat_normal : primitive.normals[vertex];
      for (int i = 0; i < 3; ++i) put(n[i]);
    }
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      const auto& uvs = primitive.uvs[mesh_.uv_set_source[set]];
      const Vec2f uv = uvs.empty() ? Vec2f(0.0F) : uvs[vertex];
      put(uv.x);
      put(uv.y);
    }
    if (mesh_.has_color != 0) {
      const Vec4f color = primitive.colors.empty() ? Vec4f(1.0F) : primitive.colors[vertex];
      for (int i = 0; i < 4; ++i) put(color[i]);
    }
    return corner;
  }

  [[nodiscard]] ExactTriangle exact_triangle(const SourcePlace& triangle) const {
    const scene::Primitive& primitive = source_.primitives[triangle.primitive];
    const std::uint32_t* index = &primitive.indices[3 * std::size_t{triangle.triangle}];
    const Vec3d a = primitive.positions[index[0]];
    const Vec3d b = primitive.positions[index[1]];
    const Vec3d c = primitive.positions[index[2]];
    const Vec3d cross = glm::cross(b - a, c - a);
    const double length = std::sqrt(glm::dot(cross, cross));
    const Vec3f flat = length > 0.0 && std::isfinite(length) ? Vec3f(cross / length) : Vec3f(0.0F);
    ExactTriangle out{exact_corner(primitive, index[0], flat), exact_corner(primitive, index[1], flat),
                      exact_corner(primitive, index[2], flat)};
    std::rotate(
        out.begin(),
        std::min_element(out.begin(), out.end(), [](const Corner& x, const Corner& y) { return (x <=> y) < 0; }),
        out.end());
    return out;
  }

  /// Triangles of one key that are the same thing: kept once.
  struct SourceClass {
    ExactTriangle triangle;
    std::uint64_t count = 0;
    bool has_own_normals = true;  ///< computed ones may differ in a bit between rotations, so copies may stay apart
  };

  [[nodiscard]] std::vector<SourceClass> classes_of(std::span<const SourceTriangle> sources) const {
    std::vector<SourceClass> all;
    for (const SourceTriangle& s : sources) {
      SourceClass one;
      one.triangle = exact_triangle(s.place);
      one.count = 1;
      one.has_own_normals = !stores_normals() || !source_.primitives[s.place.primitive].normals.empty();
      all.push_back(std::move(one));
    }
    if (all.size() == 1) return all;
    std::sort(all.begin(), all.end(), [](const SourceClass& a, const SourceClass& b) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (const auto order = a.triangle[k] <=> b.triangle[k]; order != 0) return order < 0;
      }
      return false;
    });
    std::vector<SourceClass> classes;
    for (SourceClass& one : all) {
      if (!classes.empty() && classes.back().triangle == one.triangle) {
        ++classes.back().count;
        classes.back().has_own_normals = classes.back().has_own_normals && one.has_own_normals;
      } else {
        classes.push_back(std::move(one));
      }
    }
    return classes;
  }

  void match() {
    log_.check(Rule::kV101);
    log_.check(Rule::kV104);
    for_each_key([&](const TriangleKey& key, std::span<const SourceTriangle> sources,
                     std::span<const StoredTriangle> stored) { match_key(key, sources, stored); });
  }

  [[nodiscard]] std::string key_text(const TriangleKey& key) const {
    std::string text = where() + ", triangle";
    for (const auto& c : key.corners) {
      text += " (" + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) + ")";
    }
    return text + " of " + place("material", key.material);
  }

  void match_key(const TriangleKey& key, std::span<const SourceTriangle> sources,
                 std::span<const StoredTriangle> stored) {
    const std::vector<SourceClass> classes = classes_of(sources);
    std::uint64_t least = 0;  // copies that must be there
    std::uint64_t most = 0;   // and that may
    for (const SourceClass& one : classes) {
      least += 1;
      most += one.has_own_normals ? 1 : one.count;
      duplicates_most_ += one.count - 1;
    }
    if (stored.size() < least || stored.size() > most) {
      log_.add(Rule::kV101, key_text(key),
               std::to_string(stored.size()) + " times among level-0 clusters, expected " + std::to_string(least) +
                   (most == least ? "" : " to " + std::to_string(most)));
      return;
    }
    if (classes.empty() || classes.size() > kMaxClassesCompared) return;
    for (const StoredTriangle& triangle : stored) {
      counts_.corners += 3;
      const bool found = std::any_of(classes.begin(), classes.end(),
                                     [&](const SourceClass& one) { return has_attributes_of(triangle.place, one); });
      if (!found) {
        log_.add(Rule::kV104, key_text(key),
                 place("cluster", triangle.place.cluster, "triangle", triangle.place.triangle) +
                     " has attributes of no source triangle in its place");
      }
    }
  }

  [[nodiscard]] bool has_attributes_of(const StoredPlace& stored, const SourceClass& one) {
    if (decoded_cluster_ != stored.cluster) {
      run::decode_attributes(mesh_, clusters_[stored.cluster], decoded_);
      decoded_cluster_ = stored.cluster;
    }
    const auto& triangle = clusters_[stored.cluster].triangles[stored.triangle];
    for (std::size_t shift = 0; shift < 3; ++shift) {
      bool matches = true;
      for (std::size_t k = 0; k < 3 && matches; ++k) {
        const std::uint32_t vertex = triangle[(k + shift) % 3];
        const Vec3i p = clusters_[stored.cluster].position(vertex);
        matches = vertices_.point_of(one.triangle[k].position) == GridPoint{p.x, p.y, p.z} &&
                  is_near(one.triangle[k], vertex, one.has_own_normals);
      }
      if (matches) return true;
    }
    return false;
  }

  [[nodiscard]] bool is_near(const Corner& source, std::uint32_t vertex, bool has_own_normals) const {
    std::size_t slot = 0;
    if (stores_normals()) {
      const Vec3d n(source.attributes[0], source.attributes[1], source.attributes[2]);
      slot = 3;
      const double length = std::sqrt(glm::dot(n, n));
      // A zero normal has no direction to keep; a computed one of a sliver neither.
      if (length > 1e-30 && std::isfinite(length) && has_own_normals) {
        const Vec3d d = Vec3d(decoded_.normals[vertex]) - n / length;
        // The lattice's points are the covering radius sqrt(2/3)/M apart at most, stretched by sqrt(3) on the way to
        // the sphere: sqrt(2)/M. A little is added for second order and floats.
        const double cells = mesh_.normal_scale;
        const double bound = std::sqrt(2.0) / cells * (1.0 + 1.0 / cells) + 1e-6;
        if (glm::dot(d, d) > bound * bound) return false;
      }
    }
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      const double half_step = 0.5 * format::exp2_exact(mesh_.uv_log2[set]);
      for (int axis = 0; axis < 2; ++axis) {
        const double value = source.attributes[slot++];
        if (!std::isfinite(value)) continue;
        if (std::fabs(double{decoded_.uvs[set][vertex][axis]} - value) > half_step * (1.0 + 1e-9)) return false;
      }
    }
    if (mesh_.has_color != 0) {
      for (int axis = 0; axis < 4; ++axis) {
        const double value = std::clamp(double{source.attributes[slot++]}, 0.0, 1.0);
        if (std::fabs(double{decoded_.colors[vertex][axis]} - value) > 0.5 / 255.0 + 1e-6) return false;
      }
    }
    return true;
  }

  void check_dropped() {
    const auto at = [&] { return where(); };
    log_.expect(mesh_.dropped_degenerate == degenerate_, Rule::kV102, at, [&] {
      return differs("dropped_degenerate", mesh_.dropped_degenerate, "degenerate in the source", degenerate_);
    });
    const std::uint64_t gone =
        sources_.size() + degenerate_ - std::min<std::uint64_t>(stored_.size(), sources_.size() + degenerate_);
    log_.expect(
        mesh_.dropped_degenerate + mesh_.dropped_duplicate == gone && mesh_.dropped_duplicate <= duplicates_most_,
        Rule::kV102, at, [&] {
          return differs("dropped", mesh_.dropped_degenerate + mesh_.dropped_duplicate, "missing from level 0", gone);
        });
  }

  const run::Asset& asset_;
  MeshId mesh_id_;
  const format::MeshRecord& mesh_;
  const scene::SourceMesh& source_;
  std::span<const run::DecodedCluster> clusters_;
  RuleLog& log_;
  double step_;
  Vec3d origin_;
  MovedVertices vertices_;
  std::vector<SourcePlace> sources_;
  std::vector<StoredPlace> stored_;
  std::vector<TriangleKey> range_ends_;                    ///< ascending: where the next range of keys begins
  std::vector<std::uint8_t> source_range_, stored_range_;  ///< per source and stored triangle
  std::uint64_t degenerate_ = 0, duplicates_most_ = 0;
  run::ClusterAttributes decoded_;
  std::uint32_t decoded_cluster_ = format::kNone;
  SourceCounts counts_;
};

}  // namespace

SourceCounts check_source_triangles(const run::Asset& asset, MeshId mesh, const scene::SourceMesh& source,
                                    std::span<const run::DecodedCluster> clusters, bool wants_border, RuleLog& log) {
  for (const Rule rule : {Rule::kV101, Rule::kV102, Rule::kV103, Rule::kV104, Rule::kV105}) log.check(rule);
  return SourceMatcher(asset, mesh, source, clusters, log).run(wants_border);
}

}  // namespace meshlode::judge
