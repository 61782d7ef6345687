// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>
#include <string>

#include "base/append_format.h"
#include "lab/sweep/sweep.h"

namespace meshlode::lab {

namespace {

/// RFC 4180.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

void add_number(std::string& row, double value) {
  append_format(row, ",%.9g", value);
}

std::string head_line(const SweepResult& result) {
  std::string head = "id,label,why,status";
  for (const Knob& knob : result.knobs) head += "," + knob.name;
  for (const Metric& metric : all_metrics()) {
    const std::string key = metric.key;
    head += "," + key;
    if (!metric.is_timed) continue;
    for (const char* part : {"_min", "_max", "_n"}) head.append(",").append(key).append(part);
  }
  return head + "\n";
}

std::string point_line(const SweepResult& result, const PointResult& one) {
  std::string row = one.id + "," + cell(one.label) + "," + name_in(kPointKindNames, one.point.kind);
  row += one.error.empty() ? ",done" : ",failed";
  for (std::size_t k = 0; k < result.knobs.size(); ++k) {
    row += "," + cell(result.knobs[k].values[one.point.values[k]].word);
  }
  for (const Metric& metric : all_metrics()) {
    const auto found = one.figures.find(metric.key);
    if (found == one.figures.end()) {
      row += metric.is_timed ? ",,,," : ",";
      continue;
    }
    add_number(row, found->second.value);
    if (!metric.is_timed) continue;
    add_number(row, found->second.min);
    add_number(row, found->second.max);
    append_format(row, ",%u", found->second.count);
  }
  return row + "\n";
}

}  // namespace

std::string sweep_csv(const SweepResult& result) {
  std::string text = head_line(result);
  for (const PointResult& one : result.points) {
    if (one.is_done) text += point_line(result, one);
  }
  return text;
}

}  // namespace meshlode::lab
