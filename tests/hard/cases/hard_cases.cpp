// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "hard_case.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

std::span<const HardCase> hard_cases() {
  static const std::vector<HardCase> all = [] {
    std::vector<HardCase> cases;
    for (auto* room : {placement_cases, scale_cases, sliver_cases, topology_cases, crossing_cases, flat_cases,
                       value_cases, size_cases, attribute_cases, instance_cases, view_cases}) {
      for (HardCase& one : room()) cases.push_back(std::move(one));
    }
    return cases;
  }();
  return all;
}

Sample sample_of(scene::Primitive shape) {
  Sample sample;
  sample.scene = lab::as_scene(lab::as_mesh(std::move(shape)));
  return sample;
}

}  // namespace meshlode::test::hard
