// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/experiment.h"

#include <algorithm>

#include "base/nearest_name.h"

namespace meshlode::builder {

namespace {

Error usage(std::string detail) {
  return {ErrorCode::kUsage, "care", std::move(detail)};
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
    return usage("'" + std::string(name.substr(0, 64)) + "' is no care of a build" + nearest_or_all(name, names));
  }
  const std::string_view value = equals == std::string_view::npos ? std::string_view{} : item.substr(equals + 1);
  if (value != "on" && value != "off")
    return usage("give " + std::string(name) + "=off or " + std::string(name) + "=on");
  care.*known->member = value == "on";
  return Ok{};
}

}  // namespace

Result<Care> parse_care(std::string_view text) {
  Care care;
  if (text == "all") return care;
  do {
    const std::size_t comma = text.find(',');
    if (const Status set = set_care(text.substr(0, comma), care); !set) return set.error();
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    if (text.empty() && comma != std::string_view::npos) return usage("ends with a comma");
  } while (!text.empty());
  return care;
}

std::string describe(const Experiment& experiment) {
  std::string text;
  for (const std::string& name : names_of_missing(experiment.care)) text += (text.empty() ? "without " : ", ") + name;
  if (experiment.simplifier != Simplifier::kOwn) {
    text += std::string(text.empty() ? "" : "; ") + "groups reduced by " + name_of(experiment.simplifier);
  }
  return text;
}

std::vector<std::string> names_of_missing(const Care& care) {
  std::vector<std::string> names;
  for (const CareName& one : kCareNames) {
    if (!(care.*one.member)) names.emplace_back(one.name);
  }
  return names;
}

}  // namespace meshlode::builder
