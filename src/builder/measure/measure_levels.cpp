// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/measure_levels.h"

#include <utility>

#include "builder/measure/level_meter.h"

namespace meshlode::builder {

void measure_levels(const PreparedMesh& mesh, SourceTree source, CanonicalForm& form, double margin, LodDag& dag,
                    std::size_t rounds, std::span<const double> least) {
  LevelMeter meter(mesh, std::move(source), form, margin, rounds, least, dag);
  for (std::size_t end = dag.groups.size(); end > 0;) {
    std::size_t begin = end - 1;
    while (begin > 0 && dag.groups[begin - 1].level == dag.groups[begin].level) --begin;
    meter.measure_level(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
    end = begin;
  }
}

}  // namespace meshlode::builder
