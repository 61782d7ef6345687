// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory_limit.h"

#include <cstdlib>
#include <vector>

#include "base/byte_size.h"
#include "spill.h"

namespace meshlode::cli {

Result<MemoryLimit> keep_memory_limit(const std::string& text, const std::filesystem::path& outputs) {
  MemoryLimit limit;
  if (text == "auto") return limit;
  const auto bytes = parse_byte_size(text);
  if (!bytes || *bytes == 0) {
    return wrong_size("--max-memory", text, "auto or a size above 0, such as 8GiB or 8GB");
  }
  std::vector<std::filesystem::path> folders;
  const char* const asked = std::getenv("TMPDIR");
  if (asked != nullptr && *asked != '\0') folders.emplace_back(asked);
  folders.push_back(outputs);  // which has room for an asset
  folders.emplace_back("/var/tmp");
  limit.bytes = *bytes;
  limit.spilling = start_spilling(*bytes, folders);
  return limit;
}

void add_max_memory_option(OptionParser& parser, std::string& text) {
  parser.add_value("--max-memory", text,
                   "what this may take, such as 8GiB: large arrays in a temporary file to keep it; auto: no limit");
}

Status keep_memory_limit_of_check(const std::string& text) {
  const auto limit = keep_memory_limit(text, {});
  if (!limit) return limit.error();
  return limit->spilling;
}

}  // namespace meshlode::cli
