// SPDX-License-Identifier: GPL-3.0-or-later
// A file has the format that its name says, or is not written.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <meshlode/result.h>

namespace meshlode::cli {

/// Of assets, models and pictures. Error: kUsage where the path's extension is not `format` (".png") but that of
/// another format, known or not. No extension is free, so is one of a file on its way (`x.tmp`, `x.part`), a number
/// (`x.2`), and an empty path.
[[nodiscard]] Status check_output_name(const char* option, const std::string& path, std::string_view format);

/// Of text. Error: kUsage where the path's extension is one of a known format that is not written; others are free.
/// `formats`: the extensions of what is written, the usual one first; none for text of no format.
[[nodiscard]] Status check_text_name(const char* option, const std::string& path,
                                     std::initializer_list<std::string_view> formats);

}  // namespace meshlode::cli
