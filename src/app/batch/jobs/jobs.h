// SPDX-License-Identifier: GPL-3.0-or-later
// What a batch is made of: files, folders and patterns become pairs of an input and an output, in an order that is the
// same everywhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::app {

struct Job {
  std::filesystem::path input;
  std::filesystem::path output;
  std::filesystem::path root = {};  ///< the folder that was given, where the input was found below one
};

/// Which file becomes which, inputs in the order given, what lies below a folder or matches a pattern in byte order.
/// `output` names the one output of one input; without it an output lies in `output_folder`, or beside its input where
/// that is empty too. Below the folder the inner structure of a folder, or of a pattern behind its first wildcard, is
/// kept; `a.glb` and `a.ply` that would both become `a.lode` keep their extensions (`a.glb.lode`). A path that exists
/// is no pattern. Errors: kUsage where two inputs become one file or an option is missing; kIo.
[[nodiscard]] Result<std::vector<Job>> plan_jobs(const std::vector<std::string>& inputs, const std::string& output,
                                                 const std::string& output_folder);

}  // namespace meshlode::app
