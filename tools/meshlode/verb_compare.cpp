// SPDX-License-Identifier: GPL-3.0-or-later
// compare: two assets side by side, and whether what changed is within limits.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/compare/compare.h"
#include "base/append_format.h"
#include "base/output_files.h"
#include "base/printable.h"
#include "base/try.h"
#include "budget_options.h"
#include "bulk.h"
#include "compare_folder.h"
#include "compare_pairs.h"
#include "draw_views.h"
#include "golden.h"
#include "options.h"
#include "outputs.h"
#include "run/read/asset.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct CompareOptions {
  std::vector<std::string> files;
  std::optional<std::string> fail_if;
  bool is_rendered = false;
  GoldenOptions golden;
  std::string folder;  ///< of pictures and page
  ViewOptions views;
  std::string max_decoded = kDefaultMaxDecodedText;
  OutputOptions output;
};

bool is_camera_given(const ViewOptions& views) {
  const CameraOptions usual;
  const CameraOptions& camera = views.common;
  return !views.cameras.empty() || camera.ortho_height || camera.size != usual.size ||
         camera.pixel_error != usual.pixel_error;
}

/// The errors of drawing are those of an asset's pages; which of the two is said by neither.
Error in_picture(Error error) {
  if (error.code == ErrorCode::kInvalid) error.where = "--render" + (error.where.empty() ? "" : ": " + error.where);
  return error;
}

struct CompareCommand {
  CompareOptions options;
  std::vector<app::Condition> budget;
};

/// The row of several pairs.
std::vector<std::string> row_of(std::size_t before, std::size_t after) {
  std::string change;
  append_format(change, "%+.1f%%",
                100.0 * (static_cast<double>(after) - static_cast<double>(before)) /
                    static_cast<double>(std::max<std::size_t>(1, before)));
  return {grouped_digits(before), grouped_digits(after), std::move(change)};
}

/// Both under the same cameras: the options' or, where they name none, the one that frames the old asset.
Status draw_both(const run::Asset& before, const run::Asset& after, const BulkInput& input,
                 const CompareOptions& options, CompareFolder& folder, std::vector<std::string>& warnings,
                 std::vector<app::PictureChange>& pictures) {
  TRY_LET(cameras, make_cameras(options.views, before));
  TRY_LET(old_views, draw_views(before, *cameras, options.views, warnings));
  TRY_LET(new_views, draw_views(after, *cameras, options.views, warnings));
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    const DrawnView& a = (*old_views)[i];
    const DrawnView& b = (*new_views)[i];
    ComparedPicture picture = compare_images(a.image, b.image);
    picture.change.camera = static_cast<std::uint32_t>(i + 1);
    picture.change.pixel_error = options.views.common.pixel_error;
    picture.change.changes = {{"clusters", static_cast<double>(a.clusters), static_cast<double>(b.clusters)},
                              {"triangles", static_cast<double>(a.triangles), static_cast<double>(b.triangles)}};
    TRY(folder.write(input.place, a.image, b.image, picture));
    pictures.push_back(std::move(picture.change));
  }
  return Ok{};
}

/// `input.source`: the older asset.
FileOutcome compare_pair(const BulkInput& input, const CompareCommand& command, CompareFolder& folder) {
  const CompareOptions& options = command.options;
  FileOutcome out;
  app::ComparedFile page;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    folder.add(input, out, std::move(page));
    return std::move(out);
  };
  const Result<run::Asset> before = open_sound(input.source, options.views.max_decoded, input.source_hash);
  if (!before) return fail(before.error());
  const Result<run::Asset> after = open_sound(input.path, options.views.max_decoded, input.asset_hash);
  if (!after) return fail(after.error());
  app::AssetComparison comparison = app::compare_assets(*before, *after);
  comparison.before.file = input.source;
  comparison.after.file = input.path;
  page.before = before->bytes().size();
  page.after = after->bytes().size();
  if (options.is_rendered) {
    std::vector<std::string> warnings;
    const Status drawn = draw_both(*before, *after, input, options, folder, warnings, comparison.pictures);
    for (const std::string& warning : warnings) out.notes += "warning: " + warning + "\n";
    if (!drawn) return fail(in_picture(drawn.error()));
  }
  std::vector<app::BrokenCondition> broken;
  if (!command.budget.empty()) {
    auto judged = app::judge_budget(command.budget, app::comparison_json(comparison));
    if (!judged) return fail(judged.error());
    broken = std::move(*judged);
  }
  page.text = app::comparison_text(comparison);
  page.pictures = comparison.pictures;
  page.verdict = std::ranges::equal(before->bytes(), after->bytes()) ? "equal" : "changed";
  if (options.output.json()) {
    out.text = app::comparison_json(comparison, broken);
  } else if (!options.output.quiet || command.budget.empty()) {  // with a budget it is the verdict that is asked for
    out.text = page.text;
  }
  const bool is_of_errors = std::ranges::any_of(broken, [](const app::BrokenCondition& one) {
    return one.condition.find("error_min") != std::string::npos || one.condition.find("error_max") != std::string::npos;
  });
  if (const std::string tiers = app::tiers_text(comparison); is_of_errors && !tiers.empty()) {
    out.notes += "warning: errors are " + tiers + "\n";
  }
  out.cells = row_of(before->bytes().size(), after->bytes().size());
  if (const auto flip = app::worst_flip(comparison.pictures)) {
    append_format(out.cells.emplace_back(), "%.4f", flip->mean);
  }
  for (const app::BrokenCondition& one : broken) {
    out.late_errors.push_back({ErrorCode::kCheckFailed, input.path, one.message()});
  }
  if (!broken.empty()) out.exit_code = static_cast<int>(ErrorCode::kCheckFailed);
  folder.add(input, out, std::move(page));
  return out;
}

/// A pair, or an asset that has no other: new ones are told of, and are sound; lost ones fail where there are limits.
FileOutcome compare_or_tell(const BulkInput& input, const CompareCommand& command, CompareFolder& folder) {
  if (!input.path.empty() && !input.source.empty()) return compare_pair(input, command, folder);
  FileOutcome out;
  app::ComparedFile page;
  const std::string& path = input.path.empty() ? input.source : input.path;
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  const std::string bytes = error ? "-" : grouped_digits(size);
  if (!input.path.empty()) {
    out.cells = {"-", bytes, "new"};
    if (!error) page.after = size;
    page.verdict = "new";
    const auto asset = open_sound(path, command.options.views.max_decoded, input.asset_hash);
    if (!asset) out.fail(asset.error());
  } else {
    out.cells = {bytes, "-", "gone"};
    if (!error) page.before = size;
    page.verdict = "gone";
    if (!command.budget.empty()) out.fail({ErrorCode::kCheckFailed, path, "has no newer asset"});
  }
  folder.add(input, out, std::move(page));
  return out;
}

/// Files of a manifest that no asset was made of are told of by run_bulk() alone.
void add_failures(const std::vector<BulkInput>& files, CompareFolder& folder) {
  for (const BulkInput& input : files) {
    if (input.error.empty()) continue;
    FileOutcome out;
    out.fail({static_cast<ErrorCode>(input.exit_code), "", input.error});
    folder.add(input, out, {});
  }
}

int run_golden(const Verb& verb, const CompareOptions& options, BulkWords& bulk) {
  GoldenCommand command{options.golden, {}, options.views, options.output};
  auto budget = read_budget_option(options.fail_if.value_or(kGoldenBudget), app::golden_schema());
  if (!budget) return print_error(budget.error());
  command.budget = std::move(*budget);
  bulk.files = options.files;
  auto inputs = find_bulk_inputs(verb, bulk, app::InputKind::kAssets, ManifestSide::kAssets);
  if (!inputs) return print_error(inputs.error());
  if (const Status named = name_places(inputs->files); !named) return print_error(named.error());
  CompareFolder folder(options.folder);
  add_failures(inputs->files, folder);
  int exit_code = 0;
  if (inputs->is_single) {
    const JobLimit limit(bulk.jobs);
    exit_code = compare_with_golden(inputs->files.front(), command, folder).print();
  } else {
    if (inputs->is_whole) {
      if (const Status added = add_orphans(command, inputs->files); !added) return print_error(added.error());
    }
    exit_code = run_bulk({"compare",
                          {{"FLIP", 6}, {"picture", 7}},
                          [&](const BulkInput& input) { return compare_with_golden(input, command, folder); }},
                         inputs->files, bulk, options.output);
  }
  return std::max(exit_code, folder.finish(options.golden.folder));
}

/// Whether `inner` is `outer` or below it, existing or not.
bool is_within(const std::filesystem::path& inner, const std::filesystem::path& outer) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(std::filesystem::absolute(inner, error), error);
  while (!is_same_place(folder, outer)) {
    if (!folder.has_relative_path()) return false;
    folder = folder.parent_path();
  }
  return true;
}

Status check_options(const CompareOptions& options) {
  const auto usage = [](const char* option, const char* detail) { return Error{ErrorCode::kUsage, option, detail}; };
  const bool is_golden = !options.golden.folder.empty();
  if (options.golden.is_updated && !is_golden) return usage("--update", "needs --golden");
  if (options.golden.is_updated && (options.fail_if || !options.folder.empty())) {
    return usage("--update", "compares nothing: give neither --fail-if nor -O");
  }
  if (is_golden) {
    // What is written there would be taken for golden pictures.
    const bool is_inside = !options.folder.empty() && is_within(options.folder, options.golden.folder);
    return is_inside ? usage("-O", "is the folder of --golden or below it; name another") : Status(Ok{});
  }
  if (!options.is_rendered && is_camera_given(options.views)) {
    return usage("", "--camera, --ortho, --size and --pixel-error need --render");
  }
  if (options.files.size() == 2) return Ok{};
  return usage("", options.files.size() < 2 ? "OLD and NEW are required; see meshlode compare --help"
                                            : "takes two (OLD and NEW), but with --golden any number");
}

bool is_manifest_name(const std::string& path) {
  return std::filesystem::path(path).extension() == ".json";
}

int run_compare(const Verb& verb, std::span<char* const> args) {
  CompareCommand command;
  CompareOptions& options = command.options;
  BulkWords bulk;
  OptionParser parser(verb);
  parser.add_positionals("FILE", options.files,
                         "OLD and NEW: two .lode assets, folders of them, or manifests (NAME.json); with --golden "
                         "assets, folders or patterns",
                         false);
  parser.group("Output");
  parser.add_value("-O FOLDER", options.folder,
                   "write PNG files of what differs (old, new, FLIP) and a page, index.html (default: none)");
  add_output_options(parser, options.output);
  add_budget_option(parser, options.fail_if, "--format json", "file_bytes.ratio>1.02, any(meshes).levels.change!=0");
  add_bulk_outputs(parser, bulk);
  parser.group("Pictures");
  parser.add_flag("--render", options.is_rendered, "draw both with the same cameras and compare the pictures");
  add_view_options(parser, options.views);
  parser.add_value("--golden FOLDER", options.golden.folder,
                   "compare with the pictures in this folder; without --fail-if each pixel must be equal (default: "
                   "none)");
  parser.add_flag("--update", options.golden.is_updated, "write the pictures of --golden instead");
  parser.add_value("--manifest FILE", bulk.manifest, "with --golden: the assets of this manifest (default: none)");
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, options.max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const Result<std::uint64_t> max_decoded = parse_max_decoded(options.max_decoded);
  if (!max_decoded) return print_error(max_decoded.error());
  options.views.max_decoded = *max_decoded;
  if (const Status checked = check_options(options); !checked) return print_error(checked.error());
  if (!options.golden.folder.empty()) return run_golden(verb, options, bulk);
  if (!bulk.manifest.empty()) {
    return print_error({ErrorCode::kUsage, "--manifest", "needs --golden; name two manifests as OLD and NEW"});
  }
  auto budget = read_budget_option(options.fail_if, app::compare_schema());
  if (!budget) return print_error(budget.error());
  command.budget = std::move(*budget);
  for (const char* key : {"picture", "pictures", "flip"}) {
    if (app::mentions(command.budget, key) && !options.is_rendered) {
      return print_error({ErrorCode::kUsage, "--fail-if", std::string(key) + " needs --render"});
    }
  }
  const std::string &before = options.files[0], &after = options.files[1];
  std::error_code error;
  const bool are_folders = std::filesystem::is_directory(before, error) && std::filesystem::is_directory(after, error);
  const bool are_manifests = is_manifest_name(before) && is_manifest_name(after);
  CompareFolder folder(options.folder);
  if (!are_folders && !are_manifests) {
    if (!bulk.junit.empty()) return print_error({ErrorCode::kUsage, "--junit", "is for two folders or manifests"});
    std::vector<BulkInput> pair{{after, before}};
    if (const Status named = name_places(pair); !named) return print_error(named.error());
    for (const std::string& path : {before, after}) {
      keep_file(path);
    }
    const JobLimit limit(bulk.jobs);
    const int exit_code = compare_pair(pair.front(), command, folder).print();
    return std::max(exit_code, folder.finish(pair.front().place));
  }
  auto pairs = are_folders ? pair_folders(before, after) : pair_manifests(before, after);
  if (!pairs) return print_error(pairs.error());
  std::vector<BulkInput>& files = *pairs;
  if (const Status named = name_places(files); !named) return print_error(named.error());
  for (const BulkInput& input : files) {
    for (const std::string& path : {input.path, input.source}) {
      keep_file(path);
    }
  }
  add_failures(files, folder);
  std::vector<BulkColumn> columns{{"old bytes", 13}, {"new bytes", 13}, {"change", 8}};
  if (options.is_rendered) columns.push_back({"FLIP", 6});
  const int exit_code =
      run_bulk({"compare", columns, [&](const BulkInput& input) { return compare_or_tell(input, command, folder); }},
               files, bulk, options.output);
  return std::max(exit_code, folder.finish(before + " and " + after));
}

}  // namespace

const Verb kCompareVerb{
    "compare", "show what changed between two assets and check it against limits",
    "Compares sizes, settings, meshes, levels, materials and images of two assets, usually two builds of one scene. "
    "With --render both are drawn with the same cameras and the pictures are compared, by PSNR and by FLIP. -O writes "
    "the pictures that differ, and a page.\n\n"
    "With --fail-if the changes become limits that a pipeline can check.\n\n"
    "Two folders are compared asset by asset, by their places below them, two manifests by their scenes, with a row "
    "each. An asset that only the older one has fails where there are limits.\n\n"
    "With --golden assets are compared with pictures that --update wrote before. Where whole folders or the manifest "
    "of "
    "a whole batch are given, a picture PLACE.N.png that none of their assets has fails.",
    "meshlode compare old.lode new.lode\n"
    "  meshlode compare old.lode new.lode --fail-if 'file_bytes.ratio>1.02'\n"
    "  meshlode compare released/ out/ --render -O changes --fail-if 'flip.mean>0.02' --junit compare.xml\n"
    "  meshlode compare last.json now.json\n"
    "  meshlode compare --golden golden/ out/ --update\n"
    "  meshlode compare --golden golden/ out/ --fail-if 'flip.mean>0.02' -O changes",
    run_compare};

}  // namespace meshlode::cli
