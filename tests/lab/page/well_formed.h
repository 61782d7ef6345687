// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace meshlode::lab::page {

/// What keeps a text from being well-formed XML whose ids are unique, or nothing. It knows elements, attributes in
/// double quotes, references and one DOCTYPE; comments, CDATA and processing instructions it takes for faults, as we
/// write none.
[[nodiscard]] std::string find_fault(std::string_view text);

}  // namespace meshlode::lab::page
