// SPDX-License-Identifier: GPL-3.0-or-later
// compare: two assets side by side, and whether what changed is within limits.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "app/compare/compare.h"
#include "app/compare/stored_bytes.h"
#include "budget_options.h"
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
  std::uint32_t jobs = 0;
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

int run_compare(const Verb& verb, std::span<char* const> args) {
  CompareOptions options;
  OptionParser parser(verb);
  parser.add_positional("OLD", options.before, "a .lode asset");
  parser.add_positional("NEW", options.after, "the asset to compare with it");
  parser.group("Output");
  add_output_options(parser, options.output);
  add_budget_option(parser, options.fail_if, "--format json", "file_bytes.ratio>1.02, any(meshes).levels.change!=0");
  parser.group("Pictures");
  parser.add_flag("--render", options.is_rendered, "draw both with one camera and compare the pictures");
  add_camera_options(parser, options.camera);
  parser.group("Resources");
  add_jobs_option(parser, options.jobs);
  add_max_decoded_option(parser, options.max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  const auto budget = read_budget_option(options.fail_if, app::compare_schema());
  if (!budget) return print_error(budget.error());
  if (app::mentions(*budget, "picture") && !options.is_rendered) {
    return print_error({ErrorCode::kUsage, "--fail-if", "picture needs --render"});
  }
  if (!options.is_rendered && is_camera_given(options.camera)) {
    return print_error({ErrorCode::kUsage, "", "--camera, --ortho, --size and --pixel-error need --render"});
  }
  const Result<std::uint64_t> max_decoded = parse_max_decoded(options.max_decoded);
  if (!max_decoded) return print_error(max_decoded.error());

  const JobLimit limit(options.jobs);
  const Result<run::Asset> before = open_sound(options.before, *max_decoded);
  if (!before) return print_error(before.error());
  const Result<run::Asset> after = open_sound(options.after, *max_decoded);
  if (!after) return print_error(after.error());
  app::AssetComparison comparison = app::compare_assets(*before, *after);
  comparison.before.file = options.before;
  comparison.after.file = options.after;
  if (options.is_rendered) {
    std::vector<std::string> warnings;
    auto picture = draw_pair({*before, *after, *max_decoded}, options.camera, warnings);
    for (const std::string& warning : warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
    if (!picture) return print_error(in_picture(picture.error()));
    comparison.picture = std::move(*picture);
  }
  std::vector<app::BrokenCondition> broken;
  if (!budget->empty()) {
    auto judged = app::judge_budget(*budget, app::comparison_json(comparison));
    if (!judged) return print_error(judged.error());
    broken = std::move(*judged);
  }
  std::string text;
  if (options.output.json()) {
    text = app::comparison_json(comparison, broken);
  } else if (!options.output.quiet || budget->empty()) {  // with a budget it is the verdict that is asked for
    text = app::comparison_text(comparison);
  }
  const bool is_of_errors = std::ranges::any_of(broken, [](const app::BrokenCondition& one) {
    return one.condition.find("error_min") != std::string::npos || one.condition.find("error_max") != std::string::npos;
  });
  if (const std::string tiers = app::tiers_text(comparison); is_of_errors && !tiers.empty()) {
    std::fprintf(stderr, "warning: errors are %s\n", tiers.c_str());
  }
  if (!print_out(text)) return static_cast<int>(ErrorCode::kIo);
  return print_broken(options.after, broken);
}

}  // namespace

const Verb kCompareVerb{
    "compare", "show what changed between two assets and check it against limits",
    "Compares sizes, settings, meshes, levels, materials and images of two assets, usually two builds of one scene. "
    "With --render both are drawn with one camera and the pictures are compared.\n\n"
    "With --fail-if the changes become limits that a pipeline can check.",
    "meshlode compare old.lode new.lode\n"
    "  meshlode compare old.lode new.lode --fail-if 'file_bytes.ratio>1.02'\n"
    "  meshlode compare old.lode new.lode --render --fail-if 'picture.psnr<40'",
    run_compare};

}  // namespace meshlode::cli
