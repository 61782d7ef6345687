// SPDX-License-Identifier: GPL-3.0-or-later
// compare: two assets side by side, and whether what changed is within limits.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/compare/compare.h"
#include "app/compare/stored_bytes.h"
#include "base/append_format.h"
#include "base/printable.h"
#include "base/try.h"
#include "budget_options.h"
#include "bulk.h"
#include "camera_options.h"
#include "draw_pair.h"
#include "file_kind.h"
#include "options.h"
#include "run/read/asset.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct CompareOptions {
  std::string before, after;
  std::optional<std::string> fail_if;
  bool is_rendered = false;
  CameraOptions camera;
  std::string max_decoded = kDefaultMaxDecodedText;
  OutputOptions output;
};

bool is_camera_given(const CameraOptions& camera) {
  const CameraOptions usual;
  return camera.camera || camera.ortho_height || camera.size != usual.size || camera.pixel_error != usual.pixel_error;
}

/// The errors of drawing are those of an asset's pages; which of the two is said by neither.
Error in_picture(Error error) {
  if (error.code == ErrorCode::kInvalid) error.where = "--render" + (error.where.empty() ? "" : ": " + error.where);
  return error;
}

/// Errors: those of opening; kInvalid for damaged pages and images, which opening does not look at.
Result<run::Asset> open_sound(const std::string& path, std::uint64_t max_decoded) {
  Result<run::Asset> asset = open_asset(path, max_decoded);
  if (!asset) return asset;
  if (const Status sound = app::check_stored_bytes(*asset); !sound) {
    Error error = sound.error();
    error.where = path + ": " + error.where;
    return error;
  }
  return asset;
}

struct CompareCommand {
  CompareOptions options;
  std::vector<app::Condition> budget;
  std::uint64_t max_decoded = 0;
};

/// The row of several pairs.
std::vector<std::string> row_of(std::size_t before, std::size_t after) {
  std::string change;
  append_format(change, "%+.1f%%",
                100.0 * (static_cast<double>(after) - static_cast<double>(before)) /
                    static_cast<double>(std::max<std::size_t>(1, before)));
  return {grouped_digits(before), grouped_digits(after), std::move(change)};
}

/// `input.source`: the older asset.
FileOutcome compare_pair(const BulkInput& input, const CompareCommand& command) {
  const CompareOptions& options = command.options;
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const Result<run::Asset> before = open_sound(input.source, command.max_decoded);
  if (!before) return fail(before.error());
  const Result<run::Asset> after = open_sound(input.path, command.max_decoded);
  if (!after) return fail(after.error());
  app::AssetComparison comparison = app::compare_assets(*before, *after);
  comparison.before.file = input.source;
  comparison.after.file = input.path;
  if (options.is_rendered) {
    std::vector<std::string> warnings;
    auto picture = draw_pair({*before, *after, command.max_decoded}, options.camera, warnings);
    for (const std::string& warning : warnings) out.notes += "warning: " + warning + "\n";
    if (!picture) return fail(in_picture(picture.error()));
    comparison.picture = std::move(*picture);
  }
  std::vector<app::BrokenCondition> broken;
  if (!command.budget.empty()) {
    auto judged = app::judge_budget(command.budget, app::comparison_json(comparison));
    if (!judged) return fail(judged.error());
    broken = std::move(*judged);
  }
  if (options.output.json()) {
    out.text = app::comparison_json(comparison, broken);
  } else if (!options.output.quiet || command.budget.empty()) {  // with a budget it is the verdict that is asked for
    out.text = app::comparison_text(comparison);
  }
  const bool is_of_errors = std::ranges::any_of(broken, [](const app::BrokenCondition& one) {
    return one.condition.find("error_min") != std::string::npos || one.condition.find("error_max") != std::string::npos;
  });
  if (const std::string tiers = app::tiers_text(comparison); is_of_errors && !tiers.empty()) {
    out.notes += "warning: errors are " + tiers + "\n";
  }
  out.cells = row_of(before->bytes().size(), after->bytes().size());
  for (const app::BrokenCondition& one : broken) {
    out.late_errors.push_back({ErrorCode::kCheckFailed, input.path, one.message()});
  }
  if (!broken.empty()) out.exit_code = static_cast<int>(ErrorCode::kCheckFailed);
  return out;
}

/// Assets below two folders, by their places below them: those of the newer one first, then what it has no more.
Result<std::vector<BulkInput>> pair_folders(const std::string& before, const std::string& after) {
  namespace fs = std::filesystem;
  TRY_LET(old_files, app::find_inputs(before, app::InputKind::kAssets));
  TRY_LET(new_files, app::find_inputs(after, app::InputKind::kAssets));
  std::set<fs::path> left;
  for (const fs::path& file : old_files->files) left.insert(file.lexically_relative(before));
  std::vector<BulkInput> pairs;
  for (const fs::path& file : new_files->files) {
    const fs::path inner = file.lexically_relative(after);
    pairs.push_back({file.string(), left.erase(inner) > 0 ? (before / inner).string() : ""});
  }
  for (const fs::path& inner : left) pairs.push_back({"", (before / inner).string()});
  if (!pairs.empty()) return pairs;
  return Error{ErrorCode::kIo, after, "no asset in it, and none in " + before};
}

/// A pair, or an asset that has no other: new ones are told of, lost ones fail where there are limits.
FileOutcome compare_or_tell(const BulkInput& input, const CompareCommand& command) {
  if (!input.path.empty() && !input.source.empty()) return compare_pair(input, command);
  FileOutcome out;
  const std::string& path = input.path.empty() ? input.source : input.path;
  std::error_code error;
  const std::string bytes = grouped_digits(std::filesystem::file_size(path, error));
  if (!input.path.empty()) {
    out.cells = {"-", bytes, "new"};
  } else {
    out.cells = {bytes, "-", "gone"};
    if (!command.budget.empty()) out.fail({ErrorCode::kCheckFailed, path, "has no newer asset"});
  }
  return out;
}

int run_compare(const Verb& verb, std::span<char* const> args) {
  CompareCommand command;
  CompareOptions& options = command.options;
  BulkWords bulk;
  OptionParser parser(verb);
  parser.add_positional("OLD", options.before, "a .lode asset, or a folder of them");
  parser.add_positional("NEW", options.after, "the asset or the folder to compare with it");
  parser.group("Output");
  add_output_options(parser, options.output);
  add_budget_option(parser, options.fail_if, "--format json", "file_bytes.ratio>1.02, any(meshes).levels.change!=0");
  add_bulk_outputs(parser, bulk);
  parser.group("Pictures");
  parser.add_flag("--render", options.is_rendered, "draw both with one camera and compare the pictures");
  add_camera_options(parser, options.camera);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, options.max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  auto budget = read_budget_option(options.fail_if, app::compare_schema());
  if (!budget) return print_error(budget.error());
  command.budget = std::move(*budget);
  if (app::mentions(command.budget, "picture") && !options.is_rendered) {
    return print_error({ErrorCode::kUsage, "--fail-if", "picture needs --render"});
  }
  if (!options.is_rendered && is_camera_given(options.camera)) {
    return print_error({ErrorCode::kUsage, "", "--camera, --ortho, --size and --pixel-error need --render"});
  }
  const Result<std::uint64_t> max_decoded = parse_max_decoded(options.max_decoded);
  if (!max_decoded) return print_error(max_decoded.error());
  command.max_decoded = *max_decoded;
  std::error_code error;
  const bool is_before_folder = std::filesystem::is_directory(options.before, error);
  const bool is_after_folder = std::filesystem::is_directory(options.after, error);
  if (!is_before_folder || !is_after_folder) {
    if (!bulk.junit.empty()) return print_error({ErrorCode::kUsage, "--junit", "is for two folders"});
    const JobLimit limit(bulk.jobs);
    return compare_pair({options.after, options.before}, command).print();
  }
  auto pairs = pair_folders(options.before, options.after);
  if (!pairs) return print_error(pairs.error());
  return run_bulk({"compare",
                   {{"old bytes", 13}, {"new bytes", 13}, {"change", 8}},
                   [&](const BulkInput& input) { return compare_or_tell(input, command); }},
                  *pairs, bulk, options.output);
}

}  // namespace

const Verb kCompareVerb{
    "compare", "show what changed between two assets and check it against limits",
    "Compares sizes, settings, meshes, levels, materials and images of two assets, usually two builds of one scene. "
    "With --render both are drawn with one camera and the pictures are compared.\n\n"
    "With --fail-if the changes become limits that a pipeline can check.\n\n"
    "Two folders are compared asset by asset, by their places below them, with a row each. An asset that only the "
    "older "
    "one has fails where there are limits.",
    "meshlode compare old.lode new.lode\n"
    "  meshlode compare golden/ out/ --render --fail-if 'picture.psnr<40' --junit compare.xml\n"
    "  meshlode compare old.lode new.lode --fail-if 'file_bytes.ratio>1.02'\n"
    "  meshlode compare old.lode new.lode --render --fail-if 'picture.psnr<40'",
    run_compare};

}  // namespace meshlode::cli
