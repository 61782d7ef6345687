// SPDX-License-Identifier: GPL-3.0-or-later
#include "tally.h"

#include <algorithm>
#include <cstdio>

namespace meshlode::test {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

void Tally::add(const Entry& entry) {
  const TrialResult& r = entry.result;
  if (entry.was_skipped) return;
  ++scenes;
  ++(r.refusal ? refused : r.rules.empty() ? clean : failed);
  for (const auto& [rule, count] : r.rules) ++rules[rule];
  if (r.refusal) ++refusals[*r.refusal];
  triangles += entry.triangles;
  cuts += r.cuts;
  cuts_above += r.cuts_above;
  cuts_undecided += r.cuts_undecided;
  largest_ratio = std::max(largest_ratio, r.largest_ratio);
  build_seconds += r.build_seconds;
  total_seconds += r.total_seconds;
  if (entry.triangles < 1000) return;  // what starting the program costs says nothing about its speed
  const double rate = 1e4 * r.build_seconds / static_cast<double>(entry.triangles);
  if (!slowest.empty() && rate <= slowest_rate) return;
  slowest = entry.name;
  slowest_rate = rate;
  slowest_triangles = entry.triangles;
}

void print_entry(const Entry& entry, bool verbose) {
  const TrialResult& r = entry.result;
  if (entry.was_skipped || (r.is_clean() && !verbose)) return;
  std::string outcome;
  for (const auto& [rule, count] : r.rules)
    outcome += (outcome.empty() ? "" : " ") + rule + "x" + std::to_string(count);
  if (r.refusal) outcome = "refused, " + *r.refusal;
  if (outcome.empty()) outcome = "clean";
  std::printf("%s: %llu triangles, %.2f s to build, %.2f s in all: %s\n", entry.name.c_str(),
              static_cast<unsigned long long>(entry.triangles), r.build_seconds, r.total_seconds, outcome.c_str());
  std::printf("    %s%s%s\n", entry.contents.c_str(), entry.build_options.empty() ? "" : "  ",
              joined(entry.build_options).c_str());
  if (!r.detail.empty()) std::printf("    %s\n", r.detail.c_str());
}

void print_tally(const Tally& sum) {
  const auto whole = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("%llu scenes, %llu triangles: %llu clean, %llu refused, %llu failed; %.1f s to build, %.1f s in all\n",
              whole(sum.scenes), whole(sum.triangles), whole(sum.clean), whole(sum.refused), whole(sum.failed),
              sum.build_seconds, sum.total_seconds);
  for (const auto& [reason, count] : sum.refusals) std::printf("  refused %llu: %s\n", whole(count), reason.c_str());
  for (const auto& [rule, count] : sum.rules) std::printf("  failed %llu: %s\n", whole(count), rule.c_str());
  std::printf(
      "I7: %llu cuts measured, %llu deviate by more than they store (%.2f%%), largest true/stored %.3f, "
      "%llu undecided\n",
      whole(sum.cuts), whole(sum.cuts_above),
      sum.cuts == 0 ? 0.0 : 100.0 * static_cast<double>(sum.cuts_above) / static_cast<double>(sum.cuts),
      sum.largest_ratio, whole(sum.cuts_undecided));
  if (sum.slowest.empty()) return;
  std::printf("slowest: %s, %.2f s to build 10,000 of its triangles (%llu triangles)\n", sum.slowest.c_str(),
              sum.slowest_rate, whole(sum.slowest_triangles));
}

int verdict(const Tally& sum, std::uint64_t max_refused_percent) {
  bool is_well = sum.failed == 0;
  if (100 * sum.refused > max_refused_percent * sum.scenes) {
    std::printf("too many refused: at most %llu%% may be\n", static_cast<unsigned long long>(max_refused_percent));
    is_well = false;
  }
  if (sum.cuts >= 1000 && 100 * sum.cuts_above > sum.cuts) {
    std::puts("more than 1% of the cuts deviate by more than they store");
    is_well = false;
  }
  return is_well ? 0 : 6;
}

}  // namespace meshlode::test
