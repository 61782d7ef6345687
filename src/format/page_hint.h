// SPDX-License-Identifier: MIT
// What a page's groups say of it together, for whoever loads pages by their worth.
#pragma once

#include <span>

#include <meshlode/format.h>

namespace meshlode::format {

/// \pre groups of one page: at least one, with spheres and errors that are finite and not negative
[[nodiscard]] PageHintRecord make_page_hint(std::span<const GroupRecord> groups);

}  // namespace meshlode::format
