// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/experiment/experiment.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "base/box.h"
#include "base/nearest_name.h"
#include "base/try.h"
#include "base/vec.h"
#include "lab/experiment/careless.h"
#include "lab/experiment/openmesh_decimater.h"

namespace meshlode::lab {

namespace {

Error usage(std::string detail) {
  return {ErrorCode::kUsage, "--care", std::move(detail)};
}

/// One "name=off".
Status set_care(std::string_view item, Care& care) {
  const std::size_t equals = item.find('=');
  const std::string_view name = item.substr(0, equals);
  const auto known =
      std::find_if(kCareNames.begin(), kCareNames.end(), [&](const CareName& one) { return one.name == name; });
  if (known == kCareNames.end()) {
    std::vector<std::string> names;
    for (const CareName& one : kCareNames) names.emplace_back(one.name);
    return usage("'" + std::string(name.substr(0, 64)) + "' is not something that a build can leave out" +
                 nearest_or_all(name, names));
  }
  const std::string_view value = equals == std::string_view::npos ? std::string_view{} : item.substr(equals + 1);
  if (value != "on" && value != "off")
    return usage("give " + std::string(name) + "=off or " + std::string(name) + "=on");
  care.*known->member = value == "on";
  return Ok{};
}

/// Names of the care that is left out.
std::vector<std::string> names_of_missing(const Care& care) {
  std::vector<std::string> names;
  for (const CareName& one : kCareNames) {
    if (!(care.*one.member)) names.emplace_back(one.name);
  }
  return names;
}

std::string words_of(const Experiment& experiment) {
  std::string text;
  for (const std::string& name : names_of_missing(experiment.care)) text += (text.empty() ? "without " : ", ") + name;
  if (experiment.simplifier != Simplifier::kOwn) {
    text += std::string(text.empty() ? "" : "; ") + "groups reduced by " + name_of(experiment.simplifier);
  }
  return text;
}

/// docs/schemas/info.schema.json, settings.experimental.
std::string record_of(const Experiment& experiment) {
  std::string names;
  for (const std::string& name : names_of_missing(experiment.care))
    names += (names.empty() ? "\"" : ",\"") + name + "\"";
  return "{\"care_left_out\":[" + names + "],\"simplifier\":\"" + name_of(experiment.simplifier) + "\"}";
}

/// The ball around the centre of the balls' box: what a smaller one is held against.
builder::Ball ball_around_box(std::span<const builder::Ball> balls) {
  if (balls.size() == 1) return balls[0];
  Box3d box;
  for (const builder::Ball& ball : balls) box.add({ball.center - ball.radius, ball.center + ball.radius});
  builder::Ball around{box.low + box.size() * 0.5, 0.0};
  for (const builder::Ball& ball : balls) {
    around.radius = std::max(around.radius, glm::length(ball.center - around.center) + ball.radius);
  }
  return around;
}

}  // namespace

Result<Care> parse_care(std::string_view text) {
  Care care;
  if (text == "all") return care;
  do {
    const std::size_t comma = text.find(',');
    TRY(set_care(text.substr(0, comma), care));
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    if (text.empty() && comma != std::string_view::npos) return usage("ends with a comma");
  } while (!text.empty());
  return care;
}

builder::BuildHooks hooks_of(const Experiment& experiment) {
  const Care& care = experiment.care;
  builder::BuildHooks hooks;
  hooks.record = record_of(experiment);
  hooks.words = words_of(experiment);
  hooks.separates_needles = care.needles;
  if (!care.spheres) hooks.enclosing_ball = ball_around_box;
  if (experiment.simplifier == Simplifier::kOpenMesh) {
    hooks.simplify_group = simplify_group_by_openmesh;
    hooks.heeds_all_options = false;
  } else {
    hooks.simplify_group = simplify_carelessly(care);
  }
  return hooks;
}

}  // namespace meshlode::lab
