// SPDX-License-Identifier: GPL-3.0-or-later
// repack: an asset with its pages under another codec, without the scene that it was built from. What it says stays the
// same, and so does its content hash, which is computed again before anything is done and again of what will be
// written.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "base/json_writer.h"
#include "base/printable.h"
#include "bulk.h"
#include "file_kind.h"
#include "format/names.h"
#include "options.h"
#include "repacked.h"
#include "run/read/asset.h"
#include "run/unpack/content_hash.h"
#include "streams.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct RepackOptions {
  std::optional<std::string> codec_name;
  format::Codec codec{};
  std::string max_decoded_text = kDefaultMaxDecodedText;
  std::uint64_t max_decoded = 0;
  OutputOptions out;
};

std::string describe_json(const BulkInput& input, const RepackOptions& o, const run::Asset& asset, std::size_t bytes) {
  JsonWriter w;
  w.begin_object();
  w.field("file", input.path);
  w.field("output", input.output);
  w.field("codec", *o.codec_name);
  w.field("content_hash", to_hex(run::stated_hash(asset)));
  w.field("input_bytes", asset.bytes().size());
  w.field("bytes", bytes);
  w.end_object();
  return w.text();
}

std::string describe_text(const BulkInput& input, const RepackOptions& o, const run::Asset& asset, std::size_t bytes) {
  return input.path + ": " + std::to_string(asset.bytes().size()) + " bytes -> " + input.output + ", " +
         std::to_string(bytes) + " bytes with " + *o.codec_name + ", content " + to_hex(run::stated_hash(asset)) + "\n";
}

FileOutcome repack_file(const BulkInput& input, const RepackOptions& o) {
  FileOutcome out;
  const auto fail = [&](Error error) {
    out.fail(std::move(error));
    return out;
  };
  const auto asset = open_asset(input.path, o.max_decoded);
  if (!asset) return fail(asset.error());
  const auto bytes = repacked(*asset, o.codec);
  if (!bytes) {
    Error error = bytes.error();  // the place within the file, after its name
    error.where = error.where.empty() ? input.path : input.path + ": " + error.where;
    return fail(std::move(error));
  }
  if (const Status status = write_output(input.output, *bytes); !status) return fail(status.error());
  out.cells = {grouped_digits(asset->bytes().size()), grouped_digits(bytes->size())};
  if (o.out.json()) {
    out.text = describe_json(input, o, *asset, bytes->size());
  } else if (!o.out.quiet) {
    (input.output == kStream ? out.notes : out.text) = describe_text(input, o, *asset, bytes->size());
  }
  return out;
}

int run_repack(const Verb& verb, std::span<char* const> args) {
  RepackOptions o;
  BulkWords bulk;
  OptionParser parser(verb);
  add_bulk_inputs(parser, bulk, "FILE", kAssetsHelp, "repack the assets of this manifest of a build (default: none)");
  parser.group("Output");
  add_bulk_targets(parser, bulk, "asset");
  parser.add_value("--codec", o.codec_name, "compression of pages on disk (required)",
                   all_names(format::kWrittenCodecNames));
  add_output_options(parser, o.out);
  add_bulk_outputs(parser, bulk);
  parser.group("Resources");
  add_bulk_resources(parser, bulk);
  add_max_decoded_option(parser, o.max_decoded_text);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (!o.codec_name) return print_error({ErrorCode::kUsage, "--codec", "name the codec"});
  o.codec = *value_in(format::kWrittenCodecNames, *o.codec_name);
  const Result<std::uint64_t> max_decoded = parse_max_decoded(o.max_decoded_text);
  if (!max_decoded) return print_error(max_decoded.error());
  o.max_decoded = *max_decoded;
  return write_bulk(verb, bulk, {"asset", ".lode"}, {{"bytes", 13}, {"new bytes", 13}}, o.out,
                    [&](const BulkInput& input) { return repack_file(input, o); });
}

}  // namespace

const Verb kRepackVerb{"repack", "store an asset's pages with another codec, without a new build",
                       "Decodes each page and stores it with another codec. The decoded content, and so its content "
                       "hash, stays the same. Of many files each is written below the folder of -O.",
                       "meshlode repack scene.lode -o small.lode --codec strips\n"
                       "  meshlode repack out/ -O small --codec strips\n"
                       "  meshlode repack scene.lode -o plain.lode --codec none",
                       run_repack};

}  // namespace meshlode::cli
