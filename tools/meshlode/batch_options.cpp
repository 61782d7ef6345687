// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch_options.h"

#include <cstdlib>

#include "base/byte_size.h"

namespace meshlode::cli {

std::vector<std::string> BatchWords::outputs() const {
  std::vector<std::string> paths;
  for (const std::string* path : {&junit, &manifest, &depfile, &report}) {
    if (!path->empty()) paths.push_back(*path);
  }
  return paths;
}

std::string BatchWords::cache_folder() const {
  if (no_cache) return {};
  if (!cache.empty()) return cache;
  const char* from_environment = std::getenv("MESHLODE_CACHE");
  return from_environment != nullptr ? from_environment : "";
}

Result<std::uint64_t> BatchWords::limit() const {
  if (cache_limit == "none") return std::uint64_t{0};
  const auto bytes = parse_byte_size(cache_limit);
  if (!bytes || *bytes == 0) {
    return wrong_size("--cache-limit", cache_limit, "none or a size above 0, such as 20GiB or 20GB");
  }
  return *bytes;
}

void add_batch_options(OptionParser& parser, BatchWords& words) {
  parser.add_value("--report FILE", words.report,
                   "write counts and times as JSON, as --format json prints them (default: none)");
  parser.add_value("--manifest FILE", words.manifest,
                   "write status, hashes, time and size of each file as JSON (default: none)");
  parser.add_value("--junit FILE", words.junit, "write a JUnit file with one test case per scene (default: none)");
  parser.add_value("--depfile FILE", words.depfile,
                   "write the files that each asset depends on, for Make and Ninja (default: none)");
  parser.add_flag("--dry-run", words.dry_run, "print what would be built and why; write nothing");
  parser.group("Batches");
  parser.add_value("--cache FOLDER", words.cache,
                   "reuse earlier builds; runs and machines may share it (default: $MESHLODE_CACHE, else none)");
  parser.add_flag("--no-cache", words.no_cache, "use no cache, even if $MESHLODE_CACHE is set");
  parser.add_value("--cache-limit SIZE", words.cache_limit,
                   "remove the least recently used entries beyond SIZE, such as 20GiB");
  parser.add_value("--shard I/N", words.shard,
                   "build only share I of N shares of about equal cost, such as 3/8; 'meshlode merge' joins their "
                   "manifests (default: everything)");
  parser.add_value("--shard-costs MANIFEST", words.shard_costs,
                   "balance shares by the processor time that this manifest of an earlier run lists; the same for all "
                   "shards (default: by the size of the files)");
  parser.add_flag("--fail-fast", words.fail_fast, "stop after the first file that fails");
  parser.add_flag("--strict", words.strict,
                  "make errors of these warnings: a missing texture, an unknown name in --aggregate, nothing to draw, "
                  "missing triangles");
}

}  // namespace meshlode::cli
