// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/triangle_materials.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

/// Adds one list after the other, as the pool does, and compares with a plain list.
void expect_a_list(const std::vector<std::vector<std::uint32_t>>& lists) {
  TriangleMaterials materials;
  materials.expect(100);
  std::vector<std::uint32_t> plain;
  for (const std::vector<std::uint32_t>& list : lists) {
    materials.add(list);
    for (std::size_t i = 0; i < list.size(); ++i) materials.set(plain.size() + i, list[i]);
    plain.insert(plain.end(), list.begin(), list.end());
    ASSERT_EQ(materials.size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(materials[i], plain[i]) << i;
  }
}

TEST(TriangleMaterials, AreAListHoweverManyThereAre) {
  expect_a_list({{}});
  expect_a_list({{7, 7, 7}, {7}, {}, {7, 7}});
  expect_a_list({{7, 7, 7}, {8}, {7, 7}});
  expect_a_list({{7, 7}, {}, {7, 9, 7}, {1}, {1, 1}});
  expect_a_list({{}, {3, 4}, {4, 4}});
}

}  // namespace
}  // namespace meshlode::builder
