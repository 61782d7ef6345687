// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/cache.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "app/batch/cache/ingredients.h"

namespace meshlode::app {

namespace {

namespace fs = std::filesystem;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Hash128 place_of(const fs::path& output) {
  std::error_code error;
  const fs::path absolute = fs::absolute(output, error).lexically_normal();
  return hash128(bytes_of(absolute.native()));
}

}  // namespace

std::optional<AssetRecord> Cache::find_record(const std::string& ingredients) const {
  const auto entry = store_.find(EntryKind::kRecord, key_of(ingredients));
  if (!entry) return std::nullopt;
  auto record = read_record(entry->bytes);
  if (!record || record->ingredients != ingredients) return std::nullopt;
  return record;
}

void Cache::keep(const AssetRecord& record, std::span<const std::uint8_t> asset) const {
  store_.keep_asset(record.asset, asset);
  store_.keep(EntryKind::kRecord, key_of(record.ingredients), record_bytes(record));
}

void Cache::remember(const fs::path& output, const std::string& ingredients) const {
  const Hash128 place = place_of(output);
  const auto known = store_.find(EntryKind::kLast, place);
  const auto bytes = bytes_of(ingredients);
  if (known && std::equal(known->bytes.begin(), known->bytes.end(), bytes.begin(), bytes.end())) return;
  store_.keep(EntryKind::kLast, place, {bytes.begin(), bytes.end()});
}

std::string Cache::explain(const fs::path& output, const std::string& ingredients) const {
  const auto last = store_.find(EntryKind::kLast, place_of(output));
  if (!last) return "not built before";
  const std::string before(reinterpret_cast<const char*>(last->bytes.data()), last->bytes.size());
  const std::string change = explain_change(before, ingredients);
  return change.empty() ? "its asset is no longer in the cache" : change;
}

}  // namespace meshlode::app
