// SPDX-License-Identifier: GPL-3.0-or-later
// sweep.json and the pictures beside it, read from bytes that nobody vouches for.
#pragma once

#include <filesystem>
#include <string_view>

#include <meshlode/result.h>

#include "lab/page/report_data.h"

namespace meshlode::lab::page {

/// Without the pictures. What is not there stays empty; texts and lists are taken as they are. Errors: kInvalid with
/// the place for what is no JSON, no sweep of version 1, or of another type than the schema says; and for numbers
/// beyond 1e300 in magnitude.
[[nodiscard]] Result<ReportData> read_sweep(std::string_view json);

/// Reads the pictures that the data names, each once. Errors: kInvalid for a path that leads out of `folder`, and for
/// what is no PNG or larger than 64 MiB; kIo for what cannot be read.
[[nodiscard]] Status read_pictures(ReportData& data, const std::filesystem::path& folder);

}  // namespace meshlode::lab::page
