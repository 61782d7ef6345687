// SPDX-License-Identifier: GPL-3.0-or-later
// What the sweeps found, as Markdown: docs/reference/hard-cases.md. No times and nothing of the machine: the same tree
// gives the same text.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "run/sweep.h"

namespace meshlode::test::hard {

[[nodiscard]] const char* name_of(Verdict verdict);
[[nodiscard]] std::string table_of(std::span<const Swept> swept);

/// One line for a terminal.
[[nodiscard]] std::string line_of(const Swept& swept);

/// Whether a stretch of the sweep or a law failed.
[[nodiscard]] bool has_failed(const Swept& swept);

/// What the page (the text of docs/reference/hard-cases.md) says otherwise of a case: how many laws were asked and how
/// many hold, and, where `is_whole`, up to which parameter the case holds. A case that is refused, or a law that finds
/// nothing to ask, fails nothing: that it did not use to be so is seen here. Empty: it is as the page says.
[[nodiscard]] std::string difference_from_page(const Swept& swept, std::string_view page, bool is_whole);

}  // namespace meshlode::test::hard
