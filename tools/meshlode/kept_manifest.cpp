// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_manifest.h"

#include "base/try.h"
#include "file_kind.h"
#include "outputs.h"

namespace meshlode::cli {

Result<app::Manifest> read_kept_manifest(const std::string& path, const std::string& writer) {
  keep_file(path);
  TRY(check_is_manifest(path, writer));
  return app::read_manifest(path);
}

void keep_results(std::span<const app::JobResult> results) {
  for (const app::JobResult& r : results) {
    keep_file(r.job.input);
    keep_file(r.job.output);
    for (const app::Dependency& file : r.files) keep_file(file.path);
  }
}

}  // namespace meshlode::cli
