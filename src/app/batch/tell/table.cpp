// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "app/batch/tell/tell.h"
#include "base/append_format.h"

namespace meshlode::app {

namespace {

/// 1,234,567
std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

/// One line whatever names hold.
std::string plain(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return text;
}

}  // namespace

std::string summary_table(const std::vector<JobResult>& results) {
  std::string text;
  append_format(text, "%-11s %13s %15s %9s  %s\n", "status", "triangles", "bytes", "seconds", "file");
  std::uint64_t triangles = 0, bytes = 0;
  double seconds = 0.0;
  for (const JobResult& r : results) {
    const bool has_facts = r.has_asset();
    append_format(text, "%-11s %13s %15s %9.2f  ", name_of(r.status),
                  has_facts ? grouped(r.facts.triangles).c_str() : "", has_facts ? grouped(r.facts.bytes).c_str() : "",
                  r.seconds);
    text += plain(r.job.input.string()) + (has_facts ? " -> " + plain(r.job.output.string()) : "") + "\n";
    for (const JobWarning& warning : r.warnings) {
      append_format(text, "%-11s %13s %15s %9s  %s\n", "  warning", "", "", "", warning.text.c_str());
    }
    triangles += has_facts ? r.facts.triangles : 0;
    bytes += has_facts ? r.facts.bytes : 0;
    seconds += r.seconds;
  }
  append_format(text, "%-11s %13s %15s %9.2f  ", "", grouped(triangles).c_str(), grouped(bytes).c_str(), seconds);
  return text + summary_line(results) + "\n";
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
