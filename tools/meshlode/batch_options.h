// SPDX-License-Identifier: GPL-3.0-or-later
// The options of `build` that are about many files: what is written beside the assets, and the cache.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "options.h"

namespace meshlode::cli {

struct BatchWords {
  bool fail_fast = false, dry_run = false, strict = false, no_cache = false;
  std::string junit, manifest, depfile, report;  ///< paths, empty for none
  std::string cache;                             ///< a folder; empty: $MESHLODE_CACHE, or none
  std::string cache_limit = "none";
  std::string shard;        ///< "3/8"; empty: the whole batch
  std::string shard_costs;  ///< a manifest; empty: by bytes

  /// Those of the four files that are written.
  [[nodiscard]] std::vector<std::string> outputs() const;
  /// The folder in use, empty for none.
  [[nodiscard]] std::string cache_folder() const;
  /// Bytes, 0 for none. Errors: kUsage for what is no size.
  [[nodiscard]] Result<std::uint64_t> limit() const;
};

void add_batch_options(OptionParser& parser, BatchWords& words);

}  // namespace meshlode::cli
