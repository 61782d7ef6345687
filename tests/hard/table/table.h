// SPDX-License-Identifier: GPL-3.0-or-later
// What the sweeps found, as Markdown: docs/hard-cases.md. No times and nothing of the machine: the same tree gives the
// same text.
#pragma once

#include <span>
#include <string>

#include "run/sweep.h"

namespace meshlode::test::hard {

[[nodiscard]] const char* name_of(Verdict verdict);
[[nodiscard]] std::string table_of(std::span<const Swept> swept);

/// One line for a terminal.
[[nodiscard]] std::string line_of(const Swept& swept);

/// Whether a stretch of the sweep or a law failed.
[[nodiscard]] bool has_failed(const Swept& swept);

}  // namespace meshlode::test::hard
