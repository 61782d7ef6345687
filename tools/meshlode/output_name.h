// SPDX-License-Identifier: GPL-3.0-or-later
// A file has the format that its name says, or is not written.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <meshlode/result.h>

namespace meshlode::cli {

/// Error: kUsage where the path's extension is that of another format than is written: of a picture `x.jpg`, which
/// would be a PNG. An extension that names no format, or none, is free, and so is an empty path. `formats`: the
/// extensions of what is written, the usual one first; none for text of no format.
[[nodiscard]] Status check_output_name(const char* option, const std::string& path,
                                       std::initializer_list<std::string_view> formats);

}  // namespace meshlode::cli
