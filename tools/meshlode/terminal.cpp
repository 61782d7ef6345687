// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal.h"

#include <cstdlib>
#include <string>

#include <unistd.h>

namespace meshlode::cli {

bool is_unicode_terminal() {
  if (::isatty(STDOUT_FILENO) != 1) return false;
  // Asked of the environment: setlocale() would change how numbers are printed.
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    std::string letters;  // of "en_GB.UTF-8@euro", without the rest
    for (const char c : std::string(value)) {
      if (c == '-' || c == '_') continue;
      letters += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return letters.find(".utf8") != std::string::npos;
  }
  return false;
}

}  // namespace meshlode::cli
