// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "app/batch/tell/tell.h"
#include "base/append_format.h"
#include "base/printable.h"

namespace meshlode::app {

CacheCounts count_cache_use(const std::vector<JobResult>& results) {
  CacheCounts counts;
  for (const JobResult& r : results) {
    counts.hits += r.cache == CacheUse::kHit ? 1 : 0;
    counts.misses += r.cache == CacheUse::kMiss ? 1 : 0;
    counts.meshes += r.meshes_from_cache;
  }
  return counts;
}

std::string summary_text(const std::vector<JobResult>& results) {
  std::uint64_t triangles = 0, bytes = 0;
  double seconds = 0.0;
  for (const JobResult& r : results) {
    triangles += r.has_asset() ? r.facts.triangles : 0;
    bytes += r.has_asset() ? r.facts.bytes : 0;
    seconds += r.seconds;
  }
  std::string text = summary_line(results);
  if (const CacheCounts cache = count_cache_use(results); cache.hits + cache.misses > 0) {
    text += "; cache: " + grouped_digits(cache.hits) + (cache.hits == 1 ? " hit, " : " hits, ") +
            grouped_digits(cache.misses) + (cache.misses == 1 ? " miss" : " misses");
    if (cache.meshes > 0) text += ", " + grouped_digits(cache.meshes) + (cache.meshes == 1 ? " mesh" : " meshes");
  }
  append_format(text, "; %s triangles, %s bytes, %.2f s\n", grouped_digits(triangles).c_str(),
                grouped_digits(bytes).c_str(), seconds);
  return text;
}

std::string summary_line(const std::vector<JobResult>& results) {
  std::array<std::size_t, kJobStatusCount> counts{};
  for (const JobResult& r : results) ++counts[static_cast<std::size_t>(r.status)];
  const std::string files = std::to_string(results.size()) + (results.size() == 1 ? " file" : " files");
  const auto is_warned = [](const JobResult& r) { return !r.warnings.empty() && r.status != JobStatus::kFailed; };
  const auto warned_count = std::count_if(results.begin(), results.end(), is_warned);
  const std::string warned = warned_count == 0 ? "" : "; " + std::to_string(warned_count) + " with warnings";
  if (!results.empty() && counts[static_cast<std::size_t>(JobStatus::kUnchanged)] == results.size()) {
    return "nothing to do: " + files + " unchanged" + warned;
  }
  std::string text = files + ":";
  const char* comma = " ";
  for (const auto& [status, name] : kJobStatusNames) {
    const std::size_t count = counts[static_cast<std::size_t>(status)];
    if (count == 0) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    text += comma + std::to_string(count) + " " + words;
    comma = ", ";
  }
  return text + warned;
}

}  // namespace meshlode::app
