// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts beside the full resolution, with heat maps of what differs. Every picture is in the page once. Without the
// script all stand side by side; with it one is laid over the full resolution, and a slider moves the border between
// them.
#pragma once

#include <cstddef>

#include "lab/page/markup.h"
#include "lab/page/report_data.h"

namespace meshlode::lab::page {

struct PictureCount {
  std::size_t shown = 0, left_out = 0;  ///< points' pictures
};

/// The stages of all views that have a picture of the full resolution. Pictures are taken in until `most_bytes`, those
/// of notable points first.
PictureCount write_pictures(Markup& html, const ReportData& data, std::size_t most_bytes);

}  // namespace meshlode::lab::page
