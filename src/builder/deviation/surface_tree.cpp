// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/surface_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "base/box.h"
#include "base/parallel.h"
#include "base/release.h"
#include "builder/deviation/lanes.h"
#include "builder/deviation/open_boxes.h"

namespace meshlode::builder {

namespace {

constexpr std::uint32_t kLeafSize = 4;

// Of leaves that are made a thread keeps so many: what a group's queries come back to, in a quarter of a core's cache.
constexpr std::size_t kCachedLeaves = 1024;

// How many items are parted by counting each against each, and how many by bins, on the stack.
constexpr std::size_t kFewItems = 32, kManyItems = 4096;
// Items of a smaller extent are not put into bins: its reciprocal would be infinite.
constexpr float kLeastSize = 1e-30F;

// The order of a pair of numbers that both decide: no two items are equal.
struct AlongAxis {
  std::size_t axis;
  template <class Item>
  bool operator()(const Item& a, const Item& b) const {
    return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.triangle < b.triangle;
  }
};

/// A box around some items; what the fourth lane holds means nothing.
struct ItemBox {
  Lanes low, high;
};

template <class Item>
ItemBox box_of(std::span<const Item> items) {
  const auto lanes_of = [](const Item& item) {
    static_assert(sizeof(Item) == sizeof(Lanes));
    Lanes value;
    std::memcpy(&value, &item, sizeof(value));
    return value;
  };
  ItemBox box{lanes_of(items[0]), lanes_of(items[0])};
  for (const Item& item : items) {
    box.low = min_lanes(lanes_of(item), box.low);
    box.high = max_lanes(lanes_of(item), box.high);
  }
  return box;
}

/// The lesser half first, of few: each is counted against each, four at a time and without a branch.
template <class Item>
void part_few(std::span<Item> items, std::size_t half, const AlongAxis& order) {
  // Keys order as floats do. Behind the last item there are some that are less than none.
  constexpr std::int32_t kGreatest = std::numeric_limits<std::int32_t>::max();
  std::array<std::int32_t, kFewItems> keys, triangles;
  std::array<Item, kFewItems> parted;
  const std::size_t count = items.size(), padded = (count + 3) / 4 * 4;
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::int32_t>(items[i].center[order.axis] + 0.0F);  // one zero, not two
    keys[i] = bits ^ (bits < 0 ? kGreatest : 0);
    triangles[i] = static_cast<std::int32_t>(items[i].triangle);
  }
  std::fill(keys.begin() + count, keys.begin() + padded, kGreatest);
  std::fill(triangles.begin() + count, triangles.begin() + padded, kGreatest);
  std::size_t left = 0, right = half;
  for (std::size_t i = 0; i < count; ++i) {
    const LaneMask key = mask_lanes(keys[i]), triangle = mask_lanes(triangles[i]);
    LaneMask less{};  // minus how many are less, lane by lane
    for (std::size_t j = 0; j < padded; j += 4) {
      const LaneMask other = load_mask(&keys[j]);
      less += (other < key) | ((other == key) & (load_mask(&triangles[j]) < triangle));
    }
    const auto rank = static_cast<std::size_t>(-(less[0] + less[1] + less[2] + less[3]));
    const bool is_left = rank < half;
    parted[is_left ? left : right] = items[i];
    left += is_left ? 1 : 0;
    right += is_left ? 0 : 1;
  }
  std::copy_n(parted.begin(), count, items.begin());
}

/// The lesser half first: by bins along the axis, so that only those of the median's bin are compared.
template <class Item>
void part_many(std::span<Item> items, std::size_t half, const AlongAxis& order, float low, float size) {
  constexpr std::size_t kBins = 64;
  // Rounding keeps the order: nothing in a lower bin is greater.
  const float scale = static_cast<float>(kBins - 1) / size;
  const auto bin_of = [&](const Item& item) {
    return static_cast<std::size_t>(static_cast<std::int32_t>((item.center[order.axis] - low) * scale));
  };
  std::array<std::uint32_t, kBins + 1> start{};
  for (const Item& item : items) ++start[bin_of(item) + 1];
  for (std::size_t bin = 0; bin < kBins; ++bin) start[bin + 1] += start[bin];
  std::size_t middle = 0;
  while (start[middle + 1] < half) ++middle;
  const std::size_t first = start[middle], last = start[middle + 1];
  std::array<Item, kManyItems> parted;
  std::array<std::size_t, 3> next{0, first, last};
  for (const Item& item : items) {
    const std::size_t bin = bin_of(item);
    parted[next[(bin >= middle ? 1U : 0U) + (bin > middle ? 1U : 0U)]++] = item;
  }
  std::nth_element(parted.begin() + static_cast<std::ptrdiff_t>(first),
                   parted.begin() + static_cast<std::ptrdiff_t>(half),
                   parted.begin() + static_cast<std::ptrdiff_t>(last), order);
  std::copy_n(parted.begin(), items.size(), items.begin());
}

/// Halves by the median along the longest side: the first `half` items are less than the others. Which of them come
/// first on either side is left open.
template <class Item>
void part_at_median(std::span<Item> items, std::size_t half) {
  const ItemBox box = box_of(std::span<const Item>(items));
  const Lanes size = box.high - box.low;
  const std::size_t axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  const AlongAxis order{axis};
  if (items.size() <= kFewItems) return part_few(items, half, order);
  if (items.size() <= kManyItems && size[axis] > kLeastSize)
    return part_many(items, half, order, box.low[axis], size[axis]);
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(), order);
}

}  // namespace

void SurfaceTree::build(const Surface& surface, Leaves leaves, Capsules capsules) {
  surface_ = surface;
  slot_triangle_.clear();
  leaves_.clear();
  nodes_.clear();
  capsules_.clear();
  level_start_.clear();
  if (surface.triangles.empty()) return;
  static std::atomic<std::uint64_t> trees = 0;
  serial_ = ++trees;
  set_frame();
  UnsetVector<Item> items(surface.triangles.size());
  parallel_for_each_index(items.size(), 4096, [&](std::size_t i) {
    const auto& t = surface.triangles[i];
    const Vec3f center =
        to_frame(surface.positions[t[0]]) + to_frame(surface.positions[t[1]]) + to_frame(surface.positions[t[2]]);
    items[i] = {{center.x, center.y, center.z}, static_cast<std::uint32_t>(i)};
  });
  // Whole levels, so that places follow from numbers: 4^depth leaves have room for all.
  const std::size_t leaf_count = (items.size() + kLeafSize - 1) / kLeafSize;
  level_start_ = box_levels(leaf_count);
  nodes_.resize(level_start_.back());
  sort_items(items);
  slot_triangle_.resize(items.size());
  parallel_for_each_index(items.size(), kLoopGrain, [&](std::size_t i) { slot_triangle_[i] = items[i].triangle; });
  release(items);
  if (leaves == Leaves::kHeldIfFew && surface.triangles.size() <= kFew) {
    leaves_.resize(leaf_count);
    parallel_for_each_index(leaf_count, 1024, [&](std::size_t i) {
      leaves_[i].triangles = make_leaf(i);
      leaves_[i].terms = terms_of(leaves_[i].triangles);
    });
  }
  fill_nodes();
  if (capsules == Capsules::kWhereTheyHelp && has_hub(surface.triangles, surface.positions.size())) fill_capsules();
}

void SurfaceTree::set_frame() {
  Box3d box;
  for (const auto& t : surface_.triangles) {
    for (const std::uint32_t v : t) box.add(surface_.positions[v]);
  }
  const Vec3d half = box.size() * 0.5;
  center_ = box.low + half;
  const double extent = std::max(half.x, std::max(half.y, half.z));
  int exponent = 0;
  (void)std::frexp(extent, &exponent);
  scale_ = extent > 0.0 ? std::ldexp(1.0, std::clamp(-exponent, -1000, 1000)) : 1.0;
}

// Halves by the median along the longest side, twice a level. Counts are those of whole subtrees, so that only the last
// one is not full.
void SurfaceTree::sort_items(std::span<Item> items) const {
  const std::size_t depth = level_start_.size() - 1;
  for (std::size_t halving = 2 * depth; halving-- > 0;) {
    const std::size_t half = kLeafSize << halving;
    const std::size_t pieces = (items.size() + 2 * half - 1) / (2 * half);
    parallel_for_each_index(pieces, std::max<std::size_t>(1, 8192 / half), [&](std::size_t piece) {
      const std::size_t count = std::min(2 * half, items.size() - 2 * half * piece);
      if (count > half) part_at_median(items.subspan(2 * half * piece, count), half);
    });
  }
  // The order of each side is nobody's choice so far: inside a leaf it is made ours.
  parallel_for_each_index((items.size() + kLeafSize - 1) / kLeafSize, 1024, [&](std::size_t leaf) {
    const auto first = items.begin() + static_cast<std::ptrdiff_t>(kLeafSize * leaf);
    const auto last = items.begin() + static_cast<std::ptrdiff_t>(std::min(kLeafSize * (leaf + 1), items.size()));
    std::sort(first, last, [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
  });
}

SurfaceTree::Leaf SurfaceTree::make_leaf(std::size_t index) const {
  Leaf leaf;
  for (std::size_t k = 0; k < kLeafSize; ++k) {
    // A leaf that is not full repeats its last triangle, which then never wins against itself.
    const std::size_t slot = std::min(kLeafSize * index + k, slot_triangle_.size() - 1);
    const TriangleCorners corners = corners_at(TreeSlot(slot));
    const Vec3f a = to_frame(corners[0]);
    const Vec3f ab((corners[1] - corners[0]) * scale_), ac((corners[2] - corners[0]) * scale_);
    leaf.set(k, a, ab, ac);
  }
  return leaf;
}

void SurfaceTree::fill_nodes() {
  const float infinity = std::numeric_limits<float>::infinity();
  const std::size_t depth = level_start_.size() - 1;
  for (std::size_t level = depth; level-- > 0;) {
    const std::size_t count = level_start_[level + 1] - level_start_[level];
    const std::size_t child_count =
        level + 1 == depth ? leaf_count() : level_start_[level + 2] - level_start_[level + 1];
    parallel_for_each_index(count, 1024, [&](std::size_t i) {
      Node& node = nodes_[level_start_[level] + i];
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t child = 4 * i + k;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          float low = infinity, high = -infinity;  // no child: infinitely far from every point
          if (child < child_count && level + 1 == depth) {
            const Leaf leaf = leaves_.empty() ? make_leaf(child) : leaves_[child].triangles;
            for (std::size_t j = 0; j < kLeafSize; ++j) {
              const float a = leaf.a[axis][j], b = a + leaf.ab[axis][j], c = a + leaf.ac[axis][j];
              low = std::min(low, std::min(a, std::min(b, c)));
              high = std::max(high, std::max(a, std::max(b, c)));
            }
          } else if (child < child_count) {
            const Node& below = nodes_[level_start_[level + 1] + child];
            for (std::size_t j = 0; j < 4; ++j) {
              low = std::min(low, below.low[axis][j]);
              high = std::max(high, below.high[axis][j]);
            }
          }
          node.low[axis][k] = low;
          node.high[axis][k] = high;
        }
      }
    });
  }
}

void SurfaceTree::fill_capsules() {
  capsules_.resize(nodes_.size());
  const std::size_t depth = level_start_.size() - 1;
  const auto around_leaf = [&](std::size_t index) {
    const Leaf leaf = leaves_.empty() ? make_leaf(index) : leaves_[index].triangles;
    std::array<std::array<Vec3f, 3>, kLeafSize> triangles;
    for (std::size_t k = 0; k < kLeafSize; ++k) {
      const auto at = [&](const auto& from) { return Vec3f(from[0][k], from[1][k], from[2][k]); };
      triangles[k] = {at(leaf.a), at(leaf.a) + at(leaf.ab), at(leaf.a) + at(leaf.ac)};
    }
    return capsule_around(triangles);
  };
  for (std::size_t level = depth; level-- > 0;) {
    const bool is_last = level + 1 == depth;
    const std::size_t child_count = is_last ? leaf_count() : level_start_[level + 2] - level_start_[level + 1];
    parallel_for_each_index(level_start_[level + 1] - level_start_[level], 1024, [&](std::size_t i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t child = 4 * i + k;
        Capsule capsule;
        if (child < child_count && is_last) {
          capsule = around_leaf(child);
        } else if (child < child_count) {
          const FourCapsules& below = capsules_[level_start_[level + 1] + child];
          capsule = capsule_around(std::array{below.get(0), below.get(1), below.get(2), below.get(3)});
        }
        capsules_[level_start_[level] + i].set(k, capsule);
      }
    });
  }
}

const SurfaceTree::HeldLeaf& SurfaceTree::made_leaf(std::uint32_t index) const {
  thread_local std::vector<CachedLeaf> cache;
  if (cache.empty()) cache.resize(kCachedLeaves);
  CachedLeaf& cached = cache[index % kCachedLeaves];
  if (cached.tree != serial_ || cached.index != index) {
    cached.held.triangles = make_leaf(index);
    cached.held.terms = terms_of(cached.held.triangles);
    cached.tree = serial_;
    cached.index = index;
  }
  return cached.held;
}

MESHLODE_CLONED_FOR_AVX2
SurfaceTree::Hit SurfaceTree::test_leaf(const Vec3f& point, std::uint32_t index, Hit best) const {
  const auto& [leaf, terms] = leaf_at(index);
  const Lanes distance2 = distances2_to(leaf, terms, {lanes(point.x), lanes(point.y), lanes(point.z)});
  // The first of those that are nearest, if it is nearer: a toss, so no branch.
  const Lanes known = lanes(best.distance2);
  const Lanes d = choose(distance2 < known, distance2, known);  // of a NaN too
  const Lanes least = least_lane(d);
  const std::uint32_t slot = std::min(4 * index + first_lane(d == least), size() - 1);
  const bool is_nearer = least[0] < best.distance2;
  return {TreeSlot(is_nearer ? slot : best.slot.value), least[0]};
}

MESHLODE_CLONED_FOR_AVX2
SurfaceTree::Hit SurfaceTree::look_around(const std::array<Vec3f, 3>& points, TreeSlot slot) const {
  const std::uint32_t index = slot.value / kLeafSize;
  const auto& [leaf, terms] = leaf_at(index);
  Lanes farthest2 = lanes(0.0F);
  for (const Vec3f& p : points) {
    farthest2 = max_lanes(farthest2, distances2_to(leaf, terms, {lanes(p.x), lanes(p.y), lanes(p.z)}));
  }
  Hit best;
  for (std::uint32_t k = 0; k < kLeafSize; ++k) {
    if (farthest2[k] < best.distance2) best = {TreeSlot(std::min(4 * index + k, size() - 1)), farthest2[k]};
  }
  return best;
}

namespace {

struct PointLanes {
  Lanes x, y, z;
};

/// Squared distances to four boxes.
template <class Node>
Lanes distances2_to_boxes(const Node& node, const PointLanes& p) {
  const auto outside = [&](std::size_t axis, Lanes at) {
    const Lanes below = load_lanes(node.low[axis].data()) - at, above = at - load_lanes(node.high[axis].data());
    return max_lanes(max_lanes(below, above), lanes(0.0F));
  };
  const Lanes dx = outside(0, p.x), dy = outside(1, p.y), dz = outside(2, p.z);
  return dx * dx + dy * dy + dz * dz;
}

}  // namespace

MESHLODE_CLONED_FOR_AVX2
SurfaceTree::Hit SurfaceTree::find_nearest(const Vec3f& point, Hit best, float enough) const {
  if (nodes_.empty()) return best;
  const PointLanes p{lanes(point.x), lanes(point.y), lanes(point.z)};
  const auto distances2_to_children = [&](std::uint32_t node) {
    const Lanes distance2 = distances2_to_boxes(nodes_[node], p);
    if (capsules_.empty() || !any_lane(distance2 < lanes(best.distance2))) return distance2;
    // They only dismiss: what is left is looked at in the order of the boxes.
    const LaneMask is_near = distances2_to_capsules(capsules_[node], point) < lanes(best.distance2);
    return choose(is_near, distance2, lanes(std::numeric_limits<float>::infinity()));
  };
  const auto look_at = [&](std::uint32_t leaf) {
    best = test_leaf(point, leaf, best);
    return !(best.distance2 <= enough);
  };
  search_boxes(level_start_, best.slot.is_valid() ? best.slot.value / kLeafSize : kNoId, distances2_to_children,
               look_at, [&] { return best.distance2; });
  return best;
}

}  // namespace meshlode::builder
