// SPDX-License-Identifier: GPL-3.0-or-later
// `--max-memory`, for the verbs that have it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <meshlode/result.h>

#include "options.h"

namespace meshlode::cli {

struct MemoryLimit {
  std::uint64_t bytes = 0;  ///< 0: none was given
  Status spilling = Ok{};   ///< why large arrays cannot go to a file (spill.h)
};

/// From here on the process keeps it. `text`: "auto", or a size. `outputs`: where it writes; there, below $TMPDIR or in
/// /var/tmp the file is made. Error: kUsage for what is no size.
[[nodiscard]] Result<MemoryLimit> keep_memory_limit(const std::string& text, const std::filesystem::path& outputs);

/// `--max-memory` of the verbs that read an asset and write none.
void add_max_memory_option(OptionParser& parser, std::string& text);
/// Errors: kUsage; kIo where there is no file for large arrays.
[[nodiscard]] Status keep_memory_limit_of_check(const std::string& text);

}  // namespace meshlode::cli
