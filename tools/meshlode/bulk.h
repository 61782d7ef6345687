// SPDX-License-Identifier: GPL-3.0-or-later
// A verb of one file over many: files, folders, patterns and manifests. Several files are worked on at a time; what is
// said of them comes in the order in which they were given, for any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <meshlode/result.h>

#include "app/batch/jobs/find_inputs.h"
#include "app/batch/jobs/job_result.h"
#include "base/hash.h"
#include "base/json_writer.h"
#include "options.h"

namespace meshlode::cli {

/// What a verb says of one file, kept until it is its turn to be printed.
struct FileOutcome {
  int exit_code = 0;
  std::vector<Error> errors;         ///< for stderr
  std::vector<Error> late_errors;    ///< for stderr, after the text
  std::string notes;                 ///< for stderr, as they are (--explain)
  std::string text;                  ///< what is printed of one file alone: text, or with --format json its document
  std::vector<std::string> cells;    ///< of several files: its row, as many as there are columns, or none
  std::vector<std::string> details;  ///< of several files: lines below the row; `file` is put before them

  /// Keeps an error. \returns its exit code, which is the file's where it is the worst
  int fail(Error error) {
    exit_code = std::max(exit_code, static_cast<int>(error.code));
    errors.push_back(std::move(error));
    return exit_code;
  }
  /// Errors, notes and text where one file was given: as if they had been printed at once. `report`: where the text
  /// goes, "-" for stdout. \returns the exit code
  [[nodiscard]] int print(const std::string& report = "-") const;
};

struct BulkInput {
  std::string path;
  std::string source = {};  ///< of the manifest; empty: not known
  std::string base = {};    ///< the folder below which it was found; empty: none, or the current one
  bool is_found = false;    ///< below a folder or by a pattern
  std::string place = {};   ///< of name_places()
  std::string output = {};  ///< of plan_outputs()
  /// A file of a manifest that no asset was made of, and why.
  int exit_code = 0;
  std::string error = {};
  std::optional<Hash128> asset_hash = {};   ///< what a manifest says that the asset `path` is
  std::optional<Hash128> source_hash = {};  ///< of compare: the same of the older asset, `source`
};

struct BulkWords {
  const char* name = "FILE";
  std::vector<std::string> files;
  std::string manifest, junit, max_memory = "auto";
  std::optional<std::string> output;  ///< of one file
  std::string folder;                 ///< of the outputs of many
  std::uint32_t jobs = 0;
};

/// What of a manifest the verb works on.
enum class ManifestSide : std::uint8_t { kAssets, kScenes };

struct BulkInputs {
  bool is_single = false;  ///< one file by its name: the verb says what it says of one file
  bool is_whole = true;    ///< folders and whole batches: no file is left out by a name, a pattern or a shard
  std::vector<BulkInput> files;
};

struct BulkColumn {
  const char* name;
  int width;
};

struct BulkVerb {
  const char* name;
  std::vector<BulkColumn> columns;  ///< between "result" and "file"
  std::function<FileOutcome(const BulkInput&)> work;
  bool has_bare_documents = false;   ///< the JSON lists the documents alone: a file that cannot be read has none
  std::uint64_t memory_besides = 0;  ///< of each file, bytes: what does not grow with its size
};

/// The arguments, `name` in the help, and `--manifest`.
void add_bulk_inputs(OptionParser& parser, BulkWords& words, const char* name, const char* help,
                     const char* manifest_help);
/// `--junit`, in the group of outputs.
void add_bulk_outputs(OptionParser& parser, BulkWords& words);
/// `-o` and `-O` of verbs that write a file for each, first in the group of outputs. `what`: "PNG".
void add_bulk_targets(OptionParser& parser, BulkWords& words, const std::string& what);
/// `--jobs` and `--max-memory`.
void add_bulk_resources(OptionParser& parser, BulkWords& words);

/// The files that are meant, each kept from being written over. Errors: kUsage, kIo, kInvalid.
[[nodiscard]] Result<BulkInputs> find_bulk_inputs(const Verb& verb, const BulkWords& words, app::InputKind kind,
                                                  ManifestSide side);

/// The folder that all outputs of a batch lie below, as their paths are written; empty: none.
[[nodiscard]] std::string shared_folder(const std::vector<app::JobResult>& results);

/// What the outputs of each file are called below another folder, without an extension: its place below the folder that
/// it was found in, or for those of a manifest below the one that all of them share; of a file given by itself its
/// name. Error: kUsage where two files have one place.
[[nodiscard]] Status name_places(std::vector<BulkInput>& files);

/// Where each file's output goes: the one that was named, or PLACE + `extension` below the folder. All are claimed, so
/// that none is a file that is read. Errors: kUsage, by the file's name where two have one output; kIo.
[[nodiscard]] Status plan_outputs(BulkInputs& inputs, const BulkWords& words, const std::string& what,
                                  const std::string& extension);

/// How many files of these sizes may be worked on at a time: as many as there are threads, fewer where the largest of
/// them together would need more memory than that, or with 0 than there is. One is always worked on, as if it had been
/// given alone.
/// \param besides  bytes that each takes whatever its size
[[nodiscard]] std::size_t count_at_once(std::vector<std::uint64_t> bytes, std::uint64_t max_memory,
                                        std::uint64_t besides = 0);

/// Works on all and prints a row a file, with errors on stderr, or with --format json one document. A file that fails
/// does not stop the others. `report`: where the rows or the document go, "-" for stdout. \returns the worst exit code
[[nodiscard]] int run_bulk(const BulkVerb& verb, const std::vector<BulkInput>& files, const BulkWords& words,
                           const OutputOptions& output, const std::string& report = "-");

/// What a verb writes for each file.
struct BulkTarget {
  const char* what;       ///< "PNG"
  const char* extension;  ///< ".png"
};
constexpr const char* kAssetsHelp = ".lode assets, folders of them, or patterns such as 'out/**/*.lode'";

/// All of a verb that reads assets and writes a file for each: the inputs, the outputs, and the work on one or many.
/// \returns the worst exit code
[[nodiscard]] int write_bulk(const Verb& verb, const BulkWords& words, const BulkTarget& target,
                             std::vector<BulkColumn> columns, const OutputOptions& output,
                             std::function<FileOutcome(const BulkInput&)> work);

/// A document of JsonWriter::text() as a value in another, with the indentation of that depth.
void write_document(JsonWriter& json, std::string_view document, std::size_t depth);

}  // namespace meshlode::cli
