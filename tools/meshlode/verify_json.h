// SPDX-License-Identifier: GPL-3.0-or-later
// What verify prints with --format json: docs/schemas/verify.schema.json.
#pragma once

#include <string>

#include "judge/verify/verify.h"

namespace meshlode::cli {

[[nodiscard]] std::string verify_json(const std::string& path, const std::string& source,
                                      const judge::VerifyOptions& options, const judge::VerifyReport& report);

}  // namespace meshlode::cli
