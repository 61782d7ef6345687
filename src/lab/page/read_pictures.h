// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include <meshlode/result.h>

#include "lab/page/report_data.h"

namespace meshlode::lab::page {

/// Reads the pictures that the data names, each once. Errors: kInvalid for a path that leads out of `folder`, and for
/// what is no PNG or larger than 64 MiB; kIo for what cannot be read.
[[nodiscard]] Status read_pictures(ReportData& data, const std::filesystem::path& folder);

}  // namespace meshlode::lab::page
