// SPDX-License-Identifier: GPL-3.0-or-later
// Valid files of every kind that import reads, to be broken.
#pragma once

#include <string>
#include <vector>

namespace meshlode::testing {

struct SeedFile {
  std::string name;  ///< with the extension that import goes by
  std::string bytes;
};

/// Written here, plus small real models where MESHLODE_MODELS is set.
[[nodiscard]] std::vector<SeedFile> make_seed_files();

}  // namespace meshlode::testing
