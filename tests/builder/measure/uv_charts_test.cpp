// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of small DAGs, by hand: what parts them, and which one a coarser vertex has.
#include "builder/measure/uv_charts.h"

#include <array>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "hand_made.h"

namespace meshlode::builder {
namespace {

using test::HandMade;
using test::Soup;

/// The texture coordinates of corner `k` of triangle `t`, which is at `place`: two for each set.
using Uvs = std::function<std::vector<float>(std::size_t t, std::size_t k, const Vec3d& place)>;

using ChartsOf = std::vector<std::vector<std::uint32_t>>;  ///< per triangle and corner

/// A DAG of one group, `before`, that `after` replaces. `after` may be empty.
struct Charted {
  HandMade made;
  ChartsOf before, after;

  Charted(const Soup& from, const Uvs& from_uvs, const Soup& to, const Uvs& to_uvs, std::uint32_t sets = 1) {
    made.mesh.layout.uv_set_count = sets;
    made.add_group(1, true);
    add(1, GroupId(1U), to, to_uvs);
    made.add_group(0, false);
    add(0, GroupId(), from, from_uvs);
    auto form = canonical_form(made.mesh, made.dag);
    if (!form) return;
    made.dag.triangles = form->triangles;
    UvCharts charts(made.mesh, *form, made.dag);
    const std::vector<std::uint32_t> coarser{0};
    charts.label(made.dag.groups[1], coarser);
    before = by_triangle(charts, from.size(), 3 * to.size());
    after = by_triangle(charts, to.size(), 0);
  }

 private:
  void add(std::uint32_t level, GroupId own, const Soup& soup, const Uvs& uvs) {
    made.add_cluster(level, own, soup);
    for (std::size_t t = 0; t < soup.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (const float value : uvs(t, k, soup[t][k])) made.dag.vertex_attributes.push_back(value);
      }
    }
  }
  static ChartsOf by_triangle(const UvCharts& charts, std::size_t count, std::size_t first) {
    ChartsOf out(count);
    for (std::size_t i = 0; i < 3 * count; ++i) out[i / 3].push_back(charts.of_vertex()[first + i]);
    return out;
  }
};

/// Two triangles of the plane y = height, from x = left, that share the diagonal.
Soup square(double left, double height = 0.0) {
  const Vec3d a(left, height, 0.0), b(left + 1.0, height, 0.0), c(left + 1.0, height, 1.0), d(left, height, 1.0);
  return {{a, b, c}, {a, c, d}};
}
Soup both(Soup a, const Soup& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
std::vector<float> plain(const Vec3d& place, double offset = 0.0) {
  return {static_cast<float>(place.x + offset), static_cast<float>(place.z)};
}
/// Triangles from `first` on lie elsewhere in the texture.
Uvs apart_from(std::size_t first) {
  return [first](std::size_t t, std::size_t, const Vec3d& place) { return plain(place, t >= first ? 10.0 : 0.0); };
}
const std::vector<std::uint32_t> kZero{0, 0, 0}, kOne{1, 1, 1};

TEST(UvCharts, HangTogetherByPlaceAndTextureCoordinates) {
  const Soup pair = both(square(0.0), square(1.0));
  EXPECT_EQ(Charted(pair, apart_from(4), {}, {}).before, (ChartsOf{kZero, kZero, kZero, kZero}));
  EXPECT_EQ(Charted(pair, apart_from(2), {}, {}).before, (ChartsOf{kZero, kZero, kOne, kOne})) << "a seam";
  EXPECT_EQ(Charted(both(square(0.0), square(3.0)), apart_from(4), {}, {}).before, (ChartsOf{kZero, kZero, kOne, kOne}))
      << "another place";
}

TEST(UvCharts, ZeroHasNoSign) {
  const Uvs signed_zero = [](std::size_t t, std::size_t, const Vec3d& place) {
    std::vector<float> uv = plain(place);
    if (t == 1 && uv[0] == 0.0F) uv[0] = -0.0F;
    return uv;
  };
  EXPECT_EQ(Charted(square(0.0), signed_zero, {}, {}).before, (ChartsOf{kZero, kZero}));
}

TEST(UvCharts, EachSetParts) {
  const auto two_sets = [](double offset) {
    return [offset](std::size_t t, std::size_t, const Vec3d& place) {
      std::vector<float> uvs = plain(place);
      for (const float value : plain(place, t == 1 ? offset : 0.0)) uvs.push_back(value);
      return uvs;
    };
  };
  EXPECT_EQ(Charted(square(0.0), two_sets(0.0), {}, {}, 2).before, (ChartsOf{kZero, kZero}));
  EXPECT_EQ(Charted(square(0.0), two_sets(10.0), {}, {}, 2).before, (ChartsOf{kZero, kOne}));
}

TEST(UvCharts, WhatKeepsAVertexKeepsItsChart) {
  // Two sheets above one another. What is left of each is a triangle with one corner of its own sheet, and its texture.
  const Soup sheets = both(square(0.0), square(0.0, 0.25));
  const Vec3d a(0.0), b(0.5, 0.0, 0.0), c(0.5, 0.0, 0.5), up(0.0, 0.25, 0.0);
  const Charted charted(sheets, apart_from(2), {{a + up, b + up, c + up}, {a, b, c}},
                        [](auto t, auto, const Vec3d& p) { return plain(p, t == 0 ? 10.0 : 0.0); });
  EXPECT_EQ(charted.after, (ChartsOf{kOne, kZero}));
}

TEST(UvCharts, WhatMovedAltogetherHasTheNearestByPlaceAndTexture) {
  // In the place of the lower sheet, nearly, with the texture of the upper one.
  const Soup sheets = both(square(0.0), square(0.0, 0.25));
  const Soup moved{{Vec3d(0.25, 0.0, 0.25), Vec3d(0.5, 0.0, 0.25), Vec3d(0.25, 0.0, 0.5)}};
  const auto with_offset = [](double offset) {
    return [offset](std::size_t, std::size_t, const Vec3d& p) { return plain(p, offset); };
  };
  EXPECT_EQ(Charted(sheets, apart_from(2), moved, with_offset(9.75)).after, (ChartsOf{kOne}));
  EXPECT_EQ(Charted(sheets, apart_from(2), moved, with_offset(0.125)).after, (ChartsOf{kZero}));
}

TEST(UvCharts, WhereChartsMeetMostVerticesDecide) {
  // One triangle with a vertex of the one chart and two of the other, which hang together over it.
  const Soup pair = both(square(0.0), square(2.0));
  const Vec3d left(0.0), right(2.0, 0.0, 0.0), far(3.0, 0.0, 0.0);
  const Uvs both = [](std::size_t, std::size_t k, const Vec3d& p) { return plain(p, k == 0 ? 0.0 : 10.0); };
  EXPECT_EQ(Charted(pair, apart_from(2), {{left, right, far}}, both).after, (ChartsOf{kOne}));
  const Uvs other = [](std::size_t, std::size_t k, const Vec3d& p) { return plain(p, k == 2 ? 10.0 : 0.0); };
  EXPECT_EQ(Charted(pair, apart_from(2), {{left, Vec3d(1.0, 0.0, 0.0), far}}, other).after, (ChartsOf{kZero}));
  const Uvs tied = [](std::size_t, std::size_t k, const Vec3d& p) { return plain(p, std::array{0.0, 10.0, 0.5}[k]); };
  EXPECT_EQ(Charted(pair, apart_from(2), {{left, right, Vec3d(1.0, 0.5, 0.0)}}, tied).after, (ChartsOf{kZero}))
      << "as many of each: the first";
}

}  // namespace
}  // namespace meshlode::builder
