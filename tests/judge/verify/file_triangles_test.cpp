// SPDX-License-Identifier: GPL-3.0-or-later
// What a file says of its triangles by its size or its lines, whatever an importer makes of it.
#include "judge/verify/file_triangles.h"

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace meshlode::judge {
namespace {

using Bounds = std::pair<std::uint64_t, std::uint64_t>;
constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

Bounds bounds_of(const std::string& bytes, const char* name) {
  const auto found = count_file_triangles({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name);
  return found ? Bounds{found->at_least, found->at_most} : Bounds{7, 7};
}

/// A facet with three corners, the last of which is at x, 1, 0.
std::string facet(float x) {
  const std::array<float, 12> numbers{0, 0, 0, 0, 0, 0, 0, 1, 0, x, 1, 0};
  return std::string(reinterpret_cast<const char*>(numbers.data()), sizeof numbers) + std::string(2, '\0');
}

TEST(FileTriangles, OfABinaryStlGoBySize) {
  for (const std::string head : {"part", "solid part"}) {
    for (const char count : {'\0', '\5', '\x78', '\xFF'}) {
      std::string bytes = head + std::string(84 - head.size(), '\0');
      bytes[80] = count;
      for (int i = 1; i <= 120; ++i) bytes += facet(static_cast<float>(i));
      EXPECT_EQ(bounds_of(bytes, "a.stl"), Bounds(120, 120)) << head << int{count};
      EXPECT_EQ(bounds_of(bytes + std::string(49, 'x'), "a.b.STL"), Bounds(120, 120));
      const std::string odd = facet(-0.0F) + facet(std::numeric_limits<float>::quiet_NaN());
      EXPECT_EQ(bounds_of(bytes + odd, "a.stl"), Bounds(120, 122)) << "a corner twice, and one that is nowhere";
    }
  }
  EXPECT_EQ(bounds_of(std::string(83, '\0'), "a.stl"), Bounds(0, 0));
}

TEST(FileTriangles, OfATextStlAreNoFewerThanItsFacets) {
  const auto facet_at = [](const char* corner) {
    return std::string(" facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex +1 0 0\nvertex ") + corner +
           "\nendloop\nendfacet\n";
  };
  const std::string text = "solid vertex\n" + facet_at("0 1e0 0") + facet_at("1.0 0 0e5") + facet_at("0 x 0") +
                           facet_at("0 1 0") + "endsolid vertex\n";
  for (const char* before : {"", "\xEF\xBB\xBF", "\n \n"}) {
    for (const char* end : {"\n", "\r", "\r\n"}) {
      std::string folded = before;
      for (const char c : text) folded += c == '\n' ? std::string(end) : std::string(1, c);
      EXPECT_EQ(bounds_of(folded, "a.stl"), Bounds(2, kNoLimit));
      for (char& c : folded) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
      EXPECT_EQ(bounds_of(folded, "a.stl"), Bounds(2, kNoLimit));
    }
  }
}

TEST(FileTriangles, OfAnObjAreNoFewerThanItsFaces) {
  const std::string text =
      "v 0 0 0\nf 1 2 3\rf 1/1 2/2 3/3 4/4\r\n  f 1 2 # 3\nf 1 2 \\\n3\nf 1 2 3 \\\n4\nfo 1 2 3\nf 1/1 1/2 2/3\nf\n#f "
      "1 2 3";
  EXPECT_EQ(bounds_of(text, "a.obj"), Bounds(3, kNoLimit));
  EXPECT_EQ(bounds_of("\xEF\xBB\xBF"
                      "f 1 2 3",
                      "a.obj"),
            Bounds(1, kNoLimit));
}

TEST(FileTriangles, OfAPlyAreThereWhereItStatesFaces) {
  const std::string head = "ply\rformat ascii 1.0\relement vertex 12\r";
  EXPECT_EQ(bounds_of(head + "element face 6\rend_header\r", "a.ply"), Bounds(1, kNoLimit));
  EXPECT_EQ(bounds_of(head + "element face 00\rend_header\relement face 2\r", "a.ply"), Bounds(0, kNoLimit));
  EXPECT_EQ(bounds_of(head, "a.ply"), Bounds(0, kNoLimit));
}

TEST(FileTriangles, AreNotToldByGltf) {
  EXPECT_EQ(bounds_of("glTF", "a.glb"), Bounds(7, 7));
  EXPECT_EQ(bounds_of("", ""), Bounds(7, 7));
}

}  // namespace
}  // namespace meshlode::judge
