// SPDX-License-Identifier: MIT
// The raw fields of a vertex that another cluster of the page has, as the cluster at hand says them. Says what
// full_from_raw and raw_from_full of coding/vertex_fields.h say one after the other, without the integers between.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/page.h>

#include "coding/vertex_fields.h"
#include "unpack/strip_values.h"

namespace meshlode {

class TwinFields {
 public:
  /// `range_of`: which of `ranges` holds a vertex of the page, vertices of set 0, then those of set 1 …
  TwinFields(const format::MeshRecord& mesh, const std::uint32_t* page, const std::vector<UvRangeFields>& ranges,
             const std::vector<std::uint16_t>& range_of, std::uint32_t vertex_count)
      : mesh_(mesh), page_(page), ranges_(ranges.data()), range_of_(range_of.data()), vertex_count_(vertex_count) {}

  /// `there` and `here` are vertices of the page; `from` begins with vertex `from_first`.
  template <class Put>
  void move(const ClusterFields& from, std::uint32_t from_first, std::uint32_t there, const ClusterFields& to,
            std::uint32_t here, Put put) const {
    const format::ClusterLayout& a = from.layout;
    const format::ClusterLayout& b = to.layout;
    const std::uint32_t v = there - from_first;
    std::uint32_t raw[3];
    take(a.position_bit + v * (a.bits[0] + a.bits[1] + a.bits[2]), a.bits, raw);
    std::uint32_t own[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      own[axis] = raw[axis] + static_cast<std::uint32_t>(a.minimum[axis]) - static_cast<std::uint32_t>(b.minimum[axis]);
    }
    own[a.shear_axis] += shear(a, raw);
    own[b.shear_axis] -= shear(b, own);
    const std::uint32_t first_axis = b.shear_axis == 0 ? 1U : 0U;
    const std::uint32_t second_axis = b.shear_axis == 2 ? 1U : 2U;
    put(0, own[first_axis]);
    put(1, own[second_axis]);
    put(2, own[b.shear_axis]);
    std::uint32_t field = 3;
    if (mesh_.normal_mode == format::NormalMode::kStored) {
      std::uint32_t normal[2];
      move_normal(a, v, b, normal);
      put(field++, normal[0]);
      put(field++, normal[1]);
    }
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      const UvRangeFields& s = ranges_[range_of_[set * vertex_count_ + there]];
      const UvRangeFields& t = ranges_[range_of_[set * vertex_count_ + here]];
      std::uint32_t uv[2];
      take2(s.first_bit + (v - s.first_vertex) * (s.bits[0] + s.bits[1]), s.bits, uv);
      for (std::size_t side = 0; side < 2; ++side) {
        put(field++, uv[side] + s.minimum[side] - t.minimum[side] + fit(s, side, raw) - fit(t, side, own));
      }
    }
    if (mesh_.has_color != 0) {
      std::uint32_t bit = a.color_bit + v * (from.color_bits[0] + from.color_bits[1] + from.color_bits[2] + from.color_bits[3]);
      for (std::size_t k = 0; k < 4; ++k) {
        put(field++, format::get_bits(page_, bit, from.color_bits[k]) + from.color_minimum[k] - to.color_minimum[k]);
        bit += from.color_bits[k];
      }
    }
  }

 private:
  static std::uint32_t shift_right(std::uint32_t value, std::uint32_t bits) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(value) >> bits);
  }
  static std::uint32_t shear(const format::ClusterLayout& layout, const std::uint32_t* raw) {
    const std::uint32_t u = raw[layout.shear_axis == 0 ? 1 : 0];
    const std::uint32_t v = raw[layout.shear_axis == 2 ? 1 : 2];
    return shift_right(static_cast<std::uint32_t>(layout.shear_u) * u + static_cast<std::uint32_t>(layout.shear_v) * v,
                       format::kShearShift);
  }
  static std::uint32_t fit(const UvRangeFields& range, std::size_t side, const std::uint32_t* raw) {
    const std::int32_t* const slope = range.slope[side];
    return shift_right(static_cast<std::uint32_t>(slope[0]) * raw[0] + static_cast<std::uint32_t>(slope[1]) * raw[1] +
                           static_cast<std::uint32_t>(slope[2]) * raw[2],
                       range.shift[side]);
  }

  void take(std::uint32_t bit, const std::uint32_t* bits, std::uint32_t* out) const {
    out[0] = format::get_bits(page_, bit, bits[0]);
    out[1] = format::get_bits(page_, bit + bits[0], bits[1]);
    out[2] = format::get_bits(page_, bit + bits[0] + bits[1], bits[2]);
  }
  void take2(std::uint32_t bit, const std::uint32_t* bits, std::uint32_t* out) const {
    out[0] = format::get_bits(page_, bit, bits[0]);
    out[1] = format::get_bits(page_, bit + bits[0], bits[1]);
  }

  void move_normal(const format::ClusterLayout& a, std::uint32_t v, const format::ClusterLayout& b,
                   std::uint32_t* out) const {
    std::uint32_t raw[2];
    take2(a.normal_bit + v * (a.normal_bits[0] + a.normal_bits[1]), a.normal_bits, raw);
    const auto scale = static_cast<std::uint32_t>(mesh_.normal_scale);
    const std::uint32_t first = static_cast<std::uint32_t>(a.normal_minimum[0]) + raw[0] - scale;
    const std::uint32_t second = static_cast<std::uint32_t>(a.normal_minimum[1]) + raw[1] - scale;
    const std::uint32_t c = scale - absolute(first) - absolute(second);
    std::uint32_t point[3] = {c, first, second};  // towards the pole, then along its cyclic successors
    if (c >> 31U != 0) exchange_poles(point, scale);
    if (a.chart != b.chart) turn(a.chart, b.chart, point);
    if (point[0] >> 31U != 0) exchange_poles(point, scale);
    out[0] = point[1] + scale - static_cast<std::uint32_t>(b.normal_minimum[0]);
    out[1] = point[2] + scale - static_cast<std::uint32_t>(b.normal_minimum[1]);
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
    const std::uint32_t old[3] = {point[0], point[1], point[2]};
    const std::uint32_t steps = (to / 2 + 3 - from / 2) % 3;
    for (std::uint32_t k = 0; k < 3; ++k) point[k] = old[(k + steps) % 3];
    if (to % 2 != 0) point[0] = 0U - point[0];
  }

  const format::MeshRecord& mesh_;
  const std::uint32_t* page_;
  const UvRangeFields* ranges_;
  const std::uint16_t* range_of_;
  std::uint32_t vertex_count_;
};

}  // namespace meshlode
