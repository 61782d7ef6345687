// SPDX-License-Identifier: GPL-3.0-or-later
// measure: an asset's errors by another tier, from the scene that it was built from, without building it again.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/measure/measure_asset.h"
#include "base/hash.h"
#include "base/json_writer.h"
#include "file_kind.h"
#include "format/names.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "run/read/asset.h"
#include "run/unpack/content_hash.h"
#include "source_scene.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct MeasureWords {
  std::string input, tier = "measured";
  std::optional<std::string> output;
  SourceOptions source;
  std::uint32_t jobs = 0;
  std::string max_decoded = kDefaultMaxDecodedText;
  OutputOptions out;
};

std::string describe(const MeasureWords& o, const run::Asset& measured) {
  const std::string hash = to_hex(run::stated_hash(measured));
  if (!o.out.json()) {
    return o.input + " -> " + *o.output + ", " + o.tier + ", content " + hash + "\n";
  }
  JsonWriter w;
  w.begin_object();
  w.field("file", o.input);
  w.field("source", o.source.path);
  w.field("output", *o.output);
  w.field("error_tier", o.tier);
  w.field("meshes", measured.meshes().size());
  w.field("content_hash", hash);
  w.field("bytes", measured.bytes().size());
  w.end_object();
  return w.text();
}

int run_measure(const Verb& verb, std::span<char* const> args) {
  MeasureWords o;
  OptionParser parser(verb);
  parser.add_positional("FILE", o.input, "a .lode asset");
  parser.group("Output");
  parser.add_value("-o,--output FILE", o.output, "asset to write (required)");
  parser.add_value("--error-tier", o.tier,
                   "how errors of all meshes are found: estimated (qem), sampled (measured) or proven (certified)",
                   all_names(format::kErrorTierNames));
  add_output_options(parser, o.out);
  parser.group("Source");
  add_source_options(parser, o.source);
  parser.group("Resources");
  add_jobs_option(parser, o.jobs);
  add_max_decoded_option(parser, o.max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (!o.output) return print_error({ErrorCode::kUsage, "-o", "name the asset to write"});
  if (const Status name = check_output_name("-o", *o.output, ".lode"); !name) return print_error(name.error());
  if (const Status given = check_source_options(verb.name, o.input, o.source); !given) {
    return print_error(given.error());
  }
  const format::ErrorTier tier = *value_in(format::kErrorTierNames, o.tier);
  const Result<std::uint64_t> max_decoded = parse_max_decoded(o.max_decoded);
  if (!max_decoded) return print_error(max_decoded.error());

  JobLimit jobs(o.jobs);
  const auto asset = open_asset(o.input, *max_decoded);
  if (!asset) return print_error(asset.error());
  if (const auto id = asset->file_id()) output_files().keep(*id);
  const Result<scene::Scene> source = import_source(*asset, o.source, *max_decoded);
  if (const Status free = output_files().claim(*o.output); !free) return print_error(free.error());
  if (!source) return print_error(source.error());
  if (const auto other = describe_other_source(*asset, *source, o.source)) {
    return print_error({ErrorCode::kCheckFailed, o.input, *other + ": give that scene, or --force"});
  }
  Result<std::vector<std::uint8_t>> bytes = Error{};
  jobs.run([&] { bytes = app::measure_asset(*asset, *source, tier); });
  if (!bytes) {
    Error error = bytes.error();
    error.where = error.where.empty() ? o.input : o.input + ": " + error.where;
    return print_error(error);
  }
  const auto measured = run::Asset::from_bytes(*bytes);
  if (!measured) return print_error(measured.error());
  if (const Status status = output_files().write(*o.output, *bytes); !status) return print_error(status.error());
  if (o.out.quiet && !o.out.json()) return 0;
  return print_out(describe(o, *measured)) ? 0 : static_cast<int>(ErrorCode::kIo);
}

}  // namespace

const Verb kMeasureVerb{"measure", "measure an asset's errors by another tier, without a new build",
                        "Computes the errors of a finished asset again, by another error tier, and writes the asset "
                        "with them. Triangles stay as they are.",
                        "meshlode measure scene.lode --source scene.glb --error-tier certified -o certified.lode",
                        run_measure};

}  // namespace meshlode::cli
