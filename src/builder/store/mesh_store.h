// SPDX-License-Identifier: GPL-3.0-or-later
// Where built meshes may be kept between builds: what this is, the build does not know.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/hash.h"

namespace meshlode::builder {

/// Called from several threads at once.
class MeshStore {
 public:
  virtual ~MeshStore() = default;
  /// Whether a mesh of so many triangles is worth keeping.
  [[nodiscard]] virtual bool wants(std::uint64_t triangles) const = 0;
  /// What was kept under the key, or nothing. The same program must have kept it.
  [[nodiscard]] virtual std::optional<std::vector<std::uint8_t>> find(const Hash128& key) = 0;
  virtual void keep(const Hash128& key, std::vector<std::uint8_t> bytes) = 0;
};

}  // namespace meshlode::builder
