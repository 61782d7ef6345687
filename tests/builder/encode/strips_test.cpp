// SPDX-License-Identifier: GPL-3.0-or-later
// Strips lose no triangle, turn none over, and cost what the format promises. They are read here as
// docs/reference/format.md tells a GPU to: each triangle alone.
#include "builder/encode/strips.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace meshlode::builder {
namespace {

std::vector<std::uint32_t> one_block(std::size_t count) {
  return std::vector<std::uint32_t>(count, 0);
}

/// Triangle t of strip k, by the rule of one GPU thread.
LocalTriangle read_alone(const Strips& strips, std::uint32_t t) {
  std::uint32_t k = 0;
  while (k + 1 < strips.first_triangle.size() && strips.first_triangle[k + 1] <= t) ++k;
  const std::uint32_t t0 = strips.first_triangle[k];
  const auto slot = [&](std::uint32_t triangle) { return triangle + 2 * k + 2; };
  std::uint32_t p = 0;
  std::uint32_t q = 0;
  std::uint32_t r = t;
  if (strips.turns[t]) {
    p = slot(t) - 1;
    do --r;
    while (strips.turns[r]);
    q = slot(r) - 1;
  } else {
    q = slot(t) - 1;
    while (r > t0 && (r == t || !strips.turns[r])) --r;
    p = r > t0 && strips.turns[r] ? slot(r) - 1 : slot(t0) - 2;
  }
  return {strips.slots[p], strips.slots[q], strips.slots[slot(t)]};
}

LocalTriangle from_smallest(LocalTriangle t) {
  LocalTriangle least = t;
  for (int turn = 0; turn < 2; ++turn) {
    std::rotate(t.begin(), t.begin() + 1, t.end());
    least = std::min(least, t);
  }
  return least;
}

/// What must hold of any strips of any triangles.
void expect_sound(const std::vector<LocalTriangle>& triangles, const std::vector<std::uint32_t>& block,
                  std::uint32_t vertex_count, const Strips& strips, const std::string& what) {
  const auto count = static_cast<std::uint32_t>(triangles.size());
  ASSERT_EQ(strips.turns.size(), count) << what;
  ASSERT_EQ(strips.slots.size(), count + 2 * strips.first_triangle.size()) << what;
  ASSERT_EQ(strips.first_triangle.at(0), 0U) << what;
  for (std::size_t k = 0; k < strips.first_triangle.size(); ++k) {
    ASSERT_FALSE(strips.turns[strips.first_triangle[k]]) << what;
    if (k > 0) {
      ASSERT_GT(strips.first_triangle[k], strips.first_triangle[k - 1]) << what;
    }
  }
  for (std::uint32_t b = 0, first = 0; first < count; ++b) {  // blocks stay where they are
    std::uint32_t end = first;
    while (end < count && block[end] == b) ++end;
    std::vector<LocalTriangle> expected;
    std::vector<LocalTriangle> read;
    for (std::uint32_t t = first; t < end; ++t) {
      expected.push_back(from_smallest(triangles[t]));
      read.push_back(from_smallest(read_alone(strips, t)));
    }
    std::sort(expected.begin(), expected.end());
    std::sort(read.begin(), read.end());
    ASSERT_EQ(read, expected) << what;
    first = end;
  }
  // Vertices in order of first use, and the references as the stream has them.
  std::vector<std::uint32_t> number(vertex_count, 0xFFFFU);
  std::uint32_t fresh = 0;
  std::size_t reference = 0;
  for (const std::uint8_t v : strips.slots) {
    if (number[v] == 0xFFFFU) {
      ASSERT_EQ(strips.vertex_order.at(fresh), v) << what;
      number[v] = fresh++;
    } else {
      const std::uint32_t distance = strips.references.at(reference++);
      ASSERT_EQ(distance, fresh - 1 - number[v]) << what;
      ASSERT_LT(distance, 1U << strips.reference_bits) << what;
    }
  }
  ASSERT_EQ(fresh, vertex_count) << what;
  ASSERT_EQ(reference, strips.references.size()) << what;
}

void expect_sound(const std::vector<LocalTriangle>& triangles, std::uint32_t vertex_count, const std::string& what) {
  for (const std::uint32_t trials : {1U, 2U, 7U}) {
    const auto block = one_block(triangles.size());
    expect_sound(triangles, block, vertex_count, make_strips(triangles, block, vertex_count, {trials}), what);
  }
}

std::vector<LocalTriangle> grid(std::uint32_t columns, std::uint32_t rows) {
  std::vector<LocalTriangle> triangles;
  for (std::uint32_t y = 0; y < rows; ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      const auto v = static_cast<std::uint8_t>(y * (columns + 1) + x);
      const auto up = static_cast<std::uint8_t>(v + columns + 1);
      triangles.push_back({v, static_cast<std::uint8_t>(v + 1), static_cast<std::uint8_t>(up + 1)});
      triangles.push_back({v, static_cast<std::uint8_t>(up + 1), up});
    }
  }
  return triangles;
}

/// Vertices that no triangle uses are taken out: what clusters are.
std::uint32_t compact(std::vector<LocalTriangle>& triangles) {
  std::vector<std::uint32_t> number(256, 256);
  std::uint32_t count = 0;
  for (LocalTriangle& t : triangles) {
    for (std::uint8_t& v : t) {
      if (number[v] == 256) number[v] = count++;
      v = static_cast<std::uint8_t>(number[v]);
    }
  }
  return count;
}

/// The covers as strips.cpp describes them, with everything looked up anew and every trial run to its end: what tables,
/// packed keys and stopping early must not change.
class PlainStriper {
 public:
  PlainStriper(const std::vector<LocalTriangle>& triangles, const std::vector<std::uint32_t>& block)
      : triangles_(triangles), block_(block), neighbours_(triangles.size()) {
    struct Sides {
      std::vector<Half> ascending, descending;
    };
    std::map<std::array<std::uint32_t, 3>, Sides> edges;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t a = triangles[t][e], b = triangles[t][(e + 1) % 3];
        if (a == b) continue;
        Sides& sides = edges[{block[t], std::min(a, b), std::max(a, b)}];
        (a < b ? sides.ascending : sides.descending).push_back({t, e});
      }
    }
    for (const auto& [edge, sides] : edges) {
      for (std::size_t k = 0; k < std::min(sides.ascending.size(), sides.descending.size()); ++k) {
        const Half a = sides.ascending[k], b = sides.descending[k];
        if (a.triangle == b.triangle) continue;
        neighbours_[a.triangle][a.edge] = b;
        neighbours_[b.triangle][b.edge] = a;
      }
    }
  }

  Strips run(std::uint32_t trial) {
    out_ = {};
    used_.assign(triangles_.size(), false);
    tie_.clear();
    std::uint32_t state = (trial + 1) * 2654435761U + 12345U;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      state ^= state << 13U;
      state ^= state >> 17U;
      state ^= state << 5U;
      tie_.push_back(state >> 24U);
    }
    for (std::size_t begin = 0, end = 0; begin < triangles_.size(); begin = end) {
      while (end < triangles_.size() && block_[end] == block_[begin]) ++end;
      while (true) {
        std::optional<std::size_t> first;
        for (std::size_t t = begin; t < end; ++t) {
          if (!used_[t] && (!first || start_key(t, trial) < start_key(*first, trial))) first = t;
        }
        if (!first) break;
        add_path(*first, trial);
      }
    }
    for (const std::uint32_t d : out_.references) {
      while (d >> out_.reference_bits != 0) ++out_.reference_bits;
    }
    return out_;
  }

 private:
  struct Half {
    std::size_t triangle = 0, edge = 0;
  };
  struct Step {
    std::size_t triangle;
    std::optional<std::size_t> in, out;
  };
  using Key = std::array<std::size_t, 3>;

  [[nodiscard]] std::size_t oldest(std::size_t t) const {
    const auto& order = out_.vertex_order;
    const auto is_corner = [&](std::uint8_t v) {
      return std::count(triangles_[t].begin(), triangles_[t].end(), v) > 0;
    };
    const auto at = std::find_if(order.begin(), order.end(), is_corner);
    return at == order.end() ? 0xFFFFU : static_cast<std::size_t>(at - order.begin());
  }
  [[nodiscard]] std::size_t ways_out(std::size_t t) const {
    return static_cast<std::size_t>(std::count_if(neighbours_[t].begin(), neighbours_[t].end(),
                                                  [&](const auto& n) { return n && !used_[n->triangle]; }));
  }
  [[nodiscard]] Key start_key(std::size_t t, std::uint32_t trial) const {
    return trial % 2 == 0 ? Key{ways_out(t), oldest(t), tie_[t]} : Key{oldest(t), ways_out(t), tie_[t]};
  }

  std::vector<Step> walk(std::optional<Half> at) {
    std::vector<Step> path;
    while (at) {
      used_[at->triangle] = true;
      path.push_back({at->triangle, at->edge, {}});
      std::optional<std::size_t> best;
      const auto& neighbours = neighbours_[at->triangle];
      for (std::size_t e = 0; e < 3; ++e) {
        if (!neighbours[e] || used_[neighbours[e]->triangle]) continue;
        if (!best || start_key(neighbours[e]->triangle, 0) < start_key(neighbours[*best]->triangle, 0)) best = e;
      }
      path.back().out = best;
      at = best ? neighbours[*best] : std::nullopt;
    }
    return path;
  }

  static void turn(std::vector<Step>& path) {
    std::reverse(path.begin(), path.end());
    for (Step& step : path) std::swap(step.in, step.out);
  }

  void name(std::uint8_t v) {
    auto& order = out_.vertex_order;
    const auto at = std::find(order.begin(), order.end(), v);
    if (at != order.end()) {
      out_.references.push_back(static_cast<std::uint32_t>(order.end() - at - 1));
    } else {
      order.push_back(v);
    }
    out_.slots.push_back(v);
  }

  void add_path(std::size_t first, std::uint32_t trial) {
    std::vector<Step> path = walk(Half{first, 0});
    path.front().in.reset();
    // The other way: what a second walk from the start finds.
    std::vector<Step> other = walk(Half{first, 0});
    if (other.size() > 1) {
      path.front().in = other.front().out;
      turn(path);
      path.insert(path.end(), other.begin() + 1, other.end());
    }
    if (oldest(path.back().triangle) < oldest(path.front().triangle)) turn(path);
    out_.first_triangle.push_back(static_cast<std::uint32_t>(out_.turns.size()));
    path.front().in = (path.front().out.value_or(2) + (trial / 2 % 2 == 0 ? 1 : 2)) % 3;
    bool is_right = false;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const LocalTriangle& t = triangles_[path[i].triangle];
      const std::size_t in = *path[i].in;
      for (const std::size_t corner : {in, in + 1, in + 2}) {
        if (i == 0 || corner == in + 2) name(t[corner % 3]);
      }
      out_.turns.push_back(is_right);
      is_right = path[i].out && *path[i].out == (in + 1) % 3;
    }
  }

  const std::vector<LocalTriangle>& triangles_;
  const std::vector<std::uint32_t>& block_;
  std::vector<std::array<std::optional<Half>, 3>> neighbours_;
  std::vector<bool> used_;
  std::vector<std::size_t> tie_;
  Strips out_;
};

void expect_plain(const std::vector<LocalTriangle>& triangles, const std::vector<std::uint32_t>& block,
                  std::uint32_t vertex_count, std::uint32_t trials, const std::string& what) {
  PlainStriper plain(triangles, block);
  Strips best = plain.run(0);
  for (std::uint32_t trial = 1; trial < trials; ++trial) {
    Strips other = plain.run(trial);
    if (other.bit_count() < best.bit_count()) best = std::move(other);
  }
  const Strips made = make_strips(triangles, block, vertex_count, {trials});
  EXPECT_EQ(made.first_triangle, best.first_triangle) << what;
  EXPECT_EQ(made.turns, best.turns) << what;
  EXPECT_EQ(made.slots, best.slots) << what;
  EXPECT_EQ(made.vertex_order, best.vertex_order) << what;
  EXPECT_EQ(made.references, best.references) << what;
  EXPECT_EQ(made.reference_bits, best.reference_bits) << what;
}

TEST(Strips, OneTriangleIsAStrip) {
  expect_sound({{0, 1, 2}}, 3, "one");
}

TEST(Strips, AGridComesBack) {
  expect_sound(grid(8, 8), 81, "8 x 8");
  expect_sound(grid(1, 100), 202, "a ribbon");
  expect_sound(grid(15, 8), 144, "15 x 8");
}

TEST(Strips, AFanAndAClosedBallComeBack) {
  std::vector<LocalTriangle> fan;
  for (std::uint32_t i = 1; i < 200; ++i)
    fan.push_back({0, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i + 1)});
  expect_sound(fan, 201, "fan");
  const std::vector<LocalTriangle> octahedron{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                              {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  expect_sound(octahedron, 6, "octahedron");
}

TEST(Strips, WhatIsNoSurfaceComesBackToo) {
  expect_sound({{0, 1, 2}, {0, 1, 2}, {0, 2, 1}}, 3, "the same triangle twice, and its back");
  expect_sound({{0, 0, 1}, {1, 1, 1}, {1, 0, 2}, {2, 0, 2}}, 3, "corners in one place");
  expect_sound({{0, 1, 2}, {1, 0, 3}, {1, 0, 4}, {0, 1, 5}, {1, 0, 6}}, 7, "five triangles at one edge");
  expect_sound({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}, 5, "edges that all go one way");
  std::vector<LocalTriangle> moebius;
  constexpr std::uint8_t kTurns = 9;
  for (std::uint8_t i = 0; i < kTurns; ++i) {
    moebius.push_back({i, static_cast<std::uint8_t>((i + 1) % kTurns), static_cast<std::uint8_t>((i + 2) % kTurns)});
  }
  expect_sound(moebius, kTurns, "a band with a twist");
}

TEST(Strips, AnyTrianglesComeBack) {
  test::Random random(17);
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t vertices = 3 + static_cast<std::uint32_t>(random.below(254));
    const std::uint32_t count = 1 + static_cast<std::uint32_t>(random.below(256));
    std::vector<LocalTriangle> triangles;
    for (std::uint32_t t = 0; t < count; ++t) {
      LocalTriangle triangle{};
      for (std::uint8_t& v : triangle) v = static_cast<std::uint8_t>(random.below(vertices));
      triangles.push_back(triangle);
    }
    const std::uint32_t used = compact(triangles);
    expect_sound(triangles, used, "seed 17, round " + std::to_string(round));
  }
}

TEST(Strips, BlocksStayWhereTheyAre) {
  test::Random random(23);
  for (int round = 0; round < 50; ++round) {
    std::vector<LocalTriangle> triangles = grid(8, 8);
    std::vector<std::uint32_t> block;
    std::uint32_t b = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (t > 0 && random.below(12) == 0) ++b;
      block.push_back(b);
    }
    const Strips strips = make_strips(triangles, block, 81, {3});
    expect_sound(triangles, block, 81, strips, "seed 23, round " + std::to_string(round));
    for (std::size_t k = 0; k + 1 < strips.first_triangle.size(); ++k) {
      EXPECT_EQ(block[strips.first_triangle[k]], block[strips.first_triangle[k + 1] - 1]);
    }
  }
}

TEST(Strips, MoreTrialsNeverCostMore) {
  const std::vector<LocalTriangle> triangles = grid(9, 7);
  std::uint32_t before = 0xFFFFFFFFU;
  for (std::uint32_t trials = 1; trials < 20; ++trials) {
    const std::uint32_t bits = make_strips(triangles, one_block(triangles.size()), 80, {trials}).bit_count();
    EXPECT_LE(bits, before);
    before = bits;
  }
  EXPECT_LE(before, 5U * triangles.size());
}

TEST(Strips, NoTrialThatWouldHaveWonIsStopped) {
  test::Random random(29);
  for (int round = 0; round < 60; ++round) {
    std::vector<LocalTriangle> triangles;
    if (round % 3 == 0) {  // no surface at all
      for (std::uint64_t t = 1 + random.below(100); t > 0; --t) {
        LocalTriangle triangle{};
        for (std::uint8_t& v : triangle) v = static_cast<std::uint8_t>(random.below(60));
        triangles.push_back(triangle);
      }
    } else {  // one with holes, some of it turned over
      for (const LocalTriangle& t : grid(7, 8)) {
        if (random.below(12) > 0) triangles.push_back(random.below(20) == 0 ? LocalTriangle{t[1], t[0], t[2]} : t);
      }
    }
    std::vector<std::uint32_t> block;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const bool is_new = t > 0 && round % 2 == 0 && random.below(15) == 0;
      block.push_back(t == 0 ? 7U : block.back() + (is_new ? 1U + static_cast<std::uint32_t>(random.below(3)) : 0U));
    }
    const std::uint32_t used = compact(triangles);
    expect_plain(triangles, block, used, 12, "seed 29, round " + std::to_string(round));
  }
}

TEST(Strips, TheCountOfBitsIsWhatTheStreamHas) {
  const std::vector<LocalTriangle> triangles = grid(8, 8);
  const Strips strips = make_strips(triangles, one_block(triangles.size()), 81, {1});
  const auto extra = static_cast<std::uint32_t>(strips.first_triangle.size()) - 1;
  EXPECT_EQ(strips.bit_count(),
            128 + strips.slots.size() + 7 * extra + strips.references.size() * strips.reference_bits);
}

}  // namespace
}  // namespace meshlode::builder
