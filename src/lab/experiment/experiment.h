// SPDX-License-Identifier: GPL-3.0-or-later
// What only a study of the build wants: care that it leaves out, to see what care costs, and another simplifier to
// stand beside ours (docs/log/numerics.md, "What care costs"). The builder knows neither: it has hooks for
// them. An asset of such a build says so and is for no scene that ships.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <meshlode/result.h>

#include "base/enum_names.h"
#include "builder/hooks.h"

namespace meshlode::lab {

/// The care that a build takes with numbers.
struct Care {
  bool double_quadrics = true;  ///< quadrics are summed and solved in doubles; else in floats
  bool fallback = true;         ///< an ill-conditioned or far-off minimum is not taken: a point of the edge is
  bool spheres = true;          ///< spheres are near the smallest that enclose; else around the box's centre
  bool needles = true;          ///< thin triangles that the grid would flatten keep their corners apart

  bool operator==(const Care&) const = default;
};

struct CareName {
  const char* name;
  bool Care::*member;
};
constexpr std::array<CareName, 4> kCareNames{{
    {"double-quadrics", &Care::double_quadrics},
    {"fallback", &Care::fallback},
    {"spheres", &Care::spheres},
    {"needles", &Care::needles},
}};

/// "all", or "needles=off,spheres=on": what is not named is on. Error: kUsage.
[[nodiscard]] Result<Care> parse_care(std::string_view text);

/// Which simplifier reduces a group.
enum class Simplifier : std::uint8_t { kOwn, kOpenMesh };
constexpr std::array<EnumName<Simplifier>, 2> kSimplifierNames{
    {{Simplifier::kOwn, "own"}, {Simplifier::kOpenMesh, "openmesh"}}};
[[nodiscard]] constexpr const char* name_of(Simplifier simplifier) {
  return name_in(kSimplifierNames, simplifier);
}

struct Experiment {
  Care care;
  Simplifier simplifier = Simplifier::kOwn;

  bool operator==(const Experiment&) const = default;
  /// As every build is that nobody studies.
  [[nodiscard]] bool is_none() const { return *this == Experiment{}; }
};

/// What a build is to be given for it. \pre not is_none()
[[nodiscard]] builder::BuildHooks hooks_of(const Experiment& experiment);

}  // namespace meshlode::lab
