// SPDX-License-Identifier: GPL-3.0-or-later
#include "source_scene.h"
#include "base/try.h"

#include <algorithm>
#include <utility>

#include "app/report/read_meta.h"
#include "base/printable.h"
#include "file_kind.h"
#include "outputs.h"
#include "scene/import/import.h"

namespace meshlode::cli {

namespace {

/// What --repair did to the source is found again by repairing it in the same way.
bool was_repaired(const run::Asset& asset, const app::MetaInfo& meta) {
  const auto meshes = asset.meshes();
  return meta.repair ||
         std::any_of(meshes.begin(), meshes.end(), [](const format::MeshRecord& m) { return m.dropped_repaired > 0; });
}

}  // namespace

void add_source_options(OptionParser& parser, SourceOptions& options) {
  parser.add_value("--source SCENE", options.path, "scene that the asset was built from (required)");
  parser.add_flag("--repair", options.repair, "repair the source as 'build --repair' does, whatever the asset says");
  parser.add_flag("--linear-colors", options.linear_colors,
                  "read colours as 'build --linear-colors' does, whatever the asset says");
  parser.add_flag("--force", options.is_forced, "accept another scene than the one that the asset was built from");
  add_allow_outside_option(parser, options.allow_outside);
}

Status check_source_options(const std::string& verb, const std::string& asset_path, const SourceOptions& options) {
  if (options.path.empty()) return Error{ErrorCode::kUsage, "--source", "the scene it was built from is missing"};
  if (look_at_file(asset_path).form == FileForm::kScene && look_at_file(options.path).form == FileForm::kAsset) {
    return Error{ErrorCode::kUsage, "",
                 "the asset and its scene are swapped; give 'meshlode " + verb + " " + options.path + " --source " +
                     asset_path + "'"};
  }
  const auto allowed = parse_allow_outside(options.allow_outside);
  return allowed ? Status(Ok{}) : Status(allowed.error());
}

Result<scene::Scene> import_source(const run::Asset& asset, const SourceOptions& options, std::uint64_t max_decoded) {
  TRY_LET(allowed, parse_allow_outside(options.allow_outside));
  std::vector<FileId> files_read;
  const app::MetaInfo meta = app::read_meta(asset.meta_json());
  Result<scene::Scene> source =
      scene::import_scene(options.path, {.repair = options.repair || was_repaired(asset, meta),
                                         .scene = meta.scene,
                                         .files_read = &files_read,
                                         .max_decoded = max_decoded,
                                         .may_lack_images = true,
                                         .allow_outside = std::move(*allowed),
                                         .linear_colors = options.linear_colors || meta.linear_colors});
  output_files().keep(files_read);
  return source;
}

std::optional<std::string> describe_other_source(const run::Asset& asset, const scene::Scene& source,
                                                 const SourceOptions& options) {
  const app::MetaInfo meta = app::read_meta(asset.meta_json());
  if (options.is_forced || meta.source_hash.empty() || meta.source_hash == source.source_hash) return std::nullopt;
  const auto named = [](const std::string& name, const std::string& hash) {
    return printable(name) + " (" + printable(hash, 8) + ")";
  };
  // The hash is of all files that were read: the scene's own may be the very one.
  const char* const others = meta.source_file == source.source_name
                                 ? ", or a file that it names (a texture, a library) is missing or changed"
                                 : "";
  return "the asset was built from " + named(meta.source_file, meta.source_hash) + ", the source given is " +
         named(source.source_name, source.source_hash) + others;
}

}  // namespace meshlode::cli
