// SPDX-License-Identifier: GPL-3.0-or-later
// sweep.json, read: what a page shows must be what the file says.
#pragma once

#include <string_view>

#include <meshlode/result.h>

#include "lab/page/report_data.h"

namespace meshlode::lab::page {

/// Without the pictures. What is not there stays empty; texts and lists are taken as they are. Errors: kInvalid with
/// the place for what is no JSON, no sweep of version 1, or of another type than the schema says; and for numbers
/// beyond 1e300 in magnitude.
[[nodiscard]] Result<ReportData> read_sweep(std::string_view json);

}  // namespace meshlode::lab::page
