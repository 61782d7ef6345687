// SPDX-License-Identifier: GPL-3.0-or-later
// SARIF 2.1.0 (OASIS, 27 March 2020), as code hosts take it.
#include <map>
#include <string>

#include "app/overview/overview.h"
#include "base/json_writer.h"

namespace meshlode::app {

namespace {

const char* level_of(Remark::Level level) {
  switch (level) {
    case Remark::Level::kError: return "error";
    case Remark::Level::kWarning: return "warning";
    case Remark::Level::kNote: break;
  }
  return "note";
}

void write_text(JsonWriter& w, const char* key, const std::string& text) {
  w.key(key);
  w.begin_object();
  w.field("text", text);
  w.end_object();
}

void write_tool(JsonWriter& w, const Overview& overview, const std::map<std::string, std::size_t>& rules) {
  const std::size_t space = overview.generator.rfind(' ');
  w.key("tool");
  w.begin_object();
  w.key("driver");
  w.begin_object();
  w.field("name", "meshlode");
  w.field("version", space == std::string::npos ? overview.generator : overview.generator.substr(space + 1));
  w.key("rules");
  w.begin_array();
  for (const auto& [id, index] : rules) {
    w.begin_object();
    w.field("id", id);
    w.end_object();
  }
  w.end_array();
  w.end_object();
  w.end_object();
}

void write_result(JsonWriter& w, const Remark& remark, std::size_t rule) {
  w.begin_object();
  w.field("ruleId", remark.id);
  w.field("ruleIndex", rule);
  w.field("level", level_of(remark.level));
  write_text(w, "message", remark.text);
  w.key("locations");
  w.begin_array();
  w.begin_object();
  w.key("physicalLocation");
  w.begin_object();
  w.key("artifactLocation");
  w.begin_object();
  w.field("uri", uri_of(remark.file));
  w.end_object();
  w.end_object();
  w.end_object();
  w.end_array();
  w.end_object();
}

}  // namespace

std::string overview_sarif(const Overview& overview) {
  const std::vector<Remark> remarks = list_remarks(overview);
  std::map<std::string, std::size_t> rules;
  for (const Remark& remark : remarks) rules.emplace(remark.id, 0);
  std::size_t count = 0;
  for (auto& [id, index] : rules) index = count++;
  JsonWriter w;
  w.begin_object();
  w.field("$schema", "https://json.schemastore.org/sarif-2.1.0.json");
  w.field("version", "2.1.0");
  w.key("runs");
  w.begin_array();
  w.begin_object();
  write_tool(w, overview, rules);
  w.key("invocations");
  w.begin_array();
  w.begin_object();
  w.field("executionSuccessful", overview.is_complete && overview.exit_code == 0);
  w.field("exitCode", overview.exit_code);
  w.end_object();
  w.end_array();
  w.key("results");
  w.begin_array();
  for (const Remark& remark : remarks) write_result(w, remark, rules.at(remark.id));
  w.end_array();
  w.end_object();
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace meshlode::app
