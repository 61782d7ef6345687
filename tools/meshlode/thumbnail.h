// SPDX-License-Identifier: GPL-3.0-or-later
// What the page of a batch shows of an asset beside its numbers: a small picture, and what a usual view draws of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "run/read/asset.h"

namespace meshlode::cli {

/// Triangles of the cut that `render` draws by its defaults: one pixel of error in a picture of 1280x720 that frames
/// the scene. Nothing where the cut has more clusters than `render` draws.
[[nodiscard]] std::optional<std::uint64_t> count_pixel_triangles(const run::Asset& asset);

struct Thumbnail {
  std::vector<std::uint8_t> webp;  ///< of kThumbnailWidth by kThumbnailHeight, transparent where nothing is drawn
  std::string note;                ///< which image is not shown, and why; empty: none
};

/// Pixels. With 96x72 a page of 1,000 assets takes 2 MB more; a row of its table shows half as many a side.
constexpr std::uint32_t kThumbnailWidth = 96, kThumbnailHeight = 72;

/// Of decoded images with their smaller levels, for each picture that is drawn: four base colours of 2048 x 2048, which
/// FlightHelmet has, take 90 MiB. What has no room is named in the note.
constexpr std::uint64_t kThumbnailImageBytes = std::uint64_t{256} << 20U;

/// The same view with base colours and light. The same bytes for the same asset. Errors: kInvalid for a broken page or
/// image; kUnsupported for a cut that is too large.
[[nodiscard]] Result<Thumbnail> draw_thumbnail(const run::Asset& asset);

}  // namespace meshlode::cli
