// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/mesh_entries.h"

#include <utility>

namespace meshlode::app {

Hash128 MeshEntries::with_program(const Hash128& key) const {
  Hasher hasher;
  hasher.update(cache_.program());
  hasher.update(key);
  return hasher.digest();
}

std::optional<std::vector<std::uint8_t>> MeshEntries::find(const Hash128& key) {
  const auto entry = cache_.store().find(EntryKind::kMesh, with_program(key));
  if (!entry) return std::nullopt;
  return std::vector<std::uint8_t>(entry->bytes.begin(), entry->bytes.end());
}

void MeshEntries::keep(const Hash128& key, std::vector<std::uint8_t> bytes) {
  cache_.store().keep(EntryKind::kMesh, with_program(key), std::move(bytes));
}

}  // namespace meshlode::app
