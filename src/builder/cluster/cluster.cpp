// SPDX-License-Identifier: GPL-3.0-or-later
// METIS on the whole of a large mesh is slow and runs on one thread. Cutting along medians into chunks of some thousand
// triangles first costs 8% more shared vertices and a third of the time, and chunks run side by side.
#include "builder/cluster/cluster.h"

#include <algorithm>
#include <utility>

#include "base/local_ids.h"
#include "base/parallel.h"
#include "base/release.h"
#include "base/unset_vector.h"
#include "builder/cluster/adjacency.h"
#include "builder/cluster/caps.h"
#include "builder/cluster/dense_limit.h"
#include "builder/cluster/loose_pieces.h"
#include "builder/cluster/merged_partition.h"
#include "builder/cluster/partition.h"
#include "builder/cluster/satellites.h"

namespace meshlode::builder {

namespace {

constexpr std::size_t kChunkTriangles = 8192;

struct Range {
  std::size_t begin, end;
};

/// Cuts a range in two at the median of its longest axis. \returns where the second half begins: a multiple of the
/// target from the first.
std::size_t cut_in_two(std::span<const Vec3i> centers, std::size_t target, const Range& range,
                       std::span<std::uint32_t> order) {
  const auto begin = order.begin() + static_cast<std::ptrdiff_t>(range.begin);
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(range.end);
  Vec3i low = centers[*begin];
  Vec3i high = low;
  for (auto it = begin; it != end; ++it) {
    low = glm::min(low, centers[*it]);
    high = glm::max(high, centers[*it]);
  }
  const Vec3i extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
  const std::size_t left = ((range.end - range.begin) / 2 + target / 2) / target * target;
  const auto key_of = [&](std::uint32_t t) {
    return static_cast<std::uint64_t>(centers[t][axis] - low[axis]) << 32U | t;
  };
  // Place and triangle as one number each, side by side: through `order` every comparison would go to two of the
  // places.
  UnsetVector<std::uint64_t> keys(range.end - range.begin);
  std::transform(begin, end, keys.begin(), key_of);
  std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(left), keys.end());
  const std::uint64_t middle = keys[left];
  release(keys);
  std::stable_partition(begin, end, [&](std::uint32_t t) { return key_of(t) < middle; });
  return range.begin + left;
}

/// Splits triangles into chunks at medians. All chunks but those at the far ends hold a multiple of the target, so that
/// their clusters come out full. `order`, ascending, is permuted; each chunk's part of it is ascending. Ranges that are
/// as deep as each other are cut side by side.
std::vector<Range> split_into_chunks(std::span<const Vec3i> centers, std::size_t target,
                                     std::span<std::uint32_t> order) {
  std::vector<Range> ranges{{0, order.size()}};
  const auto is_large = [](const Range& range) { return range.end - range.begin > kChunkTriangles; };
  while (std::any_of(ranges.begin(), ranges.end(), is_large)) {
    std::vector<std::size_t> middle(ranges.size());
    parallel_for_each_index(ranges.size(), 1, [&](std::size_t i) {
      middle[i] = is_large(ranges[i]) ? cut_in_two(centers, target, ranges[i], order) : ranges[i].end;
    });
    std::vector<Range> halves;
    halves.reserve(2 * ranges.size());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      halves.push_back({ranges[i].begin, middle[i]});
      if (middle[i] < ranges[i].end) halves.push_back({middle[i], ranges[i].end});
    }
    ranges = std::move(halves);
  }
  return ranges;
}

std::size_t count_distinct_wedges(std::span<const WedgeTriangle> triangles) {
  if (const std::uint32_t limit = dense_limit(triangles); limit != 0) {
    std::vector<std::uint8_t> is_used(limit, 0);
    for (const WedgeTriangle& t : triangles) is_used[t[0]] = is_used[t[1]] = is_used[t[2]] = 1;
    return static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), 1));
  }
  LocalIds wedges(triangles.size());
  for (const WedgeTriangle& t : triangles) {
    for (const std::uint32_t wedge : t) wedges.add(wedge);
  }
  return wedges.size();
}

/// How many parts the vertex cap asks for: wedges over the cap, with a little room for those on borders.
std::size_t parts_for_vertices(std::span<const WedgeTriangle> triangles, std::uint32_t max_vertices) {
  const std::size_t room = max_vertices - std::min(max_vertices / 2, 4U);
  return (count_distinct_wedges(triangles) + room - 1) / room;
}

/// From so many pieces per part on, a chunk is a soup.
constexpr std::size_t kPiecesPerPart = 4;

/// Of triangles, times three.
std::vector<Vec3f> centers_of(std::span<const WedgeTriangle> triangles, std::span<const std::uint32_t> wedge_position,
                              std::span<const Vec3i> positions) {
  std::vector<Vec3f> centers;
  centers.reserve(triangles.size());
  const auto at = [&](std::uint32_t wedge) { return positions[wedge_position[wedge]]; };
  for (const auto& [a, b, c] : triangles) centers.emplace_back(at(a) + at(b) + at(c));
  return centers;
}

Clustering cluster_chunk(std::span<const WedgeTriangle> triangles, std::span<const std::uint32_t> wedge_position,
                         std::span<const Vec3i> positions, const ClusterCaps& caps) {
  std::vector<std::array<std::uint32_t, 3>> corners(triangles.size());
  for (std::size_t t = 0; t < corners.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) corners[t][k] = wedge_position[triangles[t][k]];
  }
  TriangleLinks links(corners);
  const std::size_t for_triangles = (triangles.size() + caps.target_triangles - 1) / caps.target_triangles;
  const std::size_t parts = std::max(triangles.size() <= caps.max_triangles ? 1 : for_triangles,
                                     parts_for_vertices(triangles, caps.max_vertices));
  const auto partition = [&](std::span<const WedgeTriangle> some, Graph graph) {
    Clustering clustering;
    clustering.count = static_cast<std::uint32_t>(std::min(parts, some.size()));
    clustering.label = caps.merge_triangles ? partition_merged(graph, centers_of(some, wedge_position, positions),
                                                               clustering.count, caps.seed)
                                            : partition_graph(graph, clustering.count, caps.seed);
    enforce_caps(some, graph, caps, clustering);
    return clustering;
  };
  std::vector<std::uint32_t> piece;
  const std::uint32_t piece_count = links.find_pieces(piece);
  if (parts == 1 || piece_count == 1) return partition(triangles, links.graph());
  if (piece_count > kPiecesPerPart * parts) {
    Clustering clustering =
        cluster_pieces(triangles, wedge_position, positions, piece, piece_count, std::min(parts, triangles.size()));
    enforce_caps(triangles, links.graph(), caps, clustering);
    return clustering;
  }
  const std::vector<TriangleLink> to_nearest = link_to_nearest(corners, positions, piece, piece_count);
  links.add(to_nearest);
  const Hosts hosts = host_debris(piece, piece_count, to_nearest);
  if (hosts.empty()) return partition(triangles, links.graph());
  const auto cluster_core = [&](std::span<const WedgeTriangle> core, std::span<const std::int32_t> weights) {
    Graph weighted = links.without(hosts).graph();
    weighted.node_weight.assign(weights.begin(), weights.end());
    return partition(core, std::move(weighted));
  };
  return cluster_with_satellites(triangles, wedge_position, positions, hosts, caps, cluster_core);
}

Clustering cluster_surface(std::span<const WedgeTriangle> triangles, std::span<const std::uint32_t> wedge_position,
                           std::span<const Vec3i> positions, const ClusterCaps& caps) {
  if (triangles.empty()) return {};
  if (triangles.size() <= kChunkTriangles) return cluster_chunk(triangles, wedge_position, positions, caps);

  UnsetVector<Vec3i> centers(triangles.size());  // times three: exact, coordinates have 24 bits
  UnsetVector<std::uint32_t> order(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain, [&](std::size_t t) {
    centers[t] = Vec3i(0);
    for (const std::uint32_t wedge : triangles[t]) centers[t] += positions[wedge_position[wedge]];
    order[t] = static_cast<std::uint32_t>(t);
  });
  const std::vector<Range> chunks = split_into_chunks(centers, caps.target_triangles, order);

  std::vector<Clustering> parts(chunks.size());
  parallel_for_each_index(chunks.size(), 1, [&](std::size_t c) {
    std::vector<WedgeTriangle> chunk;
    chunk.reserve(chunks[c].end - chunks[c].begin);
    for (std::size_t i = chunks[c].begin; i < chunks[c].end; ++i) chunk.push_back(triangles[order[i]]);
    parts[c] = cluster_chunk(chunk, wedge_position, positions, caps);
  });

  Clustering clustering;
  clustering.label.resize(triangles.size());
  std::vector<std::uint32_t> first(chunks.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    first[c] = clustering.count;
    clustering.count += parts[c].count;
  }
  parallel_for_each_index(chunks.size(), 1, [&](std::size_t c) {
    for (std::size_t i = chunks[c].begin; i < chunks[c].end; ++i) {
      clustering.label[order[i]] = first[c] + parts[c].label[i - chunks[c].begin];
    }
  });
  return clustering;
}

}  // namespace

Clustering cluster_triangles(std::span<const WedgeTriangle> triangles, std::span<const std::uint32_t> wedge_position,
                             std::span<const Vec3i> positions, const ClusterCaps& caps) {
  const Hosts hosts = host_collapsed(triangles, wedge_position, positions.size());
  // What the grid collapsed are few: clusters have room for them beside their target.
  const auto cluster_core = [&](std::span<const WedgeTriangle> core, std::span<const std::int32_t>) {
    return cluster_surface(core, wedge_position, positions, caps);
  };
  return cluster_with_satellites(triangles, wedge_position, positions, hosts, caps, cluster_core);
}

}  // namespace meshlode::builder
