// SPDX-License-Identifier: GPL-3.0-or-later
// The key `warnings` of reports and manifests.
#pragma once

#include <vector>

#include "app/batch/jobs/job_result.h"
#include "base/json_writer.h"

namespace meshlode::app {

inline void write_warnings(JsonWriter& w, const std::vector<JobWarning>& warnings) {
  w.key("warnings");
  w.begin_array();
  for (const JobWarning& warning : warnings) {
    w.begin_object();
    w.field("id", warning.id);
    w.field("text", warning.text);
    w.end_object();
  }
  w.end_array();
}

}  // namespace meshlode::app
