// SPDX-License-Identifier: GPL-3.0-or-later
// STL as its users write it: what the header says is believed only where the size agrees.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "polygon_support.h"

namespace meshlode::testing {
namespace {

using Facets = std::vector<std::array<float, 9>>;
using StlAsWritten = PolygonFiles;

const Facets kTwo{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, 0, 0, 1, 1, 0, 0, 1, 0}};

std::string binary(std::uint32_t stated, const std::vector<std::uint16_t>& attributes = {0, 0},
                   const std::string& header = "solid but binary") {
  std::string bytes = header;
  bytes.resize(80, '\0');
  put(bytes, stated);
  for (std::size_t i = 0; i < kTwo.size(); ++i) {
    bytes.append(12, '\0');
    for (const float f : kTwo[i]) put(bytes, f);
    put(bytes, attributes[i]);
  }
  return bytes;
}

std::string text(const std::string& end, bool is_upper = false) {
  std::string out = "solid part";
  const auto add = [&](const std::string& line) { out += end + line; };
  for (const auto& facet : kTwo) {
    add("facet normal 0 0 -1.#IND");
    add("outer loop");
    for (std::size_t c = 0; c < 9; c += 3) {
      add("vertex " + std::to_string(facet[c]) + " +" + std::to_string(facet[c + 1]) + " 0.0E+00");
    }
    add("endloop");
    add("endfacet");
  }
  add("endsolid part" + end);
  if (is_upper) {
    for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return out;
}

TEST_F(StlAsWritten, TheSizeSaysHowManyFacetsThereAre) {
  for (const std::uint32_t stated : {0U, 1U, 2U, 3U, 4000000000U, 0xFFFFFFFFU}) {
    const auto scene = read("a.stl", binary(stated));
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(triangle_count(*scene), 2U);
    EXPECT_EQ(scene->triangles_in_file, 2U);
    const std::string said = "facet count: the header says " + std::to_string(stated) + ", the file has 2; ";
    EXPECT_EQ(all_left_out(*scene), stated == 2 ? "" : said);
  }
}

TEST_F(StlAsWritten, WhatFollowsTheLastFacetIsNamed) {
  const auto scene = read("a.stl", binary(2) + "more than nothing");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(triangle_count(*scene), 2U);
  EXPECT_EQ(all_left_out(*scene), "17 bytes: they follow the last whole facet; ");
  std::string cut = binary(2);
  cut.resize(cut.size() - 1);
  const auto less = read("a.stl", cut);
  ASSERT_TRUE(less) << describe(less);
  EXPECT_EQ(triangle_count(*less), 1U);
  EXPECT_EQ(less->left_out.size(), 2U);
  EXPECT_FALSE(read("a.stl", binary(2).substr(0, 83)));
}

TEST_F(StlAsWritten, TextMayHaveAnyLineEndsAnyCaseAndAMarkInFront) {
  const std::string bom = "\xEF\xBB\xBF";
  for (const std::string& bytes :
       {text("\n"), text("\r"), text("\r\n"), text(" "), text("\n\f\v "), text("\n", true), bom + text("\r"),
        "\n \r\n" + text("\n"), bom + " " + text("\n", true), "Solid\n" + text("\n").substr(11)}) {
    const auto scene = read("a.stl", bytes);
    ASSERT_TRUE(scene) << describe(scene) << bytes.substr(0, 40);
    EXPECT_EQ(triangle_count(*scene), 2U) << bytes.substr(0, 40);
    EXPECT_EQ(area(*scene), 1.0);
    // They are counted by the lines that begin with vertex; in the one without line ends there is none.
    EXPECT_EQ(scene->triangles_in_file, bytes == text(" ") ? 0U : 2U) << bytes.substr(0, 40);
    EXPECT_EQ(all_left_out(*scene), "");
  }
}

TEST_F(StlAsWritten, WordsThatAreNotReadAreNamed) {
  std::string bytes = text("\n");
  bytes.replace(bytes.find("endloop"), 7, "end loop\ncolor 1 0 0\nfuzz 3");
  const auto scene = read("a.stl", bytes + text("\n"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(triangle_count(*scene), 4U);
  EXPECT_EQ(all_left_out(*scene),
            "the names of 2 solids: an STL becomes one mesh; STL keyword color: 1 time: not one that is read; "
            "STL keyword fuzz: 1 time: not one that is read; ");
}

TEST_F(StlAsWritten, OtherTextIsRefusedAndNotTakenForFacets) {
  const auto page = read("a.stl", "<!DOCTYPE html>" + std::string(500, 'x'));
  ASSERT_FALSE(page);
  EXPECT_EQ(page.error().code, ErrorCode::kInvalid);
  EXPECT_FALSE(read("a.stl", ""));
  std::string many = "solid\n";
  for (int i = 0; i < 200; ++i) many += "word" + std::to_string(i) + "x\n";
  EXPECT_FALSE(read("a.stl", many));
}

/// Where every word of a line may be the first of the facets, that is not looked for over and over.
TEST_F(StlAsWritten, ALongLineTakesNoLongerThanItsLength) {
  std::string bytes;
  for (int i = 0; i < 200000; ++i) bytes += "solid facet normal ";
  ASSERT_TRUE(read("a.stl", bytes));
}

TEST_F(StlAsWritten, FacetColoursOfVisCamAndSolidView) {
  // Bit 15, then red, green and blue of five bits.
  const auto scene = read("a.stl", binary(2, {0x8000U | 31U << 10U, 0x8000U | 31U}));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  ASSERT_EQ(p.positions.size(), 6U);  // none of the edge is shared
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(p.colors[p.indices[c]], Vec4f(1, 0, 0, 1));
    EXPECT_EQ(p.colors[p.indices[3 + c]], Vec4f(0, 0, 1, 1));
  }
  EXPECT_EQ(all_left_out(*scene), "");
  const auto one = read("a.stl", binary(2, {0x8000U | 16U << 5U, 0}));
  ASSERT_TRUE(one) << describe(one);
  ASSERT_EQ(one->meshes[0].primitives.size(), 2U);          // with and without
  EXPECT_FLOAT_EQ(primitive(one).colors[0].y, 0.2307400F);  // level 132 of 255
  EXPECT_TRUE(one->meshes[0].primitives[1].colors.empty());
  const auto linear = read("a.stl", binary(2, {0x8000U | 16U << 5U, 0}), {.linear_colors = true});
  EXPECT_FLOAT_EQ(primitive(linear).colors[0].y, 132.0F / 255.0F);
}

TEST_F(StlAsWritten, FacetColoursOfMagics) {
  // Bit 15 says that the facet has the colour of the header; else red is lowest.
  const auto scene =
      read("a.stl", binary(2, {0x8000U, 31U}, std::string("COLOR=\xFF\xFF\0\x80,MATERIAL=xxxxyyyyzzzz", 32)));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  EXPECT_EQ(p.colors[p.indices[0]], Vec4f(1, 1, 0, 1));
  EXPECT_EQ(p.colors[p.indices[3]], Vec4f(1, 0, 0, 1));
  EXPECT_EQ(all_left_out(*scene),
            "the alpha of COLOR= in the header: facets are opaque; MATERIAL= in the header: only its COLOR= is read; ");
}

TEST_F(StlAsWritten, AttributeBytesThatAreNoColourAreNamed) {
  const auto scene = read("a.stl", binary(2, {7, 0}));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_TRUE(primitive(scene).colors.empty());
  EXPECT_EQ(all_left_out(*scene), "attribute bytes: of 1 facet: they are no colour; ");
}

/// MeshLab's "Materialise": bit 15 of every facet, the colour of the facet in the rest.
TEST_F(StlAsWritten, FacetColoursOfMagicsWithBit15) {
  const std::string head("COLOR=\xFF\xFF\0\xFF", 10);
  const auto scene = read("a.stl", binary(2, {0x801FU, 0xFFFFU}, head));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  EXPECT_EQ(p.colors[p.indices[0]], Vec4f(1, 0, 0, 1));
  EXPECT_EQ(p.colors[p.indices[3]], Vec4f(1, 1, 0, 1));
  const auto plain = read("a.stl", binary(2, {0, 0}, head));  // nobody wrote the facets' own
  ASSERT_TRUE(plain) << describe(plain);
  for (const Vec4f& color : primitive(plain).colors) EXPECT_EQ(color, Vec4f(1, 1, 0, 1));
  const auto black = read("a.stl", binary(2, {31, 0}, head));
  ASSERT_TRUE(black) << describe(black);
  EXPECT_EQ(primitive(black).colors[primitive(black).indices[3]], Vec4f(0, 0, 0, 1));
}

}  // namespace
}  // namespace meshlode::testing
