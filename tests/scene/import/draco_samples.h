// SPDX-License-Identifier: GPL-3.0-or-later
// Small meshes compressed by Draco itself, for tests of the decoder's guard.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace meshlode::testing {

struct DracoSample {
  std::vector<std::uint8_t> bytes;
  std::uint32_t point_count = 0;
  std::uint32_t face_count = 0;
  std::vector<float> positions;  ///< 3 per point as decoded from the encoder's own result
  std::uint32_t position_id = 0, normal_id = 1, uv_id = 2;
};

/// A bumpy grid of n × n quads with normals and UVs. `edgebreaker` false: the sequential method.
/// `speed` 0 … 10 picks other predictors; quantization_bits 0 keeps positions as floats.
[[nodiscard]] DracoSample make_draco_sample(int n, bool edgebreaker, int speed, int quantization_bits);

/// One mesh stored twice: as plain accessors, a corner after the other, and compressed by Draco's encoder.
struct DracoPair {
  std::string plain_glb;
  std::string draco_glb;
  std::uint32_t face_count = 0;
};

/// Two bumpy patches of n × n quads, one with a hole, with positions, normals, two UV sets and colours of bytes. UVs,
/// normals and colours have seams of their own, so that corners at one position differ. Vertices are at whole x and y.
/// quantization_bits 0: floats stay as they are.
[[nodiscard]] DracoPair make_draco_pair(int n, bool edgebreaker, int speed, int quantization_bits);

/// A whole GLB around a sample.
[[nodiscard]] std::string make_draco_glb(const DracoSample& sample);

}  // namespace meshlode::testing
