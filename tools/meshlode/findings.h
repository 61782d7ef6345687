// SPDX-License-Identifier: GPL-3.0-or-later
// The findings of validate and verify, as both print them.
#pragma once

#include <vector>

#include "base/json_writer.h"
#include "judge/validate/rules.h"

namespace meshlode::cli {

/// The key "findings" with its array, into an object that is open.
inline void write_findings(JsonWriter& json, const std::vector<judge::Finding>& findings) {
  json.key("findings");
  json.begin_array();
  for (const judge::Finding& finding : findings) {
    json.begin_object();
    json.field("id", finding.id);
    json.field("invariant", finding.invariant);
    json.field("where", finding.where);
    json.field("detail", finding.detail);
    json.end_object();
  }
  json.end_array();
}

}  // namespace meshlode::cli
