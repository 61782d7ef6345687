// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a report: whose it is, and that nothing in it leads to anybody else's files.
#pragma once

#include <filesystem>
#include <span>

#include <meshlode/result.h>

#include "base/file.h"

namespace meshlode::lab {

/// The state file of a report.
[[nodiscard]] std::filesystem::path state_file_of(const std::filesystem::path& report);

/// Makes the folder, with an empty state where there is none, and the folder of its pictures. Errors: kUsage where it
/// holds anything but an earlier sweep, where a file in it is one of `read` (whatever it is called: a link, a hard
/// link), or where its state or a folder in it is a link; kIo.
[[nodiscard]] Status make_report_folder(const std::filesystem::path& report, std::span<const FileId> read);

}  // namespace meshlode::lab
