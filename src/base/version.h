// SPDX-License-Identifier: MIT
#pragma once

namespace meshlode {

/// Name and version, as `meshlode --version` prints them; the version comes from project() in CMakeLists.txt.
[[nodiscard]] const char* program_version();

}  // namespace meshlode
