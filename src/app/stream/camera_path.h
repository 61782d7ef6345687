// SPDX-License-Identifier: GPL-3.0-or-later
// Where the camera is in each frame: from a file of rows, or one of a few usual paths through a scene.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/stream/scene.h"
#include "base/enum_names.h"
#include "base/vec.h"

namespace meshlode::app {

/// The camera moves evenly from row to row. A row that cuts is a jump: until its time the camera stays where the row
/// before it is.
struct PathRow {
  double seconds = 0.0;
  Vec3d eye{0.0}, target{0.0};
  double fovy = 0.0;  ///< radians
  bool is_cut = false;
};

struct PathFrame {
  std::int64_t time_us = 0;  ///< from the first frame
  Vec3d eye{0.0}, target{0.0};
  double fovy = 0.0;
  bool is_jump = false;  ///< the first frame, and the first one after a cut
};

constexpr double kUsualFovyDegrees = 60.0;
constexpr std::uint32_t kMostFrames = 100000;

/// Rows `t,ex,ey,ez,tx,ty,tz[,fovy][,cut]`: seconds, eye and target in world units, the vertical field of view in
/// degrees (60 where it is left out). A first line that begins with t is a heading. `where` names the text in errors,
/// with the line: kInvalid for what is no such row, times that do not grow, an eye in its target, and more than
/// kMostFrames rows.
[[nodiscard]] Result<std::vector<PathRow>> parse_path(std::string_view text, const std::string& where);

/// Frames at i / fps seconds, i = 0, 1, …, up to the last row. Error: kInvalid where there are more than kMostFrames.
[[nodiscard]] Result<std::vector<PathFrame>> sample_path(std::span<const PathRow> rows, std::uint32_t fps,
                                                         const std::string& where);

enum class BuiltinPath : std::uint8_t {
  kFly,       ///< from 20 radii of the scene to 1.3 in five seconds, then around it in five
  kWalk,      ///< over the objects along the longer side of the scene, 2.5 radii of an object a second, looking ahead
  kTurn,      ///< half a second in the middle, then around oneself in a second
  kTeleport,  ///< ten places, a second each
};
inline constexpr std::array<EnumName<BuiltinPath>, 4> kBuiltinPathNames{{{BuiltinPath::kFly, "fly"},
                                                                         {BuiltinPath::kWalk, "walk"},
                                                                         {BuiltinPath::kTurn, "turn"},
                                                                         {BuiltinPath::kTeleport, "teleport"}}};
[[nodiscard]] std::vector<PathRow> builtin_path(BuiltinPath path, const StreamScene& scene);

}  // namespace meshlode::app
