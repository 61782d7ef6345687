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
#include "file_kind.h"
#include "format/names.h"
#include "options.h"
#include "output_name.h"
#include "outputs.h"
#include "repacked.h"
#include "run/read/asset.h"
#include "run/unpack/content_hash.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct RepackOptions {
  std::string input;
  std::optional<std::string> output, codec;
  std::uint32_t jobs = 0;
  std::string max_decoded = kDefaultMaxDecodedText;
  OutputOptions out;
};

std::string describe_json(const RepackOptions& o, const run::Asset& asset, std::size_t bytes) {
  JsonWriter w;
  w.begin_object();
  w.field("file", o.input);
  w.field("output", *o.output);
  w.field("codec", *o.codec);
  w.field("content_hash", to_hex(run::stated_hash(asset)));
  w.field("input_bytes", asset.bytes().size());
  w.field("bytes", bytes);
  w.end_object();
  return w.text();
}

std::string describe_text(const RepackOptions& o, const run::Asset& asset, std::size_t bytes) {
  return o.input + ": " + std::to_string(asset.bytes().size()) + " bytes -> " + *o.output + ", " +
         std::to_string(bytes) + " bytes with " + *o.codec + ", content " + to_hex(run::stated_hash(asset)) + "\n";
}

/// The place within the file, after its name.
int print_error_in(const std::string& file, Error error) {
  error.where = error.where.empty() ? file : file + ": " + error.where;
  return print_error(error);
}

int run_repack(const Verb& verb, std::span<char* const> args) {
  RepackOptions o;
  OptionParser parser(verb);
  parser.add_positional("FILE", o.input, "a .lode asset");
  parser.group("Output");
  parser.add_value("-o,--output FILE", o.output, "asset to write (required)");
  parser.add_value("--codec", o.codec, "compression of pages on disk (required)",
                   all_names(format::kWrittenCodecNames));
  add_output_options(parser, o.out);
  parser.group("Resources");
  add_jobs_option(parser, o.jobs);
  add_max_decoded_option(parser, o.max_decoded);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if (!o.output) return print_error({ErrorCode::kUsage, "-o", "name the asset to write"});
  if (!o.codec) return print_error({ErrorCode::kUsage, "--codec", "name the codec"});
  if (const Status name = check_output_name("-o", *o.output, ".lode"); !name) return print_error(name.error());
  const std::optional<format::Codec> codec = value_in(format::kWrittenCodecNames, *o.codec);
  const Result<std::uint64_t> max_decoded = parse_max_decoded(o.max_decoded);
  if (!max_decoded) return print_error(max_decoded.error());

  const auto asset = open_asset(o.input, *max_decoded);
  if (!asset) return print_error(asset.error());
  if (const auto id = asset->file_id()) output_files().keep(*id);
  if (const Status free = output_files().claim(*o.output); !free) return print_error(free.error());
  Result<std::vector<std::uint8_t>> bytes = Error{};
  JobLimit jobs(o.jobs);
  jobs.run([&] { bytes = repacked(*asset, *codec); });
  if (!bytes) return print_error_in(o.input, bytes.error());
  if (const Status status = output_files().write(*o.output, *bytes); !status) return print_error(status.error());
  if (o.out.quiet && !o.out.json()) return 0;
  const std::string text =
      o.out.json() ? describe_json(o, *asset, bytes->size()) : describe_text(o, *asset, bytes->size());
  return print_out(text) ? 0 : static_cast<int>(ErrorCode::kIo);
}

}  // namespace

const Verb kRepackVerb{
    "repack", "store an asset's pages with another codec, without a new build",
    "Decodes each page and stores it with another codec. The decoded content, and so its content hash, stays the same.",
    "meshlode repack scene.lode -o small.lode --codec strips\n"
    "  meshlode repack scene.lode -o plain.lode --codec none",
    run_repack};

}  // namespace meshlode::cli
