// SPDX-License-Identifier: MIT
// The raw fields of a vertex that another cluster of the page has, as the cluster at hand says them. Says what
// full_from_raw and raw_from_full of format/vertex_fields.h say one after the other, without the integers between.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <meshlode/page.h>

#include "format/vertex_fields.h"
#include "run/unpack/strip_values.h"

namespace meshlode::run {

/// One cluster's way between the raw fields and the integers of a position and a normal.
struct TwinFrame {
  std::uint32_t lane[3];                   ///< of x y z among the fields as they are stored
  std::uint32_t minimum[3], mask[3];       ///< of x y z; the mask is of the bits that the page has
  std::uint32_t factor[3], is_sheared[3];  ///< of the shear; all ones for the axis that it is added to
  std::uint32_t normal_minimum[2], normal_mask[2], chart;

  TwinFrame() = default;
  TwinFrame(const format::MeshRecord& mesh, const format::ClusterLayout& layout) {
    const std::array<std::uint32_t, 3> axes = format::axes_by_role(layout.shear_axis);
    const std::int32_t factors[3] = {layout.shear_u, layout.shear_v, 0};
    for (std::uint32_t role = 0; role < 3; ++role) {
      const std::uint32_t axis = axes[role];
      lane[axis] = role;
      minimum[axis] = static_cast<std::uint32_t>(layout.minimum[axis]);
      mask[axis] = (1U << layout.bits[axis]) - 1U;
      factor[axis] = static_cast<std::uint32_t>(factors[role]);
      is_sheared[axis] = role == 2 ? ~0U : 0U;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      normal_minimum[k] =
          static_cast<std::uint32_t>(layout.normal_minimum[k]) - static_cast<std::uint32_t>(mesh.normal_scale);
      normal_mask[k] = (1U << layout.normal_bits[k]) - 1U;
    }
    chart = layout.chart;
  }
};

/// One UV range's way.
struct alignas(64) TwinRange {
  std::uint32_t mask[2], minimum[2], shift[2], slope[2][3];

  TwinRange() = default;
  explicit TwinRange(const format::UvRangeFields& range) {
    for (std::size_t side = 0; side < 2; ++side) {
      mask[side] = (1U << range.bits[side]) - 1U;
      minimum[side] = range.minimum[side];
      shift[side] = range.shift[side];
      for (std::size_t k = 0; k < 3; ++k) slope[side][k] = static_cast<std::uint32_t>(range.slope[side][k]);
    }
  }
};

class TwinFields {
 public:
  /// `range_of`: which of `ranges` holds a vertex of the page, vertices of set 0, then those of set 1 …
  TwinFields(const format::MeshRecord& mesh, const std::vector<format::ClusterFields>& clusters,
             const std::vector<format::UvRangeFields>& ranges, const std::vector<std::uint16_t>& range_of,
             std::uint32_t vertex_count)
      : scale_(static_cast<std::uint32_t>(mesh.normal_scale)),
        set_count_(mesh.uv_set_count),
        vertex_count_(vertex_count),
        has_normals_(mesh.normal_mode == format::NormalMode::kStored),
        has_color_(mesh.has_color != 0),
        clusters_(clusters.data()),
        range_of_(range_of.data()) {
    frames_.reserve(clusters.size());
    for (const format::ClusterFields& cluster : clusters) frames_.emplace_back(mesh, cluster.layout);
    ranges_.reserve(ranges.size());
    for (const format::UvRangeFields& range : ranges) ranges_.emplace_back(range);
  }

  /// `there` and `here` are vertices of the page, in the clusters `from` and `to`, and these their fields by slot
  /// (slot_of). Of those that are there the lowest bits count, as the page has them.
  template <class Word>
  void move(std::uint32_t from, std::uint32_t there, const Word* get, std::uint32_t to, std::uint32_t here,
            Word* put) const {
    const TwinFrame& a = frames_[from];
    const TwinFrame& b = frames_[to];
    std::uint32_t raw[3];
    for (std::size_t k = 0; k < 3; ++k) raw[k] = get[a.lane[k]] & a.mask[k];
    const std::uint32_t added = shear(a, raw);
    std::uint32_t own[3];
    for (std::size_t k = 0; k < 3; ++k) own[k] = raw[k] + a.minimum[k] - b.minimum[k] + (added & a.is_sheared[k]);
    const std::uint32_t taken = shear(b, own);
    for (std::size_t k = 0; k < 3; ++k) own[k] -= taken & b.is_sheared[k];
    for (std::size_t k = 0; k < 3; ++k) put[b.lane[k]] = static_cast<Word>(own[k]);
    get += kNormalSlot;
    put += kNormalSlot;
    if (has_normals_) {
      std::uint32_t normal[2] = {get[0] & a.normal_mask[0], get[1] & a.normal_mask[1]};
      move_normal(a, b, normal);
      put[0] = static_cast<Word>(normal[0]);
      put[1] = static_cast<Word>(normal[1]);
      get += 2;
      put += 2;
    }
    const std::uint16_t* range_of = range_of_;
    for (std::uint32_t set = 0; set < set_count_; ++set, range_of += vertex_count_, get += 2, put += 2) {
      const TwinRange& s = ranges_[range_of[there]];
      const TwinRange& t = ranges_[range_of[here]];
      for (std::size_t side = 0; side < 2; ++side) {
        put[side] = static_cast<Word>((get[side] & s.mask[side]) + s.minimum[side] - t.minimum[side] +
                                      fit(s, side, raw) - fit(t, side, own));
      }
    }
    if (has_color_) {
      const format::ClusterFields& s = clusters_[from];
      const format::ClusterFields& t = clusters_[to];
      for (std::size_t k = 0; k < 4; ++k) {
        put[k] = static_cast<Word>(cut(get[k], s.color_bits[k]) + s.color_minimum[k] - t.color_minimum[k]);
      }
    }
  }

 private:
  static std::uint32_t cut(std::uint32_t value, std::uint32_t bits) { return value & ((1U << bits) - 1U); }
  static std::uint32_t shift_right(std::uint32_t value, std::uint32_t bits) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(value) >> bits);
  }
  static std::uint32_t shear(const TwinFrame& frame, const std::uint32_t* xyz) {
    return shift_right(frame.factor[0] * xyz[0] + frame.factor[1] * xyz[1] + frame.factor[2] * xyz[2],
                       format::kShearShift);
  }
  static std::uint32_t fit(const TwinRange& range, std::size_t side, const std::uint32_t* xyz) {
    const std::uint32_t* const slope = range.slope[side];
    return shift_right(slope[0] * xyz[0] + slope[1] * xyz[1] + slope[2] * xyz[2], range.shift[side]);
  }

  void move_normal(const TwinFrame& a, const TwinFrame& b, std::uint32_t* raw) const {
    const std::uint32_t scale = scale_;
    const std::uint32_t first = a.normal_minimum[0] + raw[0];
    const std::uint32_t second = a.normal_minimum[1] + raw[1];
    const std::uint32_t c = scale - absolute(first) - absolute(second);
    std::uint32_t point[3] = {c, first, second};  // towards the pole, then along its cyclic successors
    if (c >> 31U != 0) exchange_poles(point, scale);
    if (a.chart != b.chart) turn(a.chart, b.chart, point);
    if (point[0] >> 31U != 0) exchange_poles(point, scale);
    raw[0] = point[1] - b.normal_minimum[0];
    raw[1] = point[2] - b.normal_minimum[1];
  }

  static std::uint32_t absolute(std::uint32_t value) { return value >> 31U != 0 ? 0U - value : value; }
  static std::uint32_t with_sign(std::uint32_t magnitude, std::uint32_t sign) {
    return sign >> 31U != 0 ? 0U - magnitude : magnitude;
  }
  /// What stands for a point of the far half, and the point itself: each is made from the other in the same way.
  static void exchange_poles(std::uint32_t* point, std::uint32_t scale) {
    const std::uint32_t first = point[1];
    point[1] = with_sign(scale - absolute(point[2]), first);
    point[2] = with_sign(scale - absolute(first), point[2]);
  }
  /// The same point seen from another pole.
  static void turn(std::uint32_t from, std::uint32_t to, std::uint32_t* point) {
    if (from % 2 != 0) point[0] = 0U - point[0];
    const std::uint32_t old[5] = {point[0], point[1], point[2], point[0], point[1]};
    constexpr std::uint8_t kSteps[5] = {1, 2, 0, 1, 2};  // of the cycle, by the difference and 2
    const std::uint32_t* const first = old + kSteps[to / 2 + 2U - from / 2];
    for (std::uint32_t k = 0; k < 3; ++k) point[k] = first[k];
    if (to % 2 != 0) point[0] = 0U - point[0];
  }

  std::uint32_t scale_, set_count_, vertex_count_;
  bool has_normals_, has_color_;
  const format::ClusterFields* clusters_;
  const std::uint16_t* range_of_;
  std::vector<TwinFrame> frames_;
  std::vector<TwinRange> ranges_;
};

}  // namespace meshlode::run
