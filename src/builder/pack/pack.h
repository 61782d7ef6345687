// SPDX-License-Identifier: GPL-3.0-or-later
// Pack: the GPU-ready bytes of a page become its disk bytes, by a codec that is written (format/names.h). Equal bytes
// in, equal bytes out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

namespace meshlode::builder {

struct PackedPage {
  format::Codec codec = format::Codec::kNone;  ///< kNone where packing would not shrink the page
  std::vector<std::uint8_t> bytes;             ///< empty where `codec` is kNone: the page is stored as it is
};

/// Stores a page even where that makes it longer. \pre codec is not kNone. Errors: those of pack_page.
[[nodiscard]] Result<std::vector<std::uint8_t>> store_page(const format::MeshRecord& mesh,
                                                           std::span<const std::uint8_t> page, format::Codec codec);

/// `mesh` is the page's, `page` as encode makes it. Errors: kBuildFailed where the page is not in the
/// form that the format prescribes, or where the codec is one that is not written.
[[nodiscard]] Result<PackedPage> pack_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page,
                                           format::Codec codec);

}  // namespace meshlode::builder
