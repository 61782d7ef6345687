// SPDX-License-Identifier: GPL-3.0-or-later
// What the program's exit codes mean, for help and man pages.
#pragma once

#include <array>

#include <meshlode/result.h>

namespace meshlode::cli {

struct ExitCodeInfo {
  int code;
  const char* meaning;
};

inline constexpr std::array<ExitCodeInfo, 7> kExitCodes{{
    {0, "ok"},
    {static_cast<int>(ErrorCode::kUsage), "usage"},
    {static_cast<int>(ErrorCode::kIo), "input or output failed (an interrupt too)"},
    {static_cast<int>(ErrorCode::kInvalid), "invalid input"},
    {static_cast<int>(ErrorCode::kBuildFailed), "build failed"},
    {static_cast<int>(ErrorCode::kUnsupported), "unsupported"},
    {static_cast<int>(ErrorCode::kCheckFailed), "a check failed"},
}};

}  // namespace meshlode::cli
