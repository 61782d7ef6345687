// SPDX-License-Identifier: GPL-3.0-or-later
// `-` on the command line: stdin as an input, stdout as an output.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include <meshlode/result.h>

#include "options.h"

namespace meshlode::cli {

constexpr const char* kStream = "-";

/// The path to open an input by. `-`: all of stdin, in a temporary file without a name that lives as long as the
/// process; errors call it "stdin". Errors: kIo; kUsage the second time.
[[nodiscard]] Result<std::string> input_path(const std::string& word);
/// `word` as reports name the input.
[[nodiscard]] std::string input_name(const std::string& word);

/// As output_files().claim() and write(), with `-` for stdout.
[[nodiscard]] Status claim_output(const std::string& path);
[[nodiscard]] Status write_output(const std::string& path, std::span<const std::uint8_t> bytes);
[[nodiscard]] Status write_output(const std::string& path, const std::string& text);

/// Says on stdout what was written, or on stderr where that went to stdout. False as print_out().
[[nodiscard]] bool print_beside(const std::string& output, const std::string& text);

/// `-o,--output FILE` of verbs that else print to stdout.
void add_report_option(OptionParser& parser, std::string& path);
/// Before any work, of a file that is no stream. Errors: as check_text_name() and OutputFiles::claim().
[[nodiscard]] Status claim_report(const std::string& path, std::initializer_list<std::string_view> formats);

}  // namespace meshlode::cli
