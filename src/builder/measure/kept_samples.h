// SPDX-License-Identifier: GPL-3.0-or-later
// A cluster's samples of the source from one round to the next, without what the next round finds out anew. Nearly all
// of a dense source's are vertices of it: eight bytes each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/release.h"
#include "base/vec.h"
#include "builder/deviation/deviation.h"

namespace meshlode::builder {

class KeptSamples {
 public:
  /// For so many samples, so many of them that are no vertex.
  void reserve(std::size_t samples, std::size_t loose) {
    samples_.reserve(samples);
    loose_.reserve(loose);
  }
  void add(const CarriedSample& sample) {
    samples_.push_back({sample.vertex, sample.place});
    if (sample.vertex == kNoId) loose_.push_back(sample.point);
  }
  /// In the order in which they were added; of no triangle yet. `positions`: the source's.
  void append_to(std::vector<CarriedSample>& out, std::span<const Vec3d> positions) const {
    std::size_t next = 0;
    for (const Sample& sample : samples_) {
      const Vec3d& point = sample.vertex == kNoId ? loose_[next++] : positions[sample.vertex];
      out.push_back({point, 0, 0.0F, sample.place, sample.vertex});
    }
  }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }
  void free() { release(samples_, loose_); }

 private:
  struct Sample {
    std::uint32_t vertex;  ///< kNoId: the next of the loose points
    TreeSlot place;
  };
  std::vector<Sample> samples_;
  std::vector<Vec3d> loose_;
};

}  // namespace meshlode::builder
