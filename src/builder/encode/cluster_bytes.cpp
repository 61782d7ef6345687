// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/cluster_bytes.h"

#include <algorithm>
#include <bit>
#include <bitset>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <span>
#include <string>

#include "base/try.h"
#include "builder/encode/attribute_steps.h"
#include "builder/encode/bit_stream.h"
#include "builder/encode/fits.h"
#include "builder/encode/quantize_normal.h"
#include "builder/encode/strips.h"
#include "builder/encode/uv_grid.h"

namespace meshlode::builder {

namespace {

Error limit_error(std::string detail) {
  return {ErrorCode::kBuildFailed, "", std::move(detail)};
}

Status check_cluster(const LodDag& dag, const DagCluster& cluster) {
  if (cluster.vertex_count < 1 || cluster.vertex_count > format::kMaxClusterVertices) {
    return limit_error("has " + std::to_string(cluster.vertex_count) + " vertices, 1 to 256 are possible");
  }
  if (cluster.triangle_count < 1 || cluster.triangle_count > format::kMaxClusterTriangles) {
    return limit_error("has " + std::to_string(cluster.triangle_count) + " triangles, 1 to 256 are possible");
  }
  std::bitset<format::kMaxClusterVertices> used;
  for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count; ++t) {
    for (const std::uint8_t vertex : dag.triangles[t]) {
      if (vertex >= cluster.vertex_count) return limit_error("a triangle names a vertex that the cluster lacks");
      used.set(vertex);
    }
  }
  if (used.count() != cluster.vertex_count) return limit_error("a vertex belongs to no triangle");
  return Ok{};
}

Status check_materials(const LodDag& dag, const DagCluster& cluster, const ChannelPlan& plan) {
  for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count; ++t) {
    const std::uint32_t material = dag.triangle_material[t];
    if (plan.material != format::kNone && material != plan.material) return limit_error("has a second material");
    if (material > format::material_range::kMaterial.mask()) return limit_error("a material needs more than 24 bits");
    if (t > cluster.first_triangle && material < dag.triangle_material[t - 1]) {
      return limit_error("triangles are not sorted by material");
    }
  }
  return Ok{};
}

/// Vertices that triangles tie together, each named by its smallest member.
std::vector<std::uint32_t> find_islands(std::span<const LocalTriangle> triangles, std::uint32_t vertex_count) {
  std::vector<std::uint32_t> root(vertex_count);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const LocalTriangle& t : triangles) {
    for (const std::size_t corner : {1U, 2U}) {
      const std::uint32_t a = find(t[0]);
      const std::uint32_t b = find(t[corner]);
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::uint32_t v = 0; v < vertex_count; ++v) root[v] = find(v);
  return root;
}

/// Coordinates of a cluster's points, axis by axis: loops over them have no branch and become vector instructions.
using Columns = std::array<std::array<std::int32_t, format::kMaxClusterVertices>, 3>;

/// Of chart_coordinates, over all points.
std::array<ValueRange, 2> chart_ranges(const Columns& points, std::size_t count, std::uint32_t chart,
                                       std::int32_t scale) {
  const std::size_t pole = chart / 2;
  const std::int32_t *as = points[(pole + 1) % 3].data(), *bs = points[(pole + 2) % 3].data();
  const std::int32_t* cs = points[pole].data();
  const std::int32_t side = chart % 2 == 0 ? 0 : -1;  // c ^ side is negative where the point is on the far half
  std::int32_t least_a = 2 * scale, most_a = 0, least_b = 2 * scale, most_b = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t a = as[i], b = bs[i], c = cs[i];
    const std::int32_t fa = scale - std::abs(b), fb = scale - std::abs(a);
    const bool is_far = ((c ^ side) < 0) & (c != 0);
    const std::int32_t x = (is_far ? (a < 0 ? -fa : fa) : a) + scale;
    const std::int32_t y = (is_far ? (b < 0 ? -fb : fb) : b) + scale;
    least_a = std::min(least_a, x);
    most_a = std::max(most_a, x);
    least_b = std::min(least_b, y);
    most_b = std::max(most_b, y);
  }
  return {range_between(least_a, most_a), range_between(least_b, most_b)};
}

/// One cluster on its way into words. Vertices are in their new order: by first use of the strips.
class ClusterEncoder {
 public:
  ClusterEncoder(const LodDag& dag, const DagCluster& cluster, const ChannelPlan& plan)
      : dag_(dag), cluster_(cluster), plan_(plan), stream_(out_.data) {}

  Result<ClusterWords> run() {
    order_triangles();
    TRY(quantize_positions());
    put(format::head::kVerticesLess1, static_cast<std::int32_t>(cluster_.vertex_count) - 1);
    put(format::head::kTrianglesLess1, static_cast<std::int32_t>(cluster_.triangle_count) - 1);
    fit_ = fit_positions(positions_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(format::head::kMinimum[axis], fit_.range[axis].minimum);
      put(format::head::kBits[axis], static_cast<std::int32_t>(fit_.range[axis].bits));
    }
    put(format::head::kShearAxis, static_cast<std::int32_t>(fit_.axis));
    put(format::head::kShearU, fit_.slope[0]);
    put(format::head::kShearV, fit_.slope[1]);
    put(format::head::kStripsLess1, static_cast<std::int32_t>(strips_.first_triangle.size()) - 1);
    put(format::head::kReferenceBits, static_cast<std::int32_t>(strips_.reference_bits));
    if (plan_.layout.has_normal) choose_chart();

    if (plan_.material == format::kNone) put_material_ranges();
    for (std::uint32_t set = 0; set < plan_.layout.uv_set_count; ++set) put_uv_ranges(set);
    if (plan_.layout.has_color) put_color_range();

    for (const RawPosition& raw : fit_.raw) {
      for (std::size_t axis = 0; axis < 3; ++axis) stream_.put(raw[axis], fit_.range[axis].bits);
    }
    for (const auto& ab : normals_) {
      for (std::size_t i = 0; i < 2; ++i) {
        stream_.put(static_cast<std::uint32_t>(ab[i] - normal_range_[i].minimum), normal_range_[i].bits);
      }
    }
    for (const UvRange& range : uv_ranges_) {
      for (std::size_t i = 0; i < range.u.residual.size(); ++i) {
        stream_.put(range.u.residual[i], range.u.range.bits);
        stream_.put(range.v.residual[i], range.v.range.bits);
      }
    }
    for (const auto& color : colors_) {
      for (std::size_t i = 0; i < 4; ++i) {
        stream_.put(static_cast<std::uint32_t>(color[i] - color_range_[i].minimum), color_range_[i].bits);
      }
    }
    put_topology();
    stream_.flush();
    return std::move(out_);
  }

 private:
  struct UvRange {
    std::uint32_t first = 0, count = 0;
    UvFit u, v;
    [[nodiscard]] bool has_fit() const { return u.has_slope || v.has_slope; }
    [[nodiscard]] std::uint32_t bit_count() const {
      return 32U * (format::uv_range::kWords + (has_fit() ? format::uv_range::kFitWords : 0U)) +
             count * (u.range.bits + v.range.bits);
    }
  };

  void put(format::BitField field, std::int32_t value) { format::put_field(out_.head.data(), field, value); }

  /// The old vertex that a new one is, in the DAG's arrays.
  [[nodiscard]] std::size_t source_vertex(std::size_t i) const {
    return std::size_t{cluster_.first_vertex} + strips_.vertex_order[i];
  }
  [[nodiscard]] const float* attributes(std::size_t i) const {
    return dag_.vertex_attributes.data() + source_vertex(i) * plan_.layout.stride();
  }

  /// By material, then by island, so that both are contiguous, then as strips.
  void order_triangles() {
    const auto first = dag_.triangles.begin() + cluster_.first_triangle;
    std::vector<LocalTriangle> triangles(first, first + cluster_.triangle_count);
    const std::vector<std::uint32_t> island = find_islands(triangles, cluster_.vertex_count);
    // Material, island and place as one number each. They are in order already where there is one of either, as nearly
    // always.
    std::vector<std::uint64_t> order(triangles.size());
    for (std::size_t t = 0; t < order.size(); ++t) {
      order[t] =
          std::uint64_t{dag_.triangle_material[cluster_.first_triangle + t]} << 16U | island[triangles[t][0]] << 8U | t;
    }
    if (!std::is_sorted(order.begin(), order.end())) std::sort(order.begin(), order.end());
    std::vector<LocalTriangle> sorted;
    std::vector<std::uint32_t> block;
    sorted.reserve(order.size());
    block.reserve(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool is_new = i > 0 && order[i] >> 8U != order[i - 1] >> 8U;
      block.push_back(i == 0 ? 0U : block.back() + (is_new ? 1U : 0U));
      sorted.push_back(triangles[order[i] & 0xFFU]);
    }
    const bool is_mixed = order.front() >> 16U != order.back() >> 16U;
    strips_ =
        make_strips(sorted, block, cluster_.vertex_count, {is_mixed ? plan_.mixed_strip_trials : plan_.strip_trials});
    island_.reserve(cluster_.vertex_count);
    for (const std::uint8_t v : strips_.vertex_order) island_.push_back(island[v]);
  }

  Status quantize_positions() {
    positions_.reserve(cluster_.vertex_count);
    for (std::size_t i = 0; i < cluster_.vertex_count; ++i) {
      const Vec3i& p = dag_.vertex_position[source_vertex(i)];
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(std::int64_t{p[axis]}) > format::kMaxGridCoordinate) {
          return limit_error("a position needs more than 24 bits");
        }
      }
      positions_.push_back({p.x, p.y, p.z});
    }
    return Ok{};
  }

  /// The chart in which the cluster's normals take the fewest bits.
  void choose_chart() {
    std::vector<std::array<std::int32_t, 3>> points;
    points.reserve(cluster_.vertex_count);
    Columns columns;
    for (std::size_t i = 0; i < cluster_.vertex_count; ++i) {
      const float* n = attributes(i);
      points.push_back(nearest_octahedral_point({n[0], n[1], n[2]}, plan_.normal_scale));
      for (std::size_t axis = 0; axis < 3; ++axis) columns[axis][i] = points[i][axis];
    }
    std::uint32_t best_bits = 64;
    std::uint32_t best_chart = 0;
    for (std::uint32_t chart = 0; chart < 6; ++chart) {
      const std::array<ValueRange, 2> range = chart_ranges(columns, points.size(), chart, plan_.normal_scale);
      if (range[0].bits + range[1].bits >= best_bits) continue;
      best_bits = range[0].bits + range[1].bits;
      best_chart = chart;
      normal_range_ = range;
    }
    normals_.reserve(points.size());
    for (const auto& point : points) normals_.push_back(chart_coordinates(point, best_chart, plan_.normal_scale));
    put(format::head::kChart, static_cast<std::int32_t>(best_chart));
    put(format::head::kNormalMinimumA, normal_range_[0].minimum);
    put(format::head::kNormalMinimumB, normal_range_[1].minimum);
    put(format::head::kNormalBitsA, static_cast<std::int32_t>(normal_range_[0].bits));
    put(format::head::kNormalBitsB, static_cast<std::int32_t>(normal_range_[1].bits));
  }

  void put_material_ranges() {
    const std::uint32_t* material = dag_.triangle_material.data() + cluster_.first_triangle;
    for (std::uint32_t t = 0; t < cluster_.triangle_count;) {
      std::uint32_t end = t;
      while (end < cluster_.triangle_count && material[end] == material[t]) ++end;
      std::uint32_t word = 0;
      format::put_field(&word, format::material_range::kTrianglesLess1, static_cast<std::int32_t>(end - t) - 1);
      format::put_field(&word, format::material_range::kMaterial, static_cast<std::int32_t>(material[t]));
      out_.data.push_back(word);
      t = end;
    }
  }

  [[nodiscard]] UvRange make_uv_range(const std::array<std::vector<std::int32_t>, 2>& uv, std::uint32_t first,
                                      std::uint32_t count) const {
    const auto fit = [&](std::size_t i, bool may_have_slope) {
      return fit_uv(std::span(uv[i]).subspan(first, count), std::span(fit_.raw).subspan(first, count), may_have_slope);
    };
    UvRange plain{first, count, fit(0, false), fit(1, false)};
    UvRange sloped{first, count, fit(0, true), fit(1, true)};
    return sloped.bit_count() < plain.bit_count() ? sloped : plain;
  }

  /// A range for each island at first; neighbours are joined where that takes fewer bits.
  void put_uv_ranges(std::uint32_t set) {
    std::array<std::vector<std::int32_t>, 2> uv;
    for (std::size_t i = 0; i < cluster_.vertex_count; ++i) {
      const float* at = attributes(i) + plan_.layout.uv_offset() + 2U * set;
      uv[0].push_back(quantize_uv(at[0], plan_.uv_log2[set]));
      uv[1].push_back(quantize_uv(at[1], plan_.uv_log2[set]));
    }
    std::vector<UvRange> ranges;
    for (std::uint32_t first = 0; first < cluster_.vertex_count;) {
      std::uint32_t end = first;
      while (end < cluster_.vertex_count && island_[end] == island_[first]) ++end;
      ranges.push_back(make_uv_range(uv, first, end - first));
      first = end;
      while (ranges.size() > 1) {
        const UvRange& a = ranges[ranges.size() - 2];
        const UvRange& b = ranges.back();
        UvRange joined = make_uv_range(uv, a.first, a.count + b.count);
        if (joined.bit_count() > a.bit_count() + b.bit_count()) break;
        ranges.pop_back();
        ranges.back() = std::move(joined);
      }
    }
    std::uint32_t bits = 0;
    for (const UvRange& range : ranges) bits += range.bit_count();
    UvRange whole = make_uv_range(uv, 0, cluster_.vertex_count);
    if (whole.bit_count() <= bits) {  // max_cluster_bytes counts on it
      ranges.clear();
      ranges.push_back(std::move(whole));
    }
    for (UvRange& range : ranges) {
      namespace f = format::uv_range;
      std::array<std::uint32_t, f::kWords + f::kFitWords> words{};
      const auto put_in = [&](format::BitField field, std::int64_t value) {
        format::put_field(words.data(), field, static_cast<std::int32_t>(value));
      };
      put_in(f::kVerticesLess1, std::int64_t{range.count} - 1);
      put_in(f::kBitsU, range.u.range.bits);
      put_in(f::kBitsV, range.v.range.bits);
      put_in(f::kShiftU, range.u.shift);
      put_in(f::kShiftV, range.v.shift);
      put_in(f::kHasFit, range.has_fit() ? 1 : 0);
      put_in(f::kMinimumU, range.u.range.minimum);
      put_in(f::kMinimumV, range.v.range.minimum);
      for (std::size_t k = 0; k < 3; ++k) {
        put_in(f::kFitU[k], range.u.slope[k]);
        put_in(f::kFitV[k], range.v.slope[k]);
      }
      out_.data.insert(out_.data.end(), words.begin(),
                       words.begin() + f::kWords + (range.has_fit() ? f::kFitWords : 0U));
      uv_ranges_.push_back(std::move(range));
    }
  }

  void put_color_range() {
    for (std::size_t i = 0; i < cluster_.vertex_count; ++i) {
      std::array<std::int32_t, 4> color{};
      for (std::size_t k = 0; k < 4; ++k) color[k] = quantize_color(attributes(i)[plan_.layout.color_offset() + k]);
      colors_.push_back(color);
    }
    std::array<std::uint32_t, format::color_range::kWords> words{};
    std::vector<std::int32_t> values(colors_.size());
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < colors_.size(); ++i) values[i] = colors_[i][k];
      color_range_[k] = range_of(values);
      format::put_field(words.data(), format::color_range::kMinimum[k], color_range_[k].minimum);
      format::put_field(words.data(), format::color_range::kBits[k], static_cast<std::int32_t>(color_range_[k].bits));
    }
    out_.data.insert(out_.data.end(), words.begin(), words.end());
  }

  void put_topology() {
    for (const bool turn : strips_.turns) stream_.put(turn ? 1U : 0U, 1);
    std::bitset<format::kMaxClusterVertices> named;
    for (const std::uint8_t v : strips_.slots) {
      stream_.put(named[v] ? 0U : 1U, 1);
      named.set(v);
    }
    const auto restart_bits = static_cast<std::uint32_t>(std::bit_width(cluster_.triangle_count - 1U));
    for (std::size_t k = 1; k < strips_.first_triangle.size(); ++k)
      stream_.put(strips_.first_triangle[k], restart_bits);
    for (const std::uint32_t distance : strips_.references) stream_.put(distance, strips_.reference_bits);
  }

  const LodDag& dag_;
  const DagCluster& cluster_;
  const ChannelPlan& plan_;
  ClusterWords out_;
  BitWriter stream_;
  Strips strips_;
  std::vector<std::uint32_t> island_;  ///< of each new vertex
  std::vector<std::array<std::int32_t, 3>> positions_;
  PositionFit fit_;
  std::vector<std::array<std::int32_t, 2>> normals_;
  std::array<ValueRange, 2> normal_range_{};
  std::vector<UvRange> uv_ranges_;  ///< of all sets
  std::vector<std::array<std::int32_t, 4>> colors_;
  std::array<ValueRange, 4> color_range_{};
};

}  // namespace

Result<ClusterWords> encode_cluster(const LodDag& dag, const DagCluster& cluster, const ChannelPlan& plan) {
  TRY(check_cluster(dag, cluster));
  TRY(check_materials(dag, cluster, plan));
  return ClusterEncoder(dag, cluster, plan).run();
}

std::uint32_t max_cluster_bytes(const AttributeLayout& layout, const EncodeOptions& options, std::uint32_t vertex_count,
                                std::uint32_t triangle_count, std::uint32_t material_count) {
  const auto normal_scale = static_cast<std::uint32_t>(normal_scale_of(options));
  const std::uint32_t normal_bits =
      layout.has_normal ? 2U * static_cast<std::uint32_t>(std::bit_width(2U * normal_scale)) : 0U;
  const std::uint32_t vertex_bits =
      3U * 24U + normal_bits + 2U * 25U * layout.uv_set_count + (layout.has_color ? 32U : 0U);
  // Every triangle a strip of its own is the worst: three slots, of which all but the vertices are references.
  const std::uint32_t topology_bits = triangle_count * (1U + 3U + 8U) + (3U * triangle_count) * 8U;
  const std::uint32_t words =
      format::kHeadWords + (layout.has_normal ? format::kNormalHeadWords : 0U) +
      material_count * format::material_range::kWords + layout.uv_set_count * format::uv_range::kWords +
      (layout.has_color ? format::color_range::kWords : 0U) + (vertex_count * vertex_bits + topology_bits + 31U) / 32U;
  return 4U * words;
}

}  // namespace meshlode::builder
