// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/overview/overview.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "app/doctor/asset_faults.h"
#include "app/report/info.h"
#include "base/guarded.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

/// By kOverviewStreams.
void count_streams(const run::Asset& asset, const AssetInfo& info, OverviewAsset& row) {
  const ByteMap& map = *info.byte_map;
  const PageBits& bits = map.total;
  const std::uint64_t parts[] = {bits.positions, bits.normals,  bits.uvs,
                                 bits.colors,    bits.topology, bits.heads + bits.materials + bits.padding};
  const double all = static_cast<double>(std::max<std::uint64_t>(1, bits.total()));
  std::size_t i = 0;
  for (const std::uint64_t part : parts) {
    row.streams[i++] =
        static_cast<std::uint64_t>(static_cast<double>(map.stored_page_bytes) * (static_cast<double>(part) / all));
  }
  row.streams[i++] = map.table_bytes;
  row.streams[i++] = info.image_bytes;
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < i; ++k) sum += row.streams[k];
  row.streams[i] = asset.bytes().size() - std::min<std::uint64_t>(sum, asset.bytes().size());
}

std::string text_of(const Diagnosis& diagnosis) {
  return diagnosis.title + ": " + grouped_digits(diagnosis.count) + ". Remedy: " + diagnosis.remedy;
}

Status read_asset(const LookAtAsset& look, OverviewAsset& row) {
  const std::string path = row.result.job.output.string();
  TRY_LET(asset, run::Asset::open(path));
  if (hash128(asset->bytes()) != row.result.asset_hash) {
    return Error{ErrorCode::kCheckFailed, path, "is not the asset that the manifest lists"};
  }
  AssetInfo info = describe_asset(*asset);
  TRY_LET(map, map_bytes(*asset));
  info.byte_map = std::move(*map);
  row.triangles = info.source_triangles;
  row.stuck_groups = info.stuck_groups;
  count_streams(*asset, info, row);
  std::vector<Diagnosis> diagnoses = diagnose_asset(*asset);
  if (look) look(*asset, row, diagnoses);
  rank(diagnoses);
  for (const Diagnosis& diagnosis : diagnoses) {
    row.findings.push_back({diagnosis.id, severity_of(diagnosis.share), text_of(diagnosis)});
  }
  return Ok{};
}

}  // namespace

std::optional<std::int64_t> OverviewAsset::growth() const {
  if (!result.has_asset() || !old_bytes) return std::nullopt;
  return static_cast<std::int64_t>(result.facts.bytes) - static_cast<std::int64_t>(*old_bytes);
}

std::size_t Overview::count(JobStatus status) const {
  return static_cast<std::size_t>(std::count_if(
      assets.begin(), assets.end(), [&](const OverviewAsset& asset) { return asset.result.status == status; }));
}

std::size_t Overview::count(CacheUse use) const {
  return static_cast<std::size_t>(std::count_if(assets.begin(), assets.end(),
                                                [&](const OverviewAsset& asset) { return asset.result.cache == use; }));
}

std::size_t Overview::count_findings(const std::string& severity) const {
  std::size_t count = 0;
  for (const OverviewAsset& asset : assets) {
    for (const OverviewFinding& finding : asset.findings) count += finding.severity == severity ? 1 : 0;
  }
  return count;
}

// A manifest may say any number of bytes below 2^53: sums of 2^11 of them fit, and those of more wrap around.
std::uint64_t Overview::bytes() const {
  std::uint64_t sum = 0;
  for (const OverviewAsset& asset : assets) sum += asset.result.has_asset() ? asset.result.facts.bytes : 0;
  return sum;
}

std::uint64_t Overview::triangles() const {
  std::uint64_t sum = 0;
  for (const OverviewAsset& asset : assets) sum += asset.triangles;
  return sum;
}

std::uint64_t Overview::pixel_triangles() const {
  std::uint64_t sum = 0;
  for (const OverviewAsset& asset : assets) sum += asset.pixel_triangles.value_or(0);
  return sum;
}

std::uint64_t Overview::old_bytes() const {
  std::uint64_t sum = 0;
  for (const OverviewAsset& asset : assets) sum += asset.old_bytes.value_or(0);
  for (const GoneAsset& asset : gone) sum += asset.bytes;
  return sum;
}

std::vector<const OverviewAsset*> Overview::changed() const {
  std::vector<const OverviewAsset*> out;
  for (const OverviewAsset& asset : assets) {
    if (asset.growth().value_or(0) != 0) out.push_back(&asset);
  }
  std::stable_sort(out.begin(), out.end(), [](const OverviewAsset* a, const OverviewAsset* b) {
    const std::int64_t x = *a->growth(), y = *b->growth();
    const std::int64_t sizes[] = {x < 0 ? -x : x, y < 0 ? -y : y};
    return std::make_tuple(-sizes[0], -x) < std::make_tuple(-sizes[1], -y);
  });
  return out;
}

Overview make_overview(Manifest manifest, const Manifest* old, const LookAtAsset& look, std::size_t at_once) {
  Overview overview;
  overview.generator = std::move(manifest.generator);
  overview.versions = std::move(manifest.versions);
  overview.is_complete = manifest.is_complete;
  overview.exit_code = manifest.exit_code;
  overview.has_old = old != nullptr;
  std::map<std::filesystem::path, std::uint64_t> old_bytes;
  if (old != nullptr) {
    for (const JobResult& r : old->results) {
      if (r.has_asset()) old_bytes.emplace(r.job.output, r.facts.bytes);
    }
  }
  for (JobResult& result : manifest.results) {
    OverviewAsset& asset = overview.assets.emplace_back();
    asset.result = std::move(result);
    const auto before = old_bytes.find(asset.result.job.output);
    if (before == old_bytes.end()) continue;
    asset.old_bytes = before->second;
    old_bytes.erase(before);
  }
  for (const auto& [output, bytes] : old_bytes) overview.gone.push_back({output.string(), bytes});
  parallel_for_each_in_order(overview.assets.size(), at_once, [&](std::size_t i) {
    OverviewAsset& asset = overview.assets[i];
    for (const JobWarning& warning : asset.result.warnings) {
      asset.findings.push_back({warning.id, "warning", warning.text});
    }
    if (!asset.result.has_asset()) return;
    const Status done = guarded(asset.result.job.output, [&] { return read_asset(look, asset); });
    if (!done) asset.unread = done.error().message();
  });
  return overview;
}

std::vector<Remark> list_remarks(const Overview& overview) {
  std::vector<Remark> remarks;
  for (const OverviewAsset& asset : overview.assets) {
    const JobResult& r = asset.result;
    const std::string scene = r.job.input.string(), output = r.job.output.string();
    if (r.status == JobStatus::kFailed) {
      remarks.push_back({Remark::Level::kError, "failed", scene, r.error.empty() ? "failed" : r.error});
    }
    if (r.status == JobStatus::kSkipped) {
      remarks.push_back(
          {Remark::Level::kWarning, "skipped", scene, "skipped" + (r.error.empty() ? "" : ": " + r.error)});
    }
    if (!asset.unread.empty()) remarks.push_back({Remark::Level::kError, "unreadable-asset", output, asset.unread});
    for (const OverviewFinding& finding : asset.findings) {
      remarks.push_back({finding.severity == "low" ? Remark::Level::kNote : Remark::Level::kWarning, finding.id,
                         finding.severity == "warning" ? scene : output, finding.text});
    }
  }
  return remarks;
}

std::string uri_of(const std::string& path) {
  constexpr std::string_view kPlain = "-._~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string out = path.starts_with('/') ? "file://" : "";
  for (const char c : path) {
    const bool is_word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_word || kPlain.find(c) != std::string_view::npos) {
      out += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      out += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
  }
  return out;
}

}  // namespace meshlode::app
