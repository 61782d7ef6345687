// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/shard/read_manifest.h"

#include <array>
#include <utility>

#include "app/batch/batch.h"
#include "base/file.h"
#include "base/try.h"
#include "scene/import/json.h"

namespace meshlode::app {

namespace {

using scene::Json;

constexpr std::array kFileKinds = {FileKind::kScene, FileKind::kBuffer, FileKind::kImage, FileKind::kMaterials,
                                   FileKind::kSettings};

const Json::Array kNoObjects;

std::optional<Hash128> parse_hash(std::string_view text) {
  Hash128 hash{};
  if (text.size() != 2 * hash.size()) return std::nullopt;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    if (digit < 0) return std::nullopt;
    hash[i / 2] = static_cast<std::uint8_t>(hash[i / 2] * 16 + digit);
  }
  return hash;
}

/// Members as values. The first that is none is remembered, and reading goes on with nothing in its place.
class Members {
 public:
  /// `place` is where the next members are: "/assets/3".
  void enter(std::string place) { place_ = std::move(place); }
  [[nodiscard]] bool is_sound() const { return !error_; }
  [[nodiscard]] const Error& error() const { return *error_; }

  void refuse(std::string_view key, const char* expected) {
    if (!error_) error_ = Error{ErrorCode::kInvalid, place_ + "/" + std::string(key), std::string(expected)};
  }
  std::string text(const Json& from, std::string_view key) {
    const Json* member = from.find(key);
    if (member != nullptr && member->is_string()) return std::string(*member->string());
    refuse(key, "no text");
    return {};
  }
  std::uint64_t number(const Json& from, std::string_view key, std::uint64_t limit) {
    const Json* member = from.find(key);
    const auto number = member != nullptr ? member->index() : std::nullopt;
    if (number && *number <= limit) return *number;
    refuse(key, "no whole number within its range");
    return 0;
  }
  Hash128 hash(const Json& from, std::string_view key) {
    const Json* member = from.find(key);
    const auto hash = member != nullptr && member->is_string() ? parse_hash(*member->string()) : std::nullopt;
    if (hash) return *hash;
    refuse(key, "no hash of 32 hexadecimal digits");
    return {};
  }
  static bool is_null(const Json& from, std::string_view key) {
    const Json* member = from.find(key);
    return member != nullptr && std::holds_alternative<scene::JsonNull>(member->value);
  }
  /// Of objects alone.
  const Json::Array& objects(const Json& from, std::string_view key) {
    const Json* member = from.find(key);
    if (member == nullptr || !member->is_array()) {
      refuse(key, "no array");
      return kNoObjects;
    }
    for (const Json& item : *member->array()) {
      if (!item.is_object()) refuse(key, "no array of objects");
    }
    return *member->array();
  }

 private:
  std::string place_;
  std::optional<Error> error_;
};

constexpr std::uint64_t kAnyNumber = std::uint64_t{1} << 53U;  // Json::index() has no larger ones

Dependency read_file(Members& in, const Json& json) {
  Dependency file;
  const std::string kind = in.text(json, "kind");
  bool is_known = false;
  for (const FileKind known : kFileKinds) {
    if (kind != name_of(known)) continue;
    file.kind = known;
    is_known = true;
  }
  if (!is_known) in.refuse("kind", "no kind of file");
  file.path = in.text(json, "path");
  if (Members::is_null(json, "hash") && Members::is_null(json, "bytes")) return file;
  file.hash = in.hash(json, "hash");
  file.stamp.emplace().bytes = in.number(json, "bytes", kAnyNumber);
  return file;
}

constexpr double kMostSeconds = 1e12;  ///< 30,000 years: what a page writes with its digits

double read_seconds(Members& in, const Json& json, const char* key) {
  const Json* seconds = json.find(key);
  const auto number = seconds != nullptr ? seconds->number() : std::nullopt;
  const bool is_time = number && *number >= 0.0 && *number <= kMostSeconds;
  if (!is_time) in.refuse(key, "no number of seconds");
  return is_time ? *number : 0.0;
}

/// What version 1 has not.
void read_more(Members& in, const Json& json, JobResult& r) {
  if (!Members::is_null(json, "settings")) {
    const Json* settings = json.find("settings");
    auto effective = settings != nullptr && settings->is_object()
                         ? read_effective(*settings)
                         : Result<EffectiveSettings>(Error{ErrorCode::kInvalid, "", "no object"});
    if (!effective) in.refuse("settings" + effective.error().where, effective.error().detail.c_str());
    if (effective) r.settings = std::move(*effective);
  }
  const Json* cache = json.find("cache");
  if (cache == nullptr || !cache->is_object()) return in.refuse("cache", "no object");
  const auto use = value_in(kCacheUseNames, in.text(*cache, "use"));
  if (!use) in.refuse("cache/use", "no use of a cache");
  r.cache = use.value_or(CacheUse::kNone);
  if (!Members::is_null(*cache, "reason")) r.reason = in.text(*cache, "reason");
  r.meshes_from_cache = in.number(*cache, "meshes", kAnyNumber);
  r.processor_seconds = read_seconds(in, json, "processor_seconds");
  if (!Members::is_null(json, "peak_memory_bytes")) r.peak_memory = in.number(json, "peak_memory_bytes", kAnyNumber);
}

JobResult read_result(Members& in, const Json& json, std::uint64_t version) {
  JobResult r;
  r.job.input = in.text(json, "input");
  r.job.output = in.text(json, "output");
  for (const auto& [key, path] : {std::pair{"input", &r.job.input}, std::pair{"output", &r.job.output}}) {
    if (path->empty() || path->native().find('\0') != std::string::npos) in.refuse(key, "no path");
  }
  const auto status = value_in(kJobStatusNames, in.text(json, "status"));
  if (!status || *status == JobStatus::kWouldBuild || *status == JobStatus::kWouldCopy) {
    in.refuse("status", "no status of a batch");
  }
  r.status = status.value_or(JobStatus::kSkipped);
  r.exit_code = static_cast<int>(in.number(json, "exit_code", 255));
  if ((r.status == JobStatus::kFailed) != (r.exit_code != 0)) in.refuse("exit_code", "contradicts the status");
  if (!Members::is_null(json, "error")) r.error = in.text(json, "error");
  if (r.has_asset()) {
    r.asset_hash = in.hash(json, "hash");
  } else if (!Members::is_null(json, "hash")) {
    in.refuse("hash", "contradicts the status");
  }
  r.facts.bytes = in.number(json, "bytes", r.has_asset() ? kAnyNumber : 0);
  r.seconds = read_seconds(in, json, "seconds");
  if (version > 1) read_more(in, json, r);
  for (const Json& warning : in.objects(json, "warnings")) {
    if (!in.is_sound()) break;
    r.warnings.push_back({in.text(warning, "id"), in.text(warning, "text")});
  }
  for (const Json& file : in.objects(json, "files")) {
    if (!in.is_sound()) break;
    r.files.push_back(read_file(in, file));
  }
  return r;
}

/// settings_text() of them again: a line each.
std::string read_settings(Members& in, const Json& root) {
  std::string text;
  const Json* settings = root.find("settings");
  if (settings == nullptr || !settings->is_object()) {
    in.refuse("settings", "no object");
    return text;
  }
  for (const scene::JsonMember& member : *settings->object()) {
    const auto value = member.value.string();
    if (!value || member.key.find_first_of(" \n") != std::string::npos || value->find('\n') != std::string::npos) {
      in.refuse("settings", "no setting of one line");
      return text;
    }
    text.append(member.key).append(" ").append(*value).append("\n");
  }
  return text;
}

Versions read_versions(Members& in, const Json& root) {
  Versions versions;
  const Json* json = root.find("versions");
  if (json == nullptr || !json->is_object()) {
    in.refuse("versions", "no object");
    return versions;
  }
  for (const scene::JsonMember& member : *json->object()) versions.emplace_back(member.key, in.text(*json, member.key));
  return versions;
}

ShardPlan read_shard(Members& in, const Json& json) {
  ShardPlan plan;
  in.enter("/shard");
  if (!json.is_object()) in.refuse("", "no object");
  plan.shard.count = static_cast<std::uint32_t>(in.number(json, "count", kMaxShards));
  plan.shard.index = static_cast<std::uint32_t>(in.number(json, "index", plan.shard.count));
  if (plan.shard.index == 0) in.refuse("index", "shards are counted from 1");
  plan.batch_jobs = in.number(json, "files", kAnyNumber);
  plan.batch = in.hash(json, "batch");
  return plan;
}

}  // namespace

Result<Manifest> parse_manifest(std::string_view text) {
  TRY_LET(root, scene::parse_json(text));
  if (!root->is_object()) return Error{ErrorCode::kInvalid, "", "no manifest: no object"};
  Members in;
  Manifest manifest;
  manifest.generator = in.text(*root, "generator");
  if (root->find("version") != nullptr) manifest.version = in.number(*root, "version", kAnyNumber);
  if (manifest.version > kManifestVersion) {
    return Error{ErrorCode::kUnsupported, "",
                 "a manifest of version " + std::to_string(manifest.version) + "; this program reads versions up to " +
                     std::to_string(kManifestVersion)};
  }
  manifest.program = in.hash(*root, "program");
  if (manifest.version > 1) manifest.versions = read_versions(in, *root);
  manifest.settings = read_settings(in, *root);
  manifest.exit_code = static_cast<int>(in.number(*root, "exit_code", 255));
  if (const Json* complete = root->find("complete")) {
    const bool* truth = std::get_if<bool>(&complete->value);
    if (truth == nullptr) in.refuse("complete", "neither true nor false");
    manifest.is_complete = truth == nullptr || *truth;
  }
  if (const Json* shard = root->find("shard")) manifest.shard = read_shard(in, *shard);
  in.enter("");
  const Json::Array& assets = in.objects(*root, "assets");
  for (std::size_t i = 0; i < assets.size() && in.is_sound(); ++i) {
    in.enter("/assets/" + std::to_string(i));
    if (manifest.shard) {
      std::vector<std::uint64_t>& positions = manifest.shard->positions;
      const std::uint64_t position = in.number(assets[i], "position", kAnyNumber);
      if (position >= manifest.shard->batch_jobs || (i > 0 && position <= positions.back())) {
        in.refuse("position", "not in order, or beyond the batch");
      }
      positions.push_back(position);
    }
    manifest.results.push_back(read_result(in, assets[i], manifest.version));
  }
  in.enter("");
  const int worst = worst_exit_code(manifest.results);
  if (manifest.is_complete ? manifest.exit_code != worst : manifest.exit_code < worst)
    in.refuse("exit_code", "contradicts the assets");
  if (!in.is_sound()) return in.error();
  return manifest;
}

Result<Manifest> read_manifest(const std::filesystem::path& path) {
  TRY_LET(file, MappedFile::open(path));
  auto manifest = parse_manifest({reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()});
  if (manifest) return manifest;
  Error error = manifest.error();
  error.where = path.string() + (error.where.empty() ? "" : ": " + error.where);
  return error;
}

}  // namespace meshlode::app
