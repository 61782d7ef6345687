// SPDX-License-Identifier: MIT
// Text by printf's rules, at the end of a string.
#pragma once

#include <array>
#include <cstdarg>
#include <cstdio>
#include <string>

namespace meshlode {

/// At most 511 characters a call; more are cut off.
__attribute__((format(printf, 2, 3))) inline void append_format(std::string& out, const char* format, ...) {
  std::array<char, 512> line{};
  va_list args;
  va_start(args, format);
  std::vsnprintf(line.data(), line.size(), format, args);
  va_end(args);
  out += line.data();
}

}  // namespace meshlode
