// SPDX-License-Identifier: GPL-3.0-or-later
#include "bulk.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "app/batch/jobs/weigh.h"
#include "app/batch/tell/tell.h"
#include "base/append_format.h"
#include "base/file.h"
#include "base/guarded.h"
#include "base/json_writer.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "output_name.h"
#include "outputs.h"
#include "streams.h"
#include "terminal.h"

namespace meshlode::cli {

namespace {

constexpr int kCheckFailed = static_cast<int>(ErrorCode::kCheckFailed);
constexpr int kLineWidth = 80;
constexpr int kResultWidth = 6;  ///< "FAILED"
constexpr int kLeastName = 12;   ///< of a name this much is always shown

/// What a file takes while it is worked on, for each byte of it and of its scene. Peaks measured (`/usr/bin/time`, less
/// the process): 26 with validate of bunny.lode and of terrain.lode, 14 of dragon.lode; 10 with doctor of dragon.glb;
/// 12 with verify of rock.lode and 4 of dragon.lode; info and plan take less.
constexpr std::uint64_t kMemoryPerByte = 32;
constexpr std::uint64_t kMemoryOfProcess = std::uint64_t{32} << 20U;  ///< 10 MiB measured, and stacks of threads

std::string shown_name(const BulkInput& input) {
  return input_name(input.path.empty() ? input.source : input.path);
}

/// The end of a name that is too long for its column: of paths it is the end that differs.
std::string shortened(const std::string& name, std::size_t width) {
  if (name.size() <= width) return name;
  std::size_t begin = name.size() - (width - 3);
  while (begin < name.size() && (static_cast<unsigned char>(name[begin]) & 0xC0U) == 0x80U) ++begin;  // UTF-8
  return "..." + name.substr(begin);
}

std::string plain_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return text;
}

std::string head_row(const BulkVerb& verb) {
  std::string row = "result";
  for (const BulkColumn& column : verb.columns) append_format(row, "  %*s", column.width, column.name);
  return row + "  file\n";
}

const char* result_word(int exit_code) {
  return exit_code == 0 ? "ok" : exit_code == kCheckFailed ? "FAILED" : "error";
}

std::string row_of(const BulkVerb& verb, const BulkInput& input, const FileOutcome& outcome) {
  const char* const word = result_word(outcome.exit_code);
  std::string row = colored(Stream::kOut, outcome.exit_code == 0 ? Color::kGreen : Color::kRed, word);
  row.append(static_cast<std::size_t>(kResultWidth) - std::string_view(word).size(), ' ');
  int used = kResultWidth;
  for (std::size_t i = 0; i < verb.columns.size(); ++i) {
    const char* const cell = i < outcome.cells.size() ? outcome.cells[i].c_str() : "";
    append_format(row, "  %*s", verb.columns[i].width, cell);
    used += 2 + std::max(verb.columns[i].width, static_cast<int>(std::string_view(cell).size()));
  }
  const std::string name = plain_line(shown_name(input));
  row += "  " + shortened(name, static_cast<std::size_t>(std::max(kLeastName, kLineWidth - used - 2))) + "\n";
  // A line that begins with two colons is a command to some CI systems.
  const std::string shown = name.starts_with("::") ? "./" + name : name;
  for (const std::string& line : outcome.details) row += "  " + shown + ": " + plain_line(line) + "\n";
  return row;
}

std::string sum_row(const std::vector<int>& exit_codes) {
  std::size_t ok = 0, failed = 0;
  for (const int code : exit_codes) {
    ok += code == 0 ? 1 : 0;
    failed += code == kCheckFailed ? 1 : 0;
  }
  const std::size_t errors = exit_codes.size() - ok - failed;
  std::string text = std::to_string(exit_codes.size()) + (exit_codes.size() == 1 ? " file: " : " files: ");
  text += std::to_string(ok) + " ok";
  if (failed > 0) text += ", " + std::to_string(failed) + " failed";
  if (errors > 0) text += ", " + std::to_string(errors) + (errors == 1 ? " error" : " errors");
  return text + "\n";
}

std::string message_of(const FileOutcome& outcome) {
  std::string text;
  for (const Error& error : outcome.errors) text += (text.empty() ? "" : "\n") + error.message();
  for (const std::string& line : outcome.details) text += (text.empty() ? "" : "\n") + line;
  return text;
}

/// docs/schemas/bulk.schema.json: an entry.
void write_entry(JsonWriter& json, const BulkInput& input, const FileOutcome& outcome) {
  json.begin_object();
  json.field("file", shown_name(input));
  json.field("exit_code", outcome.exit_code);
  json.text_or_null_field("error", outcome.errors.empty() ? "" : outcome.errors.front().message());
  json.key("result");
  if (outcome.text.empty()) {
    json.null();
  } else {
    write_document(json, outcome.text, 3);
  }
  json.end_object();
}

std::size_t files_at_once(const std::vector<BulkInput>& files, std::uint64_t max_memory, std::uint64_t besides) {
  std::vector<std::uint64_t> bytes;
  for (const BulkInput& input : files) {
    bytes.push_back(app::weigh_scene(input.path) + (input.source.empty() ? 0 : app::weigh_scene(input.source)));
  }
  return count_at_once(std::move(bytes), max_memory, besides);
}

FileOutcome work_on(const BulkVerb& verb, const BulkInput& input) {
  FileOutcome outcome;
  if (!input.error.empty()) {
    outcome.fail({static_cast<ErrorCode>(input.exit_code), "", input.error});
    return outcome;
  }
  const auto done = guarded(input.path, [&]() -> Result<bool> {
    outcome = verb.work(input);
    outcome.errors.insert(outcome.errors.end(), outcome.late_errors.begin(), outcome.late_errors.end());
    return true;
  });
  if (!done) {
    outcome = {};
    outcome.fail(done.error());
  }
  return outcome;
}

}  // namespace

std::size_t count_at_once(std::vector<std::uint64_t> bytes, std::uint64_t max_memory, std::uint64_t besides) {
  std::uint64_t limit = max_memory;
  if (limit == 0) {
    const auto available = available_memory();
    if (!available) return thread_limit();
    limit = *available + resident_memory();
  }
  std::sort(bytes.rbegin(), bytes.rend());
  std::uint64_t sum = kMemoryOfProcess;
  std::size_t count = 0;
  while (count < std::min(bytes.size(), thread_limit())) {
    const std::uint64_t need = std::min(bytes[count], ~std::uint64_t{0} / kMemoryPerByte) * kMemoryPerByte;
    if (sum > limit || need > limit - sum || besides > limit - sum - need) break;
    sum += need + besides;
    ++count;
  }
  return std::max<std::size_t>(1, count);
}

void write_document(JsonWriter& json, std::string_view document, std::size_t depth) {
  std::string inner;
  document.remove_suffix(1);  // the line break at its end; no string in it has one
  for (const char c : document) {
    inner += c;
    if (c == '\n') inner.append(2 * depth, ' ');
  }
  json.raw(inner);
}

int FileOutcome::print(const std::string& report) const {
  std::fputs(notes.c_str(), stderr);
  for (const Error& error : errors) print_error(error);
  if (!text.empty()) {
    const Status written = write_output(report, text);
    if (!written) return print_error(written.error());
  }
  for (const Error& error : late_errors) print_error(error);
  return exit_code;
}

int run_bulk(const BulkVerb& verb, const std::vector<BulkInput>& files, const BulkWords& words,
             const OutputOptions& output, const std::string& report) {
  const auto max_memory = parse_max_memory(words.max_memory);
  if (!max_memory) return print_error(max_memory.error());
  if (!words.junit.empty()) {
    if (const Status name = check_text_name("--junit", words.junit, {".xml"}); !name) return print_error(name.error());
    if (const Status free = output_files().claim(words.junit); !free) return print_error(free.error());
  }
  int worst = 0;
  const auto take = [&](const Status& done) {
    if (!done) worst = std::max(worst, print_error(done.error()));
  };
  const bool is_streamed = report == kStream && !output.json();
  std::string text;
  JsonWriter json;
  json.begin_object();
  if (!verb.has_bare_documents) json.field("verb", verb.name);
  json.key("files");
  json.begin_array();
  const auto say = [&](const std::string& rows) {
    text += rows;
    if (!is_streamed || text.empty()) return;
    take(write_stdout(text));
    text.clear();
  };
  if (!output.json() && !output.quiet) say(head_row(verb));

  std::vector<std::optional<FileOutcome>> done(files.size());
  std::vector<int> exit_codes;
  std::vector<app::TestCase> tests(files.size());
  std::mutex mutex;
  std::size_t next = 0;  // the first file that is not yet told of
  const auto tell = [&](std::size_t i) {
    const FileOutcome& outcome = *done[i];
    std::fputs(outcome.notes.c_str(), stderr);
    for (const Error& error : outcome.errors) print_error(error);
    exit_codes.push_back(outcome.exit_code);
    worst = std::max(worst, outcome.exit_code);
    tests[i].name = shown_name(files[i]);
    tests[i].exit_code = outcome.exit_code;
    tests[i].text = message_of(outcome);
    if (output.json() && verb.has_bare_documents) {
      if (!outcome.text.empty()) write_document(json, outcome.text, 2);
    } else if (output.json()) {
      write_entry(json, files[i], outcome);
    } else if (!output.quiet || !outcome.details.empty()) {
      say(row_of(verb, files[i], outcome));
    }
  };
  JobLimit limit(words.jobs);
  limit.run([&] {
    parallel_for_each_in_order(
        files.size(), files_at_once(files, *max_memory, verb.memory_besides), [&](std::size_t i) {
          const auto start = std::chrono::steady_clock::now();
          FileOutcome outcome = work_on(verb, files[i]);
          const std::lock_guard lock(mutex);
          tests[i].seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
          done[i] = std::move(outcome);
          for (; next < files.size() && done[next]; ++next) {
            tell(next);
            done[next] = FileOutcome{};  // it may hold much
          }
        });
  });
  json.end_array();
  if (!verb.has_bare_documents) json.field("exit_code", worst);
  json.end_object();
  if (output.json()) text = json.text();
  if (!output.json() && !output.quiet) say(sum_row(exit_codes));
  if (!is_streamed) take(write_output(report, text));
  if (!words.junit.empty()) take(write_text(words.junit, app::junit_xml(verb.name, tests)));
  return worst;
}

int write_bulk(const Verb& verb, const BulkWords& words, const BulkTarget& target, std::vector<BulkColumn> columns,
               const OutputOptions& output, std::function<FileOutcome(const BulkInput&)> work) {
  if (words.output == kStream && output.json()) {
    return print_error({ErrorCode::kUsage, "-o", "- and --format json both mean stdout"});
  }
  auto inputs = find_bulk_inputs(verb, words, app::InputKind::kAssets, ManifestSide::kAssets);
  if (!inputs) return print_error(inputs.error());
  const Status planned = plan_outputs(*inputs, words, target.what, target.extension);
  if (!planned) return print_error(planned.error());
  if (!inputs->is_single) {
    return run_bulk({verb.name, std::move(columns), std::move(work)}, inputs->files, words, output);
  }
  JobLimit limit(words.jobs);
  FileOutcome outcome;
  limit.run([&] { outcome = work(inputs->files.front()); });
  return outcome.print();
}

}  // namespace meshlode::cli
