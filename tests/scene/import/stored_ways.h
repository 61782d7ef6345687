// SPDX-License-Identifier: GPL-3.0-or-later
// One mesh stored in many ways: as floats, quantized, and compressed by Draco's and meshoptimizer's own encoders.
#pragma once

#include <string>
#include <vector>

namespace meshlode::testing {

struct StoredWay {
  std::string name;
  std::string glb;
  double precision = 0.0;  ///< how far a coordinate may be off, mesh units; 0: nothing is lost
};

/// A field of n × n quads, 8 n units wide, with normals and one UV set. Coordinates are whole numbers, normals and UVs
/// those that bytes and shorts hold, so that all but the last ways lose nothing. The first is the plain one.
/// \pre n <= 200, for indices of 16 bits
[[nodiscard]] std::vector<StoredWay> store_in_all_ways(int n);

}  // namespace meshlode::testing
