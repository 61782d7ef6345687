// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify_json.h"

#include <span>

#include "base/json_writer.h"
#include "findings.h"

namespace meshlode::cli {

namespace {

void write_brackets(JsonWriter& json, std::span<const judge::CutBracket> brackets) {
  json.key("deviations");
  json.begin_array();
  for (const judge::CutBracket& cut : brackets) {
    json.begin_object();
    json.field("mesh", cut.mesh.value);
    json.field("error", cut.threshold);
    json.field("stored", cut.stored);
    json.field("lower", cut.lower);
    json.field("upper", cut.upper);
    json.field("verdict", cut.is_above(1.0) ? "above" : cut.is_undecided() ? "undecided" : "within");
    json.field("undecided_pieces", cut.undecided);
    json.end_object();
  }
  json.end_array();
}

void write_streaming(JsonWriter& json, const judge::VerifyReport::Streaming& streaming) {
  const judge::ResidentTotals& totals = streaming.residencies;
  json.key("streaming");
  json.begin_object();
  json.field("cameras", totals.cameras);
  json.field("residencies", totals.residencies);
  json.field("others", totals.others);
  json.field("naive_open", totals.naive_open);
  json.field("borders", totals.borders);
  json.field("requests", totals.requests);
  json.field("measured_cuts", streaming.errors.cuts);
  json.field("largest_error_ratio", streaming.errors.largest_ratio);
  json.end_object();
}

void write_surfaces(JsonWriter& json, const judge::IdTotals& totals) {
  json.key("surfaces");
  json.begin_object();
  json.field("pictures", totals.pictures);
  json.field("pixels", totals.all.pixels);
  json.field("astray", totals.all.astray);
  json.field("farthest_px", totals.all.farthest_px);
  json.field("worst_share", totals.worst.share());
  json.field("worst_picture", totals.worst_picture);
  json.field("beyond_limit", totals.beyond_limit);
  json.end_object();
}

}  // namespace

std::string verify_json(const std::string& path, const std::string& source, const judge::VerifyOptions& options,
                        const judge::VerifyReport& report) {
  JsonWriter json;
  json.begin_object();
  json.field("file", path);
  json.field("source", source);
  json.field("quick", options.is_quick);
  json.field("uniform_cuts", options.uniform_cuts);
  json.field("cameras", options.cameras);
  json.key("deviation_cuts");
  if (options.deviation_cuts == judge::kAllCuts && !options.is_quick) {
    json.value("all");
  } else {
    json.value(std::uint64_t{options.is_quick ? 1 : options.deviation_cuts});
  }
  json.field("deviation_budget", options.deviation_budget);
  json.field("deviation_samples", options.deviation_samples);
  json.field("seed", options.seed);
  json.field("verified", report.finding_count == 0);
  json.field("finding_count", report.finding_count);
  json.key("checks");
  json.begin_array();
  for (const judge::VerifyReport::Check& check : report.checks) {
    json.begin_object();
    json.field("invariant", check.invariant);
    json.field("what", check.what);
    json.field("items", check.items);
    json.field("failures", check.failures);
    json.field("skipped", check.skipped);
    json.end_object();
  }
  json.end_array();
  if (report.crowded_edges) {
    json.key("crowded_edges");
    json.begin_object();
    json.field("cuts", report.crowded_edges->cuts);
    json.field("level0", report.crowded_edges->level0);
    json.field("most", report.crowded_edges->most);
    json.field("keeps_topology", report.crowded_edges->keeps_topology);
    json.end_object();
  }
  if (!report.brackets.empty()) write_brackets(json, report.brackets);
  if (report.surfaces) write_surfaces(json, *report.surfaces);
  if (report.streaming) write_streaming(json, *report.streaming);
  if (!report.promises.empty()) {
    json.key("promises");
    json.begin_array();
    for (const judge::VerifyReport::PromisedCuts& promised : report.promises) {
      json.begin_object();
      json.field("promise", promised.promise);
      json.field("cuts", promised.cuts);
      json.field("exceeded", promised.exceeded);
      json.field("median", promised.median);
      json.field("largest", promised.largest);
      json.end_object();
    }
    json.end_array();
  }
  write_findings(json, report.findings);
  json.end_object();
  return json.text();
}

}  // namespace meshlode::cli
