// SPDX-License-Identifier: GPL-3.0-or-later
// An independent simplifier to compare with: OpenMesh's decimater with its quadric module (and the one that refuses to
// turn faces over), over the whole mesh at once.
// It has no clusters, no locked borders and no attributes, and keeps vertices where they were (half-edge collapses).
#pragma once

#include <cstddef>
#include <memory>

#include "judge/metrics/metrics.h"

namespace meshlode::bench {

class ReferenceSimplifier {
 public:
  /// Vertices are welded by position first. Faces without area or with a repeated corner are left out before OpenMesh
  /// sees them, because it aborts on some; faces that it refuses (complex edges and vertices) are missing after.
  explicit ReferenceSimplifier(const judge::Surface& source);
  ~ReferenceSimplifier();
  ReferenceSimplifier(const ReferenceSimplifier&) = delete;
  ReferenceSimplifier& operator=(const ReferenceSimplifier&) = delete;

  [[nodiscard]] std::size_t degenerate_count() const;
  [[nodiscard]] std::size_t refused_count() const;
  [[nodiscard]] std::size_t face_count() const;
  /// Goes on from where it is, quadrics accumulated. False where nothing more can be collapsed.
  bool decimate_to(std::size_t faces);
  [[nodiscard]] judge::Surface surface() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace meshlode::bench
