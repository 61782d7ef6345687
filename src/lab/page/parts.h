// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the page of a sweep that several of its sections have.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lab/page/charts.h"
#include "lab/page/markup.h"

namespace meshlode::lab::page {

void write_paragraph(Markup& html, std::string_view text);

/// A command to be copied, with what it is for.
void write_command(Markup& html, std::string_view what, const std::string& command);

/// A plot with how to read it, its command and its numbers.
void write_chart(Markup& html, const Chart& chart, const std::string& command);

void write_numbers(Markup& html, const Table& table);

/// "a, b, c".
[[nodiscard]] std::string joined(const std::vector<std::string>& texts);

}  // namespace meshlode::lab::page
