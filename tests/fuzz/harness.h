// SPDX-License-Identifier: GPL-3.0-or-later
// What each harness defines: libFuzzer's entry point, called by libFuzzer's own main (clang, -DMESHLODE_FUZZ=ON) or by
// replay.cpp, which feeds it files. A harness accepts any bytes; a crash, a sanitizer's report, a failed `require` or a
// hang is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace meshlode::fuzz {

/// An assertion that every build type has.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "finding: %s\n", what);
  std::abort();
}

}  // namespace meshlode::fuzz
