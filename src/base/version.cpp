// SPDX-License-Identifier: MIT
#include "base/version.h"

namespace meshlode {

const char* program_version() {
  return "meshlode " MESHLODE_VERSION_TEXT;
}

}  // namespace meshlode
