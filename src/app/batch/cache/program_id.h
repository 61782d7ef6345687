// SPDX-License-Identifier: GPL-3.0-or-later
// Which program this is: assets of another one are not its own.
#pragma once

#include <filesystem>

#include <meshlode/result.h>

#include "base/hash.h"

namespace meshlode::app {

/// A hash over the bytes of the executable and of every library that is loaded into the process now, by name. A build
/// number would not tell two builds of a changed source tree apart, nor see that METIS or zstd was replaced under a
/// program that stayed: both write bytes of assets. A copy of the program on a machine with the same libraries has the
/// same id. To be called before anything is built: TBB loads libraries of its own when it starts, and with them it is
/// another id. Errors: kIo one of the files cannot be read.
[[nodiscard]] Result<Hash128> find_program_id();

/// What starts this very program again: no path where the kernel has a name for it, since the path may be another
/// program's by then; in the relocatable folder (tools/package/folder.sh) its launcher. Errors: kIo the
/// folder has none.
[[nodiscard]] Result<std::filesystem::path> find_launcher();

}  // namespace meshlode::app
