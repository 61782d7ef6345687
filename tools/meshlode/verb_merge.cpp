// SPDX-License-Identifier: GPL-3.0-or-later
// merge: the manifests that `build --shard` wrote become the one that a single batch would have written, if nothing is
// missing and nothing is there twice.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/batch/shard/merge.h"
#include "app/batch/shard/read_manifest.h"
#include "app/batch/tell/tell.h"
#include "kept_manifest.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

int run_merge(const Verb& verb, std::span<char* const> args) {
  std::vector<std::string> paths;
  std::string output;
  bool is_quiet = false;
  OptionParser parser(verb);
  parser.add_positionals("MANIFEST", paths, "the manifests of all shards, in any order");
  parser.group("Output");
  parser.add_value("-o,--output FILE", output, "manifest to write (required)");
  parser.add_flag("-q,--quiet", is_quiet, "print errors only");
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (output.empty()) return print_error({ErrorCode::kUsage, "-o", "name the manifest to write"});

  std::vector<app::ShardManifest> shards;
  for (const std::string& path : paths) {
    auto manifest = read_kept_manifest(path, "meshlode build --shard");
    if (!manifest) return print_error(manifest.error());
    shards.push_back({path, std::move(*manifest)});
  }
  const auto merged = app::merge_shards(std::move(shards));
  if (!merged) return print_error(merged.error());
  keep_results(merged->results);
  if (const Status there = app::check_assets(merged->results); !there) return print_error(there.error());
  if (const Status free = output_files().claim(output); !free) return print_error(free.error());
  if (const Status name = check_text_name("-o", output, {".json"}); !name) return print_error(name.error());
  const std::string text = app::manifest_json(merged->results, merged->program, merged->settings, merged->exit_code,
                                              nullptr, true, merged->versions);
  if (const Status written = write_text(output, text); !written) return print_error(written.error());
  for (const app::JobResult& r : merged->results) {
    if (r.exit_code != 0) print_error({static_cast<ErrorCode>(r.exit_code), "", r.error});
  }
  // As build says of such a batch.
  if (merged->results.empty()) return print_error({ErrorCode::kIo, "", "the shards are those of a batch of no files"});
  if (!is_quiet) std::fprintf(stderr, "%s\n", app::summary_line(merged->results).c_str());
  return merged->exit_code;
}

}  // namespace

const Verb kMergeVerb{
    "merge", "join the manifests of all shards of a batch into one",
    "Reads the manifests that 'build --shard I/N --manifest FILE' wrote, checks that they belong to one batch, that no "
    "shard and no asset is missing, and writes the manifest that one build of the whole batch would have written.",
    "meshlode build in/ -O out/ --shard 1/2 --manifest out/shard-1.json\n"
    "  meshlode build in/ -O out/ --shard 2/2 --manifest out/shard-2.json\n"
    "  meshlode merge out/shard-*.json -o out/manifest.json",
    run_merge};

}  // namespace meshlode::cli
