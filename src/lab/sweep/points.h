// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep turns, and the points that it looks at: the baseline, one factor at a time, and corners where factors
// may interact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/enum_names.h"

namespace meshlode::lab {

enum class KnobKind : std::uint8_t {
  kBuild,  ///< an option of `build`
  kDraw,   ///< an option of `render`: the asset is the same
  kStudy,  ///< an option of `study` alone: marked experimental in the asset
};
inline constexpr std::array<EnumName<KnobKind>, 3> kKnobKindNames{
    {{KnobKind::kBuild, "build"}, {KnobKind::kDraw, "draw"}, {KnobKind::kStudy, "study"}}};

struct KnobValue {
  std::string word;
  double build_factor = 1.0;  ///< expected build time over that of the usual value: for the plan alone
  double worth = 0.0;         ///< points are planned in the order of what they are worth
};

struct Knob {
  std::string name, title, option, unit;
  KnobKind kind = KnobKind::kBuild;
  std::size_t usual = 0;          ///< of `values`
  std::vector<KnobValue> values;  ///< in their own order: from cheap to dear, or from fine to coarse
  bool is_of_pages = false;       ///< how pages lie on disk alone: what an asset decodes to is the same
  bool is_of_accuracy = false;    ///< what a sweep is for: a short budget turns these first
  bool is_drawn_too = false;      ///< `render` takes the option as well
};

/// What the knobs' values are chosen by.
struct SceneFacts {
  double largest_diagonal = 0.0;  ///< of the meshes, mesh units
  bool has_normals = false;       ///< some mesh stores normals as the usual settings have it
  bool has_uvs = false;
};

/// Budgets of attributes that the scene does not store are left out. `chosen`: names of knobs; none: all.
[[nodiscard]] std::vector<Knob> make_knobs(const SceneFacts& facts, std::span<const std::string> chosen = {});
/// A knob that the scene gives nothing to turn.
struct IdleKnob {
  std::string name;
  const char* why = "";
};
/// Those of `chosen` that make_knobs() leaves out.
[[nodiscard]] std::vector<IdleKnob> find_idle_knobs(const SceneFacts& facts, std::span<const std::string> chosen = {});
/// Every name that there is.
[[nodiscard]] std::vector<std::string> all_knob_names();

enum class PointKind : std::uint8_t { kBaseline, kOneFactor, kCorner };
inline constexpr std::array<EnumName<PointKind>, 3> kPointKindNames{
    {{PointKind::kBaseline, "baseline"}, {PointKind::kOneFactor, "one_factor"}, {PointKind::kCorner, "corner"}}};

/// One value of each knob.
struct Point {
  PointKind kind = PointKind::kBaseline;
  std::vector<std::size_t> values;  ///< of each knob's values, in the order of the knobs
  double worth = 0.0;
};

/// The baseline first; no two are equal.
[[nodiscard]] std::vector<Point> make_points(std::span<const Knob> knobs);

/// The point's settings in words: what a finished measurement is known by.
[[nodiscard]] std::string settings_key(std::span<const Knob> knobs, const Point& point);
/// Those that the asset depends on.
[[nodiscard]] std::string build_key(std::span<const Knob> knobs, const Point& point);
/// Those that what it decodes to may depend on.
[[nodiscard]] std::string content_key(std::span<const Knob> knobs, const Point& point);
/// 16 hexadecimal digits, the same for the same settings whatever else is in the sweep.
[[nodiscard]] std::string point_id(std::span<const Knob> knobs, const Point& point);
/// "baseline", or what differs from it: "codec strips, preset best".
[[nodiscard]] std::string point_label(std::span<const Knob> knobs, const Point& point);
[[nodiscard]] std::vector<std::string> changed_knobs(std::span<const Knob> knobs, const Point& point);
[[nodiscard]] bool is_experimental(std::span<const Knob> knobs, const Point& point);

/// `build`, or `study` where the point is experimental.
[[nodiscard]] const char* build_verb(std::span<const Knob> knobs, const Point& point);
/// Options that are not the usual ones: "--codec", "none", …
[[nodiscard]] std::vector<std::string> build_arguments(std::span<const Knob> knobs, const Point& point);
[[nodiscard]] std::vector<std::string> draw_arguments(std::span<const Knob> knobs, const Point& point);
/// Expected build time over the baseline's.
[[nodiscard]] double build_factor(std::span<const Knob> knobs, const Point& point);
/// A knob's word; empty where there is no such knob.
[[nodiscard]] std::string word_of(std::span<const Knob> knobs, const Point& point, const std::string& knob);
/// The number that a knob's word is; `otherwise` where there is no such knob or the word is no number.
[[nodiscard]] double number_of(std::span<const Knob> knobs, const Point& point, const std::string& knob,
                               double otherwise);

}  // namespace meshlode::lab
