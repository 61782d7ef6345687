// SPDX-License-Identifier: GPL-3.0-or-later
// What moving a vertex costs its attributes, per wedge, and which values come of it: where no other group has the
// wedge, those that fit best.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
/// `Real`, of the quadrics: double or float. Values are fitted when they are asked for, never in between.
template <class Real, std::size_t Capacity>
class AttributeQuadrics {
 public:
  using Values = std::array<double, Capacity == 0 ? 1 : Capacity>;

  /// `scales` as from attribute_scales, one per float. The input must outlive this.
  AttributeQuadrics(const SimplifyInput& input, std::vector<double> scales, bool has_seams);

  /// Floats a wedge; 0 without attributes.
  [[nodiscard]] std::size_t count() const { return scale_.size(); }

  /// Across the face each attribute is linear between its wedges' values. Returns what of the error depends on the
  /// place alone. \pre face.twice_area > 0, count() > 0
  BasicQuadric<Real> add_face(const std::array<std::uint32_t, 3>& wedges, const Face& face);

  /// Whether the locked wedges that would become one have one value.
  [[nodiscard]] bool agree(const WedgeClasses& classes, const GroupLocks& locks) const;

  /// Adds to `total`, which has what depends on the place alone, what the classes cost with their best values. Returns
  /// the error of those whose values are fixed, for a vertex at `given`.
  [[nodiscard]] double add_classes(BasicQuadric<Real>& total, const WedgeClasses& classes, const Vec3d& given) const;
  /// The same of a single class of two wedges.
  [[nodiscard]] double add_pair(BasicQuadric<Real>& total, std::uint32_t x, std::uint32_t y, const GroupLocks& locks,
                                const Vec3d& given) const;

  /// Each class becomes its keeper.
  void join(const WedgeClasses& classes);
  void join(std::uint32_t into, std::uint32_t from);

  /// What forgetting a wedge takes off its vertex: once.
  [[nodiscard]] BasicQuadric<Real> take_base(std::uint32_t wedge) {
    return base_.empty() ? BasicQuadric<Real>{} : std::exchange(base_[wedge], {});
  }

  /// As they are stored, but for the length of normals; 0 where one does not count. With the wedge's vertex at `place`.
  void values_of(std::uint32_t wedge, bool is_locked, const Vec3d& place, Values& out) const;
  /// The same of what the class would have.
  void values_of(const WedgeClasses& classes, std::uint32_t of, const Vec3d& place, Values& out) const;

  /// Appends the wedge as it is stored: of a locked one what came in, and normals of unit length.
  void write(std::uint32_t wedge, bool is_locked, const Vec3d& place, std::vector<float>& out) const;

 private:
  using OfWedge = WedgeQuadric<Real, Capacity>;

  /// Mostly there are as many as fit: then the compiler knows how many, and loops over them unroll.
  template <class Body>
  void with_count(const Body& body) const {
    if (count() == Capacity) {
      body(std::integral_constant<std::size_t, Capacity>{});
    } else {
      body(count());
    }
  }
  [[nodiscard]] const float* given(std::uint32_t wedge) const { return &input_.wedge_attributes[wedge * count()]; }
  [[nodiscard]] double weighted(std::uint32_t wedge, std::size_t j) const {
    return scale_[j] * double{given(wedge)[j]};
  }
  [[nodiscard]] OfWedge sum_of(const WedgeClasses& classes, std::uint32_t of) const;
  /// Adds to total, or returns the error of fixed values.
  [[nodiscard]] double add_class(BasicQuadric<Real>& total, const OfWedge& sum, std::uint32_t fixed,
                                 const Vec3d& place) const;
  void fit(const OfWedge& sum, const Vec3d& place, Values& out) const;

  const SimplifyInput& input_;
  std::vector<double> scale_;  ///< stored value -> weighted value
  std::vector<OfWedge> wedge_;
  /// Per wedge, what of its error depends on the place alone, which its vertex counts. Empty without seams: a wedge
  /// goes before its vertex only there.
  std::vector<BasicQuadric<Real>> base_;
  std::vector<std::uint8_t> is_fitted_;  ///< it came of others: its values are no longer those given
};

template <class Real, std::size_t C>
AttributeQuadrics<Real, C>::AttributeQuadrics(const SimplifyInput& input, std::vector<double> scales, bool has_seams)
    : input_(input),
      scale_(std::move(scales)),
      wedge_(scale_.empty() ? 0 : input.wedge_position.size()),
      base_(has_seams ? wedge_.size() : 0),
      is_fitted_(wedge_.size(), 0) {}

template <class Real, std::size_t C>
BasicQuadric<Real> AttributeQuadrics<Real, C>::add_face(const std::array<std::uint32_t, 3>& wedges, const Face& face) {
  const double area = 0.5 * face.twice_area;
  // Across a sliver a gradient means nothing: there the attribute is taken as constant.
  const Vec3d e3 = face.e2 - face.e1;
  const double longest2 = std::max({glm::dot(face.e1, face.e1), glm::dot(face.e2, face.e2), glm::dot(e3, e3)});
  const bool is_sliver = face.twice_area < 1e-3 * longest2;
  const Vec3d to_1 = glm::cross(face.e2, face.normal) / face.twice_area;
  const Vec3d to_2 = glm::cross(face.normal, face.e1) / face.twice_area;
  BasicQuadric<Real> base;
  with_count([&](const auto count) {
    OfWedge of_face;
    of_face.weight = static_cast<Real>(area);
    for (std::size_t j = 0; j < count; ++j) {
      const double s0 = weighted(wedges[0], j), s1 = weighted(wedges[1], j), s2 = weighted(wedges[2], j);
      Vec3d gradient(0.0);
      double offset = (s0 + s1 + s2) / 3.0;
      if (!is_sliver) {
        gradient = to_1 * (s1 - s0) + to_2 * (s2 - s0);
        offset = s0 - glm::dot(gradient, face.p);
      }
      const Linear<Real> value(glm::vec<3, Real>(gradient), static_cast<Real>(offset));
      base.add_square(value, of_face.weight);
      of_face.sum[j] = value.scaled(of_face.weight);
    }
    for (const std::uint32_t wedge : wedges) wedge_[wedge].add(of_face, count);
  });
  if (!base_.empty()) {
    for (const std::uint32_t wedge : wedges) base_[wedge] += base;
  }
  return base;
}

template <class Real, std::size_t C>
bool AttributeQuadrics<Real, C>::agree(const WedgeClasses& classes, const GroupLocks& locks) const {
  for (std::uint32_t i = 0; i < classes.count(); ++i) {
    const std::uint32_t w = classes.wedge(i), fixed = classes.fixed(classes.class_of(i));
    if (w == fixed || locks.is_wedge_locked[w] == 0) continue;
    for (std::size_t j = 0; j < count(); ++j) {
      if (scale_[j] > 0.0 && given(w)[j] != given(fixed)[j]) return false;
    }
  }
  return true;
}

template <class Real, std::size_t C>
double AttributeQuadrics<Real, C>::add_class(BasicQuadric<Real>& total, const OfWedge& sum, std::uint32_t fixed,
                                             const Vec3d& place) const {
  double error = 0.0;
  with_count([&](const auto count) {
    if (fixed == kNoId) {
      sum.add_best_to(total, count);
      return;
    }
    Values values{};
    for (std::size_t j = 0; j < count; ++j) values[j] = weighted(fixed, j);
    error = double{sum.evaluate(glm::vec<3, Real>(place), values.data(), count)};
  });
  return error;
}

template <class Real, std::size_t C>
typename AttributeQuadrics<Real, C>::OfWedge AttributeQuadrics<Real, C>::sum_of(const WedgeClasses& classes,
                                                                                std::uint32_t of) const {
  OfWedge sum = wedge_[classes.wedge(of)];
  for (std::uint32_t i = of + 1; i < classes.count(); ++i) {
    if (classes.class_of(i) != of) continue;
    with_count([&](const auto count) { sum.add(wedge_[classes.wedge(i)], count); });
  }
  return sum;
}

template <class Real, std::size_t C>
double AttributeQuadrics<Real, C>::add_classes(BasicQuadric<Real>& total, const WedgeClasses& classes,
                                               const Vec3d& given) const {
  double fixed_error = 0.0;
  for (std::uint32_t i = 0; i < classes.count(); ++i) {
    if (classes.is_first(i)) fixed_error += add_class(total, sum_of(classes, i), classes.fixed(i), given);
  }
  return fixed_error;
}

template <class Real, std::size_t C>
double AttributeQuadrics<Real, C>::add_pair(BasicQuadric<Real>& total, std::uint32_t x, std::uint32_t y,
                                            const GroupLocks& locks, const Vec3d& given) const {
  OfWedge sum = wedge_[x];
  with_count([&](const auto count) { sum.add(wedge_[y], count); });
  const std::uint32_t locked_y = locks.is_wedge_locked[y] != 0 ? y : kNoId;
  return add_class(total, sum, locks.is_wedge_locked[x] != 0 ? std::min(x, locked_y) : locked_y, given);
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::join(std::uint32_t into, std::uint32_t from) {
  with_count([&](const auto count) { wedge_[into].add(wedge_[from], count); });
  if (!base_.empty()) base_[into] += take_base(from);
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::join(const WedgeClasses& classes) {
  for (std::uint32_t i = 0; i < classes.count(); ++i) {
    const std::uint32_t w = classes.wedge(i), keeper = classes.keeper(classes.class_of(i));
    is_fitted_[keeper] = 1;
    if (w != keeper) join(keeper, w);
  }
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::fit(const OfWedge& sum, const Vec3d& place, Values& out) const {
  for (std::size_t j = 0; j < count(); ++j) {
    out[j] = scale_[j] > 0.0 ? double{sum.best(j, glm::vec<3, Real>(place))} / scale_[j] : 0.0;
  }
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::values_of(std::uint32_t wedge, bool is_locked, const Vec3d& place, Values& out) const {
  if (!is_locked && is_fitted_[wedge] != 0 && wedge_[wedge].weight > Real(0)) return fit(wedge_[wedge], place, out);
  for (std::size_t j = 0; j < count(); ++j) out[j] = scale_[j] > 0.0 ? double{given(wedge)[j]} : 0.0;
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::values_of(const WedgeClasses& classes, std::uint32_t of, const Vec3d& place,
                                           Values& out) const {
  const std::uint32_t fixed = classes.fixed(of);
  if (fixed != kNoId) return values_of(fixed, true, place, out);
  const OfWedge sum = sum_of(classes, of);
  if (!(sum.weight > Real(0))) return values_of(classes.keeper(of), false, place, out);
  fit(sum, place, out);
}

template <class Real, std::size_t C>
void AttributeQuadrics<Real, C>::write(std::uint32_t wedge, bool is_locked, const Vec3d& place,
                                       std::vector<float>& out) const {
  Values values{};
  values_of(wedge, is_locked, place, values);
  for (std::size_t j = 0; j < count(); ++j) {
    out.push_back(scale_[j] > 0.0 ? static_cast<float>(values[j]) : given(wedge)[j]);
  }
  if (!input_.layout.has_normal || is_locked) return;
  float* n = &out[out.size() - count()];
  const double x = n[0], y = n[1], z = n[2], length = std::sqrt(x * x + y * y + z * z);
  for (std::size_t k = 0; k < 3; ++k) {
    n[k] = length > 0.0 ? static_cast<float>(double{n[k]} / length) : given(wedge)[k];
  }
}

}  // namespace meshlode::builder
