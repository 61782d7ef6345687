// SPDX-License-Identifier: GPL-3.0-or-later
// What a file says of its triangles by its size, its lines and its rows, whatever an importer makes of it.
#include "scene/count/file_triangles.h"

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace meshlode::scene {
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
      EXPECT_EQ(bounds_of(bytes + std::string(49, '\0'), "a.b.STL"), Bounds(120, 120));
      const std::uint64_t with_cut = count == '\xFF' ? 121 : 120;  // that the header counts more says what is cut off
      EXPECT_EQ(bounds_of(bytes + std::string(49, 'x'), "a.b.STL"), Bounds(with_cut, with_cut));
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
  EXPECT_EQ(bounds_of(text, "a.obj"), Bounds(5, kNoLimit));
  EXPECT_EQ(bounds_of("F 1 2 3\nfx 1 2 3\nf 1 2 x\nf 1 2 1 2\nf 1 2 1 3\n", "a.obj"), Bounds(1, kNoLimit));
  EXPECT_EQ(bounds_of("\xEF\xBB\xBF"
                      "f 1 2 3",
                      "a.obj"),
            Bounds(1, kNoLimit));
}

TEST(FileTriangles, OfAnObjResolveWhatCountsFromTheEnd) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  EXPECT_EQ(bounds_of(corners + "f 1 2 3\nf 1 3 -1\n", "a.obj"), Bounds(1, kNoLimit));
  EXPECT_EQ(bounds_of(corners + "f -3 -2 -1\nV 0 0 0\nf 3 -3 -2\nv 0 1 0\nf 3 -3 -2\n", "a.obj"), Bounds(2, kNoLimit));
}

TEST(FileTriangles, OfAnObjStandBehindNamesThatEndWithABackslash) {
  for (const char* name : {"g", "o", "usemtl", "mtllib", "# in", "#"}) {
    EXPECT_EQ(bounds_of(std::string(name) + " C:\\foo\\\nf 1 2 3\n", "a.obj"), Bounds(1, kNoLimit)) << name;
  }
  EXPECT_EQ(bounds_of("g a \\\nf 1 2 3\n", "a.obj"), Bounds(0, kNoLimit)) << "more names";
  EXPECT_EQ(bounds_of("v 0 0 0 \\\nf 1 2 3\n", "a.obj"), Bounds(0, kNoLimit)) << "part of the vertex";
  EXPECT_EQ(bounds_of("f 1 2 \\\n\\\r\n1\\ \nf 1 2 3\\", "a.obj"), Bounds(0, kNoLimit)) << "one statement, no face";
}

TEST(FileTriangles, OfAnStlThatIsTextWhateverItBeginsWith) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const std::string nul(4, '\0');
  for (const std::string& text :
       {facet, facet + facet.substr(0, 5), "solid a" + nul + "\n" + facet, "solid\fa\n" + facet,
        "solid\n" + facet + nul, "solid\va\n" + facet + std::string(2000, '\0')}) {
    EXPECT_EQ(bounds_of(text, "a.stl"), Bounds(1, kNoLimit)) << text.substr(0, 30);
  }
  std::string many;
  while (many.size() < 4600) many += facet;
  EXPECT_EQ(bounds_of(many, "a.stl"), Bounds(many.size() / facet.size(), kNoLimit));
}

TEST(FileTriangles, OfABinaryStlThatIsCutShortAreOneMore) {
  std::string bytes(84, '\0');
  bytes[80] = 2;
  bytes += facet(1);
  EXPECT_EQ(bounds_of(bytes + facet(2).substr(0, 40), "a.stl"), Bounds(2, 2));
  EXPECT_EQ(bounds_of(bytes, "a.stl"), Bounds(1, 1)) << "writers that do not seek state what they like";
  EXPECT_EQ(bounds_of(bytes + std::string(40, '\0'), "a.stl"), Bounds(1, 1)) << "padded";
  bytes[80] = 1;
  EXPECT_EQ(bounds_of(bytes + "trailer", "a.stl"), Bounds(1, 1));
}

const std::string kPlyCorners = "property list uchar short vertex_indices\n";

std::string ply(const std::string& format, const std::string& more) {
  return "ply\nformat " + format + " 1.0\nelement vertex 2\nproperty float x\n" + more + "end_header\n";
}

TEST(FileTriangles, OfAPlyAreRowsOfThreeCornersAndMore) {
  const std::string faces =
      ply("ascii", "comment element face 9\nelement face 4\nproperty list uchar int tags\n" + kPlyCorners);
  const std::string rows = "0\n1\n0 3 0 1 2\n2 5 6 4 0 1 2 3 7 7\n\n3 1 2 3 2 0 1\n0 3 0 1 1\n";
  EXPECT_EQ(bounds_of(faces + rows, "a.ply"), Bounds(2, kNoLimit));
  EXPECT_EQ(bounds_of(faces + rows, "PLY"), Bounds(2, kNoLimit)) << "by content";
  EXPECT_EQ(bounds_of("\xEF\xBB\xBF" + faces + rows.substr(0, 20), "a.ply"), Bounds(1, kNoLimit)) << "cut short";
  std::string cr = faces + rows;
  for (char& c : cr) c = c == '\n' ? '\r' : c;
  EXPECT_EQ(bounds_of(cr, "a.ply"), Bounds(2, kNoLimit));
  EXPECT_EQ(bounds_of(ply("ascii", "element face 1\n" + kPlyCorners) + "0\n1\n2 0 1\n", "a.ply"), Bounds(0, kNoLimit));
  EXPECT_EQ(bounds_of(ply("ascii", "element face 2147483647\n"), "a.ply"), Bounds(0, kNoLimit));
  EXPECT_EQ(bounds_of(ply("ascii", "element face 99999999999\n" + kPlyCorners), "a.ply"), Bounds(0, kNoLimit));
  EXPECT_EQ(bounds_of("ply\nformat ascii 1.0\nelement face 6", "a.ply"), Bounds(0, kNoLimit));
}

TEST(FileTriangles, OfABinaryPlyAreRowsToo) {
  const std::string vertices(8, '\x41');
  const auto face = [](const std::string& corners, bool is_big_endian) {
    std::string out(1, static_cast<char>(corners.size()));
    for (const char c : corners) out += is_big_endian ? std::string{'\0', c} : std::string{c, '\0'};
    return out;
  };
  for (const bool is_big : {false, true}) {
    const std::string head =
        ply(is_big ? "binary_big_endian" : "binary_little_endian", "element face 3\n" + kPlyCorners);
    const auto body = [&](const std::string& last) {
      return vertices + face({0, 1}, is_big) + face({0, 1, 2, 3}, is_big) + face(last, is_big);
    };
    EXPECT_EQ(bounds_of(head + body({2, 1, 0}), "a.ply"), Bounds(2, kNoLimit));
    EXPECT_EQ(bounds_of(head + body({1, 1, 0}), "a.ply"), Bounds(1, kNoLimit));
    EXPECT_EQ(bounds_of((head + body({2, 1, 0})).substr(0, head.size() + 28), "a.ply"), Bounds(1, kNoLimit));
  }
}

TEST(FileTriangles, AreNotToldByGltf) {
  EXPECT_EQ(bounds_of("glTF", "a.glb"), Bounds(7, 7));
  EXPECT_EQ(bounds_of("", ""), Bounds(7, 7));
}

}  // namespace
}  // namespace meshlode::scene
