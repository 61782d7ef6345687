// SPDX-License-Identifier: GPL-3.0-or-later
// What the page shows of a sweep, without the pictures (page::read_pictures).
#pragma once

#include "lab/page/report_data.h"
#include "lab/sweep/sweep.h"

namespace meshlode::lab {

[[nodiscard]] page::ReportData page_data(const SweepOptions& options, const SweepResult& result);

}  // namespace meshlode::lab
