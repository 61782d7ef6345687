// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch_options.h"

#include <cstdlib>

#include "base/byte_size.h"

namespace meshlode::cli {

std::vector<std::string> BatchWords::outputs() const {
  std::vector<std::string> paths;
  for (const std::string* path : {&junit, &manifest, &depfile}) {
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
  parser.add_flag("--fail-fast", words.fail_fast, "skip what comes after the first file that fails");
  parser.add_flag(
      "--strict", words.strict,
      "errors: a missing texture, which else is left out, and a name of --aggregate that nothing has, nothing to draw, "
      "triangles missing, which else are warnings");
  parser.add_value("--junit", words.junit, "write a JUnit XML file, a test case a scene");
  parser.add_value("--manifest", words.manifest, "write statuses, hashes, seconds and bytes of all files as JSON");
  parser.add_value("--depfile", words.depfile, "write what each asset depends on, for Make and Ninja");
  parser.add_value("--cache", words.cache,
                   "folder of what was built before, shared by runs and machines; "
                   "$MESHLODE_CACHE where not given");
  parser.add_value("--cache-limit", words.cache_limit, "what the cache keeps at most, such as 20GiB; or none");
  parser.add_flag("--no-cache", words.no_cache, "use no cache, whatever $MESHLODE_CACHE says");
  parser.add_value(
      "--shard", words.shard,
      "I/N, such as 3/8: only the I-th of N shares of about equal cost; merge makes one manifest of theirs");
  parser.add_flag("--dry-run", words.dry_run, "write nothing; say what would be built, and why");
}

}  // namespace meshlode::cli
