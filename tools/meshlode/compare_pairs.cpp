// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare_pairs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "app/batch/shard/read_manifest.h"
#include "app/compare/stored_bytes.h"
#include "base/file.h"
#include "base/try.h"
#include "file_kind.h"
#include "kept_manifest.h"

namespace meshlode::cli {

namespace {

namespace fs = std::filesystem;

/// Indices into the older results: which of them goes with each newer one. A scene and an output that both fit come
/// before a scene alone, and that before an output alone: an output's place is free to change, and so is a scene's.
std::vector<std::optional<std::size_t>> match_results(const std::vector<app::JobResult>& before,
                                                      const std::vector<app::JobResult>& after) {
  std::vector<std::optional<std::size_t>> match(after.size());
  std::set<std::size_t> taken;
  const auto match_by = [&](const auto& key_of) {
    std::multimap<std::string, std::size_t> by_key;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (!taken.contains(i)) by_key.emplace(key_of(before[i]), i);
    }
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (match[i]) continue;
      const auto found = by_key.find(key_of(after[i]));
      if (found == by_key.end()) continue;
      match[i] = found->second;
      taken.insert(found->second);
      by_key.erase(found);
    }
  };
  const auto scene = [](const app::JobResult& r) { return r.job.input.lexically_normal().string(); };
  const auto output = [](const app::JobResult& r) { return r.job.output.lexically_normal().string(); };
  match_by([&](const app::JobResult& r) { return scene(r) + '\0' + output(r); });
  match_by(scene);
  match_by(output);
  return match;
}

/// The asset's path, and its hash; where the batch made none, why in `input`.
std::string asset_of(const app::JobResult& r, BulkInput& input, std::optional<Hash128>& hash) {
  const std::string path = r.job.output.string();
  if (r.has_asset()) {
    hash = r.asset_hash;
    return path;
  }
  input.exit_code = std::max(input.exit_code, r.exit_code != 0 ? r.exit_code : static_cast<int>(ErrorCode::kIo));
  input.error = path + ": no asset was made: " + (r.error.empty() ? "skipped" : r.error);
  return path;
}

}  // namespace

Result<run::Asset> open_sound(const std::string& path, std::uint64_t max_decoded,
                              const std::optional<Hash128>& listed) {
  Result<run::Asset> asset = open_asset(path, max_decoded);
  if (!asset) return asset;
  if (listed && hash128(asset->bytes()) != *listed) {
    return Error{ErrorCode::kCheckFailed, path, "is not the asset that the manifest lists"};
  }
  if (const Status sound = app::check_stored_bytes(*asset); !sound) {
    Error error = sound.error();
    error.where = path + ": " + error.where;
    return error;
  }
  return asset;
}

Result<std::vector<BulkInput>> pair_folders(const std::string& before, const std::string& after) {
  TRY_LET(old_files, app::find_inputs(before, app::InputKind::kAssets));
  TRY_LET(new_files, app::find_inputs(after, app::InputKind::kAssets));
  std::set<fs::path> left;
  for (const fs::path& file : old_files->files) left.insert(file.lexically_relative(before));
  std::vector<BulkInput> pairs;
  for (const fs::path& file : new_files->files) {
    const fs::path inner = file.lexically_relative(after);
    pairs.push_back({file.string(), left.erase(inner) > 0 ? (before / inner).string() : "", after, true});
  }
  for (const fs::path& inner : left) pairs.push_back({"", (before / inner).string(), before, true});
  if (!pairs.empty()) return pairs;
  return Error{ErrorCode::kIo, after, "no asset in it, and none in " + before};
}

Result<std::vector<BulkInput>> pair_manifests(const std::string& before, const std::string& after) {
  TRY_LET(old_manifest, read_kept_manifest(before));
  TRY_LET(new_manifest, read_kept_manifest(after));
  const std::vector<app::JobResult>& older = old_manifest->results;
  const std::string new_base = shared_folder(new_manifest->results), old_base = shared_folder(older);
  const auto match = match_results(older, new_manifest->results);
  std::vector<BulkInput> pairs;
  std::set<std::size_t> left;
  for (std::size_t i = 0; i < older.size(); ++i) left.insert(i);
  for (std::size_t i = 0; i < match.size(); ++i) {
    BulkInput input;
    input.base = new_base;
    if (match[i]) {
      left.erase(*match[i]);
      // An older failure is no loss: the asset is new.
      if (older[*match[i]].has_asset()) input.source = asset_of(older[*match[i]], input, input.source_hash);
    }
    input.path = asset_of(new_manifest->results[i], input, input.asset_hash);
    pairs.push_back(std::move(input));
  }
  for (const std::size_t i : left) {
    if (!older[i].has_asset()) continue;
    BulkInput input;
    input.base = old_base;
    input.source = asset_of(older[i], input, input.source_hash);
    pairs.push_back(std::move(input));
  }
  if (!pairs.empty()) return pairs;
  return Error{ErrorCode::kIo, after, "no asset in it, and none in " + before};
}

}  // namespace meshlode::cli
