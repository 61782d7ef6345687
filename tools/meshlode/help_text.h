// SPDX-License-Identifier: GPL-3.0-or-later
// `meshlode VERB --help`: examples first, then arguments and options in their groups.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "option_table.h"

namespace meshlode::cli {

/// The most columns of a line.
constexpr std::size_t kHelpWidth = 100;

/// Words filled into lines of at most `width` bytes, each begun by `indent` spaces but the first, which is begun by
/// `first`. A word that is longer has a line of its own; a short "(default: VALUE)" is one word. Ends with a line
/// break.
[[nodiscard]] std::string fill_lines(std::string_view text, const std::string& first, std::size_t indent,
                                     std::size_t width);

[[nodiscard]] std::string help_text(const VerbHelp& verb);
/// "meshlode build [OPTIONS] INPUT...".
[[nodiscard]] std::string usage_line(const VerbHelp& verb);
/// "0 ok, 1 usage, …".
[[nodiscard]] std::string exit_codes_line();
/// Of docs/, where the verb's options are.
[[nodiscard]] std::string reference_path(const std::string& verb);

/// The lines of an example, without the spaces that they begin with.
[[nodiscard]] std::vector<std::string> lines_of(std::string_view example);

/// What the program is, in a line and in a paragraph.
inline constexpr const char* kProgramSummary =
    "convert glTF scenes to streamable level-of-detail DAGs of meshlets, and prove them right";
inline constexpr const char* kProgramDescription =
    "meshlode converts glTF, PLY, OBJ and STL scenes to .lode assets, which an engine loads page by page and draws at "
    "the detail that the camera needs, without cracks. Other commands show, draw, export, compare and verify assets.";

/// The verb's page of the reference, in Markdown: docs/reference/cli/.
[[nodiscard]] std::string reference_page(const VerbHelp& verb);
/// Its first page, with a line for each verb.
[[nodiscard]] std::string reference_index(std::span<const VerbHelp> verbs);

}  // namespace meshlode::cli
