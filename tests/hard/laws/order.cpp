// SPDX-License-Identifier: GPL-3.0-or-later
// What the order of a file's lists may not change: prepare welds and sorts vertices by grid point, attributes and exact
// position, and triangles by what came of that (src/builder/prepare/weld.cpp).
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "base/random.h"
#include "laws/outcomes.h"
#include "laws/same_mesh.h"

namespace meshlode::test::hard {

namespace {

std::vector<std::uint32_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  SplitMix64 random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

template <class T>
void permute(std::vector<T>& values, const std::vector<std::uint32_t>& new_place) {
  if (values.empty()) return;
  std::vector<T> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[new_place[i]] = values[i];
  values = std::move(out);
}

void for_each_primitive(Sample& sample, auto&& change) {
  for (scene::SourceMesh& mesh : sample.scene.meshes) {
    for (scene::Primitive& primitive : mesh.primitives) change(primitive);
  }
}

float negative_zero(float x) {
  return x == 0.0F ? -0.0F : x;
}

}  // namespace

LawResult check_renumbered(const Built& base) {
  Sample sample = base.sample;
  for_each_primitive(sample, [](scene::Primitive& primitive) {
    const std::vector<std::uint32_t> place = shuffled(primitive.positions.size(), 3);
    permute(primitive.positions, place);
    permute(primitive.normals, place);
    for (auto& uvs : primitive.uvs) permute(uvs, place);
    permute(primitive.colors, place);
    for (std::uint32_t& v : primitive.indices) v = place[v];
  });
  return same_bytes(base, std::move(sample));
}

LawResult check_reordered(const Built& base) {
  Sample sample = base.sample;
  for_each_primitive(sample, [](scene::Primitive& primitive) {
    const std::vector<std::uint32_t> place = shuffled(primitive.indices.size() / 3, 4);
    std::vector<std::uint32_t> indices(primitive.indices.size());
    for (std::size_t t = 0; t < place.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) indices[3 * std::size_t{place[t]} + k] = primitive.indices[3 * t + k];
    }
    primitive.indices = std::move(indices);
  });
  return same_bytes(base, std::move(sample));
}

LawResult check_turned_corners(const Built& base) {
  Sample sample = base.sample;
  for_each_primitive(sample, [](scene::Primitive& primitive) {
    for (std::size_t t = 0; 3 * t + 2 < primitive.indices.size(); ++t) {
      const auto first = primitive.indices.begin() + static_cast<std::ptrdiff_t>(3 * t);
      std::rotate(first, first + static_cast<std::ptrdiff_t>(t % 3), first + 3);
    }
  });
  return same_bytes(base, std::move(sample));
}

LawResult check_unused_vertex(const Built& base) {
  Sample sample = base.sample;
  if (sample.scene.meshes.empty() || sample.scene.meshes[0].primitives.empty()) return not_asked("there is no mesh");
  scene::Primitive& primitive = sample.scene.meshes[0].primitives.back();
  primitive.positions.emplace_back(1e30, -1e30, 3.0);
  if (!primitive.normals.empty()) primitive.normals.emplace_back(0.0F, 0.0F, -1.0F);
  for (auto& uvs : primitive.uvs) {
    if (!uvs.empty()) uvs.emplace_back(77.0F, -1e6F);
  }
  if (!primitive.colors.empty()) primitive.colors.emplace_back(0.25F, 0.5F, 0.125F, 0.5F);
  const Result<Built> other = build_sample(std::move(sample));
  if (!other) return broken("refused: " + other.error().message());
  Change change;
  change.unused_vertices = 1;
  const Comparison compared = compare_meshes(*base.asset, MeshId(0U), *other->asset, MeshId(0U), change);
  return compared.difference.empty() ? kept() : broken(compared.difference);
}

LawResult check_negative_zeros(const Built& base) {
  Sample sample = base.sample;
  std::size_t zeros = 0;
  for_each_primitive(sample, [&](scene::Primitive& primitive) {
    for (Vec3d& p : primitive.positions) {
      for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] != 0.0) continue;
        p[axis] = -0.0;
        ++zeros;
      }
    }
    for (Vec3f& n : primitive.normals) n = {negative_zero(n.x), negative_zero(n.y), negative_zero(n.z)};
    for (auto& uvs : primitive.uvs) {
      for (Vec2f& uv : uvs) uv = {negative_zero(uv.x), negative_zero(uv.y)};
    }
  });
  if (zeros == 0) return not_asked("no coordinate is 0");
  return same_bytes(base, std::move(sample));
}

}  // namespace meshlode::test::hard
