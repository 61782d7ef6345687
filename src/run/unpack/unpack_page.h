// SPDX-License-Identifier: MIT
// The stored bytes of a page whose codec is not none become the page.
#pragma once

#include <cstdint>
#include <span>

#include <meshlode/format.h>

#include "run/unpack/decompressors.h"

namespace meshlode::run {

/// Fills `page`, which must be zero and is kMaxPageBytes at most. kBroken where the bytes do not say a page of this
/// size; whether it is the right one is for the checksum to say. Never reads or writes outside the spans; memory is
/// bounded by a small multiple of cluster_count and of the spans' sizes.
[[nodiscard]] UnpackOutcome unpack_page(const format::MeshRecord& mesh, const format::PageRecord& record,
                                        std::span<const std::uint8_t> stored, std::span<std::uint32_t> page);

}  // namespace meshlode::run
