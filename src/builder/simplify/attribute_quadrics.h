// SPDX-License-Identifier: GPL-3.0-or-later
// What it costs to move attributes: per wedge, the error of its values as a function of where its vertex is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "builder/simplify/group_locks.h"
#include "builder/simplify/quadric.h"
#include "builder/simplify/simplify.h"
#include "builder/simplify/surface_quadrics.h"
#include "builder/simplify/wedge_classes.h"

namespace meshlode::builder {

/// For at most Capacity floats a wedge: quadrics of few attributes are small, and copying them is most of the work.
/// `Real`, of the quadrics: double or float.
template <class Real, std::size_t Capacity>
class AttributeQuadrics {
 public:
  /// `scales` as from attribute_scales, one per float. The input must outlive this.
  AttributeQuadrics(const SimplifyInput& input, std::vector<double> scales);

  /// Floats a wedge; 0 without attributes.
  [[nodiscard]] std::size_t count() const { return scale_.size(); }

  /// Across the face each attribute is linear between its wedges' values. \pre face.twice_area > 0, count() > 0
  void add_face(const std::array<std::uint32_t, 3>& wedges, const Face& face);

  /// Whether the locked wedges that would become one have one value.
  [[nodiscard]] bool agree(const WedgeClass& joined, const GroupLocks& locks) const;

  /// Adds to `total` what the classes cost with their best values. Returns the error of those whose values are fixed,
  /// for a vertex at `given`.
  [[nodiscard]] double add_classes(BasicQuadric<Real>& total, std::span<const WedgeClass> classes,
                                   const Vec3d& given) const;

  /// The same of a single class: of two wedges, of which `fixed` rules if any.
  [[nodiscard]] double add_pair(BasicQuadric<Real>& total, const WedgePair& pair, const Vec3d& given) const;

  /// The class becomes its keeper, with the best values at `place` where they are not fixed.
  void join(const WedgeClass& joined, const Vec3d& place);

  /// As they are stored, but for the length of normals; 0 where one does not count.
  void values_of(std::uint32_t wedge, std::array<double, Capacity>& out) const;

  /// The same of what the class would have with its vertex at `place`.
  void values_of(const WedgeClass& joined, const Vec3d& place, std::array<double, Capacity>& out) const;

  /// Appends the wedge as it is stored: of a locked one what came in, and normals of unit length.
  void write(std::uint32_t wedge, bool is_locked, std::vector<float>& out) const;

 private:
  /// Mostly there are as many as fit: then the compiler knows how many, and loops over them unroll.
  template <class Body>
  void with_count(const Body& body) const {
    if (count() == Capacity) {
      body(std::integral_constant<std::size_t, Capacity>{});
    } else {
      body(count());
    }
  }

  const SimplifyInput& input_;
  std::vector<double> scale_;  ///< stored value -> weighted value
  std::vector<WedgeQuadric<Real, Capacity>> wedge_;
  std::vector<std::array<double, Capacity>> value_;  ///< weighted
};

template <class Real, std::size_t C>
AttributeQuadrics<Real, C>::AttributeQuadrics(const SimplifyInput& input, std::vector<double> scales)
    : input_(input),
      scale_(std::move(scales)),
      wedge_(scale_.empty() ? 0 : input.wedge_position.size()),
      value_(wedge_.size()) {
  for (std::size_t w = 0; w < wedge_.size(); ++w) {
    for (std::size_t j = 0; j < count(); ++j) {
      value_[w][j] = scale_[j] * static_cast<double>(input.wedge_attributes[w * count() + j]);
    }
  }
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::add_face(const std::array<std::uint32_t, 3>& wedges, const Face& face) {
  const double area = 0.5 * face.twice_area;
  // Across a sliver a gradient means nothing: there the attribute is taken as constant.
  const Vec3d e3 = face.e2 - face.e1;
  const double longest2 = std::max({glm::dot(face.e1, face.e1), glm::dot(face.e2, face.e2), glm::dot(e3, e3)});
  const bool is_sliver = face.twice_area < 1e-3 * longest2;
  const Vec3d to_1 = glm::cross(face.e2, face.normal) / face.twice_area;
  const Vec3d to_2 = glm::cross(face.normal, face.e1) / face.twice_area;
  with_count([&](const auto count) {
    WedgeQuadric<Real, C> of_face;
    of_face.base.weight = static_cast<Real>(area);
    for (std::size_t j = 0; j < count; ++j) {
      const double s0 = value_[wedges[0]][j];
      const double s1 = value_[wedges[1]][j];
      const double s2 = value_[wedges[2]][j];
      Vec3d gradient(0.0);
      double offset = (s0 + s1 + s2) / 3.0;
      if (!is_sliver) {
        gradient = to_1 * (s1 - s0) + to_2 * (s2 - s0);
        offset = s0 - glm::dot(gradient, face.p);
      }
      of_face.add_face(j, glm::vec<3, Real>(gradient), static_cast<Real>(offset), static_cast<Real>(area));
    }
    for (const std::uint32_t wedge : wedges) wedge_[wedge].add(of_face, count);
  });
}

template <class Real, std::size_t C>
bool AttributeQuadrics<Real, C>::agree(const WedgeClass& joined, const GroupLocks& locks) const {
  return std::all_of(joined.members.begin(), joined.members.end(), [&](std::uint32_t w) {
    return w == joined.fixed || locks.is_wedge_locked[w] == 0 || value_[w] == value_[joined.fixed];
  });
}

template <class Real, std::size_t C>
double AttributeQuadrics<Real, C>::add_classes(BasicQuadric<Real>& total, std::span<const WedgeClass> classes,
                                               const Vec3d& given) const {
  double fixed_error = 0.0;
  with_count([&](const auto count) {
    for (const WedgeClass& c : classes) {
      const std::size_t members = c.members.size();
      const WedgeQuadric<Real, C>& first = wedge_[c.members[0]];
      WedgeQuadric<Real, C> joined =
          members > 1 ? WedgeQuadric<Real, C>::sum(first, wedge_[c.members[1]], count) : first;
      for (std::size_t k = 2; k < members; ++k) joined.add(wedge_[c.members[k]], count);
      if (c.fixed != kNoId) {
        fixed_error += double{joined.evaluate(given, value_[c.fixed].data(), count)};
      } else {
        joined.add_reduced_to(total, count);
      }
    }
  });
  return fixed_error;
}

template <class Real, std::size_t C>
double AttributeQuadrics<Real, C>::add_pair(BasicQuadric<Real>& total, const WedgePair& pair,
                                            const Vec3d& given) const {
  double fixed_error = 0.0;
  with_count([&](const auto count) {
    const auto joined = WedgeQuadric<Real, C>::sum(wedge_[pair.least], wedge_[pair.greatest], count);
    if (pair.fixed != kNoId) {
      fixed_error = double{joined.evaluate(given, value_[pair.fixed].data(), count)};
    } else {
      joined.add_reduced_to(total, count);
    }
  });
  return fixed_error;
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::join(const WedgeClass& joined, const Vec3d& place) {
  const std::uint32_t keeper = joined.keeper();
  with_count([&](const auto count) {
    for (const std::uint32_t w : joined.members) {
      if (w != keeper) wedge_[keeper].add(wedge_[w], count);
    }
  });
  if (joined.fixed != kNoId || !(wedge_[keeper].base.weight > Real(0))) return;
  for (std::size_t j = 0; j < count(); ++j) value_[keeper][j] = double{wedge_[keeper].best(j, place)};
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::values_of(std::uint32_t wedge, std::array<double, C>& out) const {
  for (std::size_t j = 0; j < count(); ++j) out[j] = scale_[j] > 0.0 ? value_[wedge][j] / scale_[j] : 0.0;
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::values_of(const WedgeClass& joined, const Vec3d& place,
                                           std::array<double, C>& out) const {
  if (joined.fixed != kNoId) return values_of(joined.fixed, out);
  WedgeQuadric<Real, C> sum = wedge_[joined.members[0]];
  for (std::size_t k = 1; k < joined.members.size(); ++k) sum.add(wedge_[joined.members[k]], count());
  if (!(sum.base.weight > Real(0))) return values_of(joined.keeper(), out);
  for (std::size_t j = 0; j < count(); ++j) out[j] = scale_[j] > 0.0 ? double{sum.best(j, place)} / scale_[j] : 0.0;
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::write(std::uint32_t wedge, bool is_locked, std::vector<float>& out) const {
  const float* given = &input_.wedge_attributes[wedge * count()];
  for (std::size_t j = 0; j < count(); ++j) {
    const bool is_kept = is_locked || !(scale_[j] > 0.0);
    out.push_back(is_kept ? given[j] : static_cast<float>(value_[wedge][j] / scale_[j]));
  }
  if (!input_.layout.has_normal || is_locked) return;
  float* n = &out[out.size() - count()];
  const double x = n[0];
  const double y = n[1];
  const double z = n[2];
  const double length = std::sqrt(x * x + y * y + z * z);
  if (length > 0.0) {
    n[0] = static_cast<float>(x / length);
    n[1] = static_cast<float>(y / length);
    n[2] = static_cast<float>(z / length);
  } else {
    std::copy_n(given, 3, n);
  }
}

}  // namespace meshlode::builder
