// SPDX-License-Identifier: GPL-3.0-or-later
// Repack: an asset with its pages stored by another codec, and everything else as it is. Nothing is built again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "base/hash.h"
#include "builder/pack/pack.h"

namespace meshlode::builder {

struct RepackSection {
  format::SectionEntry entry{};
  std::span<const std::uint8_t> bytes;  ///< decoded where the format knows the section, else as stored
};

/// An asset as its reader sees it. \pre everything that a reader checks on opening holds (docs/reference/format.md,
/// What a reader must refuse)
struct RepackInput {
  std::vector<RepackSection> sections;            ///< all of the file, in its order
  std::uint32_t version = format::kPlainVersion;  ///< as the asset says
  Hash128 content_hash{};                         ///< the same
  std::string meta_json;                          ///< kMeta of the result
  /// One page, decoded and checked; called from several threads at once.
  std::function<Result<std::vector<std::uint8_t>>(std::size_t page)> load_page;
  format::Codec codec = format::Codec::kNone;
  /// How a page is stored. Tests of codecs that are not written any more have another one.
  std::function<Result<PackedPage>(const format::MeshRecord&, std::span<const std::uint8_t>, format::Codec)> pack =
      pack_page;
};

/// The whole file: for an asset of this writer's the bytes that a build with that codec writes. Sections that are not
/// known stay as they are stored. Errors: those of load_page and pack_page.
[[nodiscard]] Result<std::vector<std::uint8_t>> repack_asset(const RepackInput& input);

}  // namespace meshlode::builder
