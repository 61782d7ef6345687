// SPDX-License-Identifier: MIT
// The content hash of an asset computed again from its decoded content (docs/reference/format.md, Content hash).
#pragma once

#include <functional>
#include <span>
#include "base/hash.h"

#include "run/read/asset.h"

namespace meshlode::run {

/// Instead of the asset's own bytes of a section; an empty span: there is no other.
using OtherBytes = std::function<std::span<const std::uint8_t>(const format::SectionEntry&)>;

/// What FileHeader::content_hash must be, of an asset with `other` bytes in its sections where they are given. Reads
/// every page and blob. Errors: those of load_page.
[[nodiscard]] Result<Hash128> hash_asset_content(const Asset& asset, const OtherBytes& other = {});

/// As the header says.
[[nodiscard]] Hash128 stated_hash(const Asset& asset);

/// An asset that does not say what its own hash is of has been changed since it was written: kInvalid.
[[nodiscard]] Status check_content_hash(const Asset& asset);

}  // namespace meshlode::run
