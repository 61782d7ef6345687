// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/plan/count_wedges.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"

namespace meshlode::builder {

namespace {

void mix(std::uint64_t& hash, float value) {
  hash = mix64(hash + std::bit_cast<std::uint32_t>(value + 0.0F) + kGoldenGamma);
}

/// What a vertex's attributes add to the hash of its position. A primitive without one has the same everywhere.
std::uint64_t mix_attributes(std::uint64_t hash, const scene::Primitive& primitive, std::size_t vertex,
                             const AttributeLayout& layout) {
  if (layout.has_normal && !primitive.normals.empty()) {
    for (int k = 0; k < 3; ++k) mix(hash, primitive.normals[vertex][k]);
  }
  for (std::uint32_t set = 0; set < layout.uv_set_count; ++set) {
    const auto& uvs = primitive.uvs[layout.uv_set_source[set]];
    for (int k = 0; !uvs.empty() && k < 2; ++k) mix(hash, uvs[vertex][k]);
  }
  if (layout.has_color && !primitive.colors.empty()) {
    for (int k = 0; k < 4; ++k) mix(hash, primitive.colors[vertex][k]);
  }
  return hash;
}

std::uint64_t count_distinct(std::vector<std::uint64_t>& hashes) {
  std::sort(hashes.begin(), hashes.end());
  return static_cast<std::uint64_t>(std::unique(hashes.begin(), hashes.end()) - hashes.begin());
}

}  // namespace

WedgeCounts count_wedges(const scene::SourceMesh& mesh, const AttributeLayout& layout) {
  constexpr std::uint64_t kSample = std::uint64_t{1} << 17U;
  std::uint64_t vertices = 0;
  for (const scene::Primitive& primitive : mesh.primitives) vertices += primitive.positions.size();
  std::uint32_t bits = 0;
  while (vertices >> bits > kSample) ++bits;
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  std::vector<std::uint64_t> positions, wedges;
  for (const scene::Primitive& primitive : mesh.primitives) {
    constexpr std::size_t kChunk = 4 * kLoopGrain;
    struct Sample {
      std::vector<std::uint64_t> positions, wedges;
    };
    std::vector<Sample> samples(chunk_count(primitive.positions.size(), kChunk));
    const auto hash_chunk = [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vec3d& p = primitive.positions[v];
        std::uint64_t hash = 0;
        for (int k = 0; k < 3; ++k) hash = mix64(hash + std::bit_cast<std::uint64_t>(p[k] + 0.0) + kGoldenGamma);
        if ((hash & mask) != 0) continue;
        samples[chunk].positions.push_back(hash);
        if (layout.stride() > 0) samples[chunk].wedges.push_back(mix_attributes(hash, primitive, v, layout));
      }
    };
    parallel_for_each_chunk(primitive.positions.size(), kChunk, hash_chunk);
    for (const Sample& sample : samples) {
      positions.insert(positions.end(), sample.positions.begin(), sample.positions.end());
      wedges.insert(wedges.end(), sample.wedges.begin(), sample.wedges.end());
    }
  }
  const std::uint64_t count = count_distinct(positions);
  return {count << bits, std::max(count, count_distinct(wedges)) << bits};
}

}  // namespace meshlode::builder
