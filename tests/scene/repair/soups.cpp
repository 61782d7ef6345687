// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/repair/soups.h"

#include <utility>

#include "lab/samples/samples.h"
#include "support/random.h"

namespace meshlode::test {

namespace {

/// Triangles between any three points of a lattice.
void add_anything(scene::Primitive& soup, RandomSource& random) {
  const std::uint32_t size = 2 + random.below(4);
  const std::uint32_t first = static_cast<std::uint32_t>(soup.positions.size());
  const std::uint32_t count = 4 + random.below(60);
  for (std::uint32_t v = 0; v < count; ++v) {
    soup.positions.emplace_back(random.below(size), random.below(size), random.below(size));
  }
  for (std::uint32_t corner = 3 * (1 + random.below(2 * count)); corner > 0; --corner) {
    soup.indices.push_back(first + random.below(count));
  }
}

/// A torus, some of whose triangles are gone, turned, there twice, or moved to another vertex.
void add_spoilt_torus(scene::Primitive& soup, RandomSource& random) {
  const scene::Primitive torus = lab::make_torus(5 + random.below(12), 4 + random.below(8));
  const auto first = static_cast<std::uint32_t>(soup.positions.size());
  const auto count = static_cast<std::uint32_t>(torus.positions.size());
  soup.positions.insert(soup.positions.end(), torus.positions.begin(), torus.positions.end());
  for (std::size_t i = 0; i < torus.indices.size(); i += 3) {
    std::uint32_t t[3] = {torus.indices[i], torus.indices[i + 1], torus.indices[i + 2]};
    const std::uint32_t fault = random.below(24);
    if (fault == 0) continue;
    if (fault == 1) std::swap(t[0], t[2]);
    if (fault == 2) t[random.below(3)] = random.below(count);
    for (std::uint32_t times = fault == 3 ? 2 : 1; times > 0; --times) {
      for (const std::uint32_t corner : t) soup.indices.push_back(first + corner);
      std::swap(t[0], t[1]);
    }
  }
}

}  // namespace

scene::Scene make_random_soup(std::uint64_t seed) {
  RandomSource random(seed);
  scene::Primitive soup;
  const std::uint32_t kind = random.below(3);
  if (kind != 0) add_anything(soup, random);
  if (kind != 1) add_spoilt_torus(soup, random);
  soup.material = MaterialId(0U);
  return lab::as_scene(lab::as_mesh(std::move(soup)));
}

}  // namespace meshlode::test
