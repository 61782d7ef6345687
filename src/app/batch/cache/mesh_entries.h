// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes of scenes in the cache: what is not changed in a scene that is.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/batch/cache/cache.h"
#include "base/hash.h"
#include "builder/store/mesh_store.h"

namespace meshlode::app {

class MeshEntries : public builder::MeshStore {
 public:
  /// `cache` outlives it.
  explicit MeshEntries(const Cache& cache) : cache_(cache) {}
  /// Smaller meshes are built in about the time that a file takes to be synced.
  static constexpr std::uint64_t kFewestTriangles = 1024;
  [[nodiscard]] bool wants(std::uint64_t triangles) const override { return triangles >= kFewestTriangles; }
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> find(const Hash128& key) override;
  void keep(const Hash128& key, std::vector<std::uint8_t> bytes) override;

 private:
  [[nodiscard]] Hash128 with_program(const Hash128& key) const;
  const Cache& cache_;
};

}  // namespace meshlode::app
