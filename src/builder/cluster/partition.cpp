// SPDX-License-Identifier: GPL-3.0-or-later
// METIS 5.1 draws from libc's rand(), reseeding at each call. Two threads then disturb each other's sequence (42% of
// results differed in a trial), so that either the executable gives each thread a sequence of its own, with the same
// numbers as libc's (thread_rand.cpp), or calls are serialised here. Both ways give the same labels.
#include "builder/cluster/partition.h"

#include <algorithm>
#include <mutex>
#include <new>
#include <numeric>

#include <metis.h>

// Present only where thread_rand.cpp is linked in.
extern "C" __attribute__((weak)) std::uint64_t meshlode_thread_rand_calls();

namespace meshlode::builder {

namespace {

static_assert(sizeof(idx_t) == sizeof(std::int32_t), "Graph hands its arrays to METIS as they are");

/// False if METIS did not return METIS_OK; throws std::bad_alloc where it ran out of memory. `shares`: of each part, or
/// none where they are equal.
bool call_metis(Graph& graph, std::uint32_t parts, std::span<const std::uint32_t> shares, std::uint32_t seed,
                std::vector<idx_t>& labels) {
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_UFACTOR] = 1;
  options[METIS_OPTION_SEED] = static_cast<idx_t>(seed);
  options[METIS_OPTION_NUMBERING] = 0;
  auto node_count = static_cast<idx_t>(graph.node_count());
  idx_t constraint_count = 1;
  auto part_count = static_cast<idx_t>(parts);
  idx_t cut = 0;
  const std::uint32_t total = std::accumulate(shares.begin(), shares.end(), 0U);
  std::vector<real_t> part_weights;
  for (const std::uint32_t share : shares) {
    part_weights.push_back(static_cast<real_t>(share) / static_cast<real_t>(total));
  }
  labels.assign(graph.node_count(), 0);
  const int code = METIS_PartGraphRecursive(
      &node_count, &constraint_count, graph.row_start.data(), graph.neighbor.data(),
      graph.node_weight.empty() ? nullptr : graph.node_weight.data(), nullptr, graph.edge_weight.data(), &part_count,
      part_weights.empty() ? nullptr : part_weights.data(), nullptr, options, &cut, labels.data());
  if (code == METIS_ERROR_MEMORY) throw std::bad_alloc();  // another partition would be another asset
  return code == METIS_OK;
}

/// A ring of 64 nodes, large enough that METIS draws random numbers for it.
Graph ring() {
  constexpr std::int32_t kNodes = 64;
  Graph graph;
  graph.row_start.push_back(0);
  for (std::int32_t i = 0; i < kNodes; ++i) {
    graph.neighbor.push_back((i + kNodes - 1) % kNodes);
    graph.neighbor.push_back((i + 1) % kNodes);
    graph.row_start.push_back(static_cast<std::int32_t>(graph.neighbor.size()));
  }
  graph.edge_weight.assign(graph.neighbor.size(), 1);
  return graph;
}

/// Symbol interposition depends on how the program was linked, so it is tried, not assumed.
bool probe_thread_rand() {
  if (meshlode_thread_rand_calls == nullptr) return false;
  const std::uint64_t before = meshlode_thread_rand_calls();
  Graph graph = ring();
  std::vector<idx_t> labels;
  (void)call_metis(graph, 4, {}, 1, labels);
  return meshlode_thread_rand_calls() != before;
}

std::mutex& metis_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::vector<std::uint32_t> divide(Graph& graph, std::uint32_t parts, std::span<const std::uint32_t> shares,
                                  std::uint32_t seed) {
  const std::size_t node_count = graph.node_count();
  std::vector<std::uint32_t> labels(node_count, 0);
  if (parts <= 1 || node_count <= 1) return labels;  // METIS divides by zero at one part
  if (parts >= node_count) {
    std::iota(labels.begin(), labels.end(), 0U);
    return labels;
  }
  std::vector<idx_t> metis_labels;
  bool ok = false;
  if (is_partition_concurrent()) {
    ok = call_metis(graph, parts, shares, seed, metis_labels);
  } else {
    const std::lock_guard lock(metis_mutex());
    ok = call_metis(graph, parts, shares, seed, metis_labels);
  }
  if (!ok) {
    for (std::size_t i = 0; i < node_count; ++i) labels[i] = static_cast<std::uint32_t>(i * parts / node_count);
    return labels;
  }
  for (std::size_t i = 0; i < node_count; ++i) {
    labels[i] = std::min(static_cast<std::uint32_t>(metis_labels[i]), parts - 1);
  }
  fill_empty_parts(labels, parts);
  return labels;
}

}  // namespace

bool is_partition_concurrent() {
  static const bool concurrent = [] {
    const std::lock_guard lock(metis_mutex());
    return probe_thread_rand();
  }();
  return concurrent;
}

/// Recursive bisection may leave a part empty on odd graphs.
void fill_empty_parts(std::vector<std::uint32_t>& labels, std::uint32_t parts) {
  std::vector<std::uint32_t> sizes(parts, 0);
  for (const std::uint32_t label : labels) ++sizes[label];
  for (std::uint32_t part = 0; part < parts; ++part) {
    if (sizes[part] != 0) continue;
    const auto largest = static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    if (sizes[largest] < 2) return;
    const auto last = std::find(labels.rbegin(), labels.rend(), largest);
    *last = part;
    --sizes[largest];
    ++sizes[part];
  }
}

std::vector<std::uint32_t> partition_graph(Graph& graph, std::uint32_t parts, std::uint32_t seed) {
  return divide(graph, parts, {}, seed);
}

std::vector<std::uint32_t> partition_graph(Graph& graph, std::span<const std::uint32_t> shares, std::uint32_t seed) {
  return divide(graph, static_cast<std::uint32_t>(shares.size()), shares, seed);
}

}  // namespace meshlode::builder
