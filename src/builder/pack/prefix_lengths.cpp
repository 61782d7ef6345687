// SPDX-License-Identifier: GPL-3.0-or-later
// Package-merge (Larmore and Hirschberg, 1990): of all codes within the limit the one with the fewest bits.
#include "builder/pack/prefix_lengths.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "format/prefix_code.h"

namespace meshlode::builder {

namespace {

struct Package {
  std::uint64_t weight = 0;
  std::vector<std::uint16_t> symbols;  ///< each one's length grows by one when the package is taken
};

bool is_lighter(const Package& a, const Package& b) {
  return a.weight < b.weight;
}

}  // namespace

std::vector<std::uint8_t> choose_code_lengths(std::span<const std::uint64_t> counts) {
  std::vector<std::uint8_t> lengths(counts.size(), 0);
  std::vector<Package> symbols;
  for (std::size_t s = 0; s < counts.size(); ++s) {
    if (counts[s] > 0) symbols.push_back({counts[s], {static_cast<std::uint16_t>(s)}});
  }
  if (symbols.size() == 1) lengths[symbols[0].symbols[0]] = 1;
  if (symbols.size() < 2) return lengths;
  std::stable_sort(symbols.begin(), symbols.end(), is_lighter);

  std::vector<Package> packages;
  for (std::uint32_t bit = 0; bit < format::kMaxCodeBits; ++bit) {
    std::vector<Package> merged;
    merged.reserve(symbols.size() + packages.size());
    std::merge(symbols.begin(), symbols.end(), packages.begin(), packages.end(), std::back_inserter(merged),
               is_lighter);
    if (bit + 1 == format::kMaxCodeBits) {
      packages = std::move(merged);
      break;
    }
    packages.clear();
    for (std::size_t i = 0; i + 1 < merged.size(); i += 2) {
      Package pair = std::move(merged[i]);
      pair.weight += merged[i + 1].weight;
      pair.symbols.insert(pair.symbols.end(), merged[i + 1].symbols.begin(), merged[i + 1].symbols.end());
      packages.push_back(std::move(pair));
    }
  }
  for (std::size_t i = 0; i < 2 * symbols.size() - 2; ++i) {
    for (const std::uint16_t s : packages[i].symbols) ++lengths[s];
  }
  return lengths;
}

}  // namespace meshlode::builder
