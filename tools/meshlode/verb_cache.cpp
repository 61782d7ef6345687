// SPDX-License-Identifier: GPL-3.0-or-later
// cache: what is in the folder of `build --cache`, and what is taken out of it.
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "app/batch/cache/store.h"
#include "base/append_format.h"
#include "base/byte_size.h"
#include "base/json_writer.h"
#include "base/printable.h"
#include "options.h"
#include "verb.h"

namespace meshlode::cli {

namespace {

struct CacheWords {
  std::optional<std::string> folder, trim;
  bool stats = false, verify = false, clear = false;
  OutputOptions out;
};

/// All that is printed: what was done first, what is there then.
struct CacheReport {
  std::string folder;
  std::optional<app::EntryCount> removed;
  std::optional<app::Store::Check> check;
  std::array<app::EntryCount, app::kEntryKindCount> counts{};
};

void write_count(JsonWriter& w, const char* key, const app::EntryCount& count) {
  w.key(key);
  w.begin_object();
  w.field("entries", count.entries);
  w.field("bytes", count.bytes);
  w.end_object();
}

app::EntryCount sum_of(const CacheReport& report) {
  app::EntryCount all;
  for (const app::EntryCount& count : report.counts) {
    all.entries += count.entries;
    all.bytes += count.bytes;
  }
  return all;
}

std::string to_json(const CacheReport& report) {
  JsonWriter w;
  w.begin_object();
  w.field("folder", report.folder);
  w.key("kinds");
  w.begin_object();
  for (std::size_t kind = 0; kind < report.counts.size(); ++kind) {
    write_count(w, app::name_of(static_cast<app::EntryKind>(kind)), report.counts[kind]);
  }
  w.end_object();
  write_count(w, "all", sum_of(report));
  if (report.removed) write_count(w, "removed", *report.removed);
  if (report.check) {
    write_count(w, "checked", report.check->checked);
    write_count(w, "broken", report.check->broken);
  }
  w.end_object();
  return w.text();
}

std::string row(const char* name, const app::EntryCount& count) {
  std::string text;
  append_format(text, "%-8s %10s %16s\n", name, grouped_digits(count.entries).c_str(),
                grouped_digits(count.bytes).c_str());
  return text;
}

std::string to_text(const CacheReport& report) {
  std::string text = "          entries            bytes\n";
  for (std::size_t kind = 0; kind < report.counts.size(); ++kind) {
    text += row(app::name_of(static_cast<app::EntryKind>(kind)), report.counts[kind]);
  }
  text += row("all", sum_of(report));
  if (report.removed) text += row("removed", *report.removed);
  if (report.check) text += row("checked", report.check->checked) + row("broken", report.check->broken);
  return text;
}

int run_cache(const Verb& verb, std::span<char* const> args) {
  CacheWords words;
  OptionParser parser(verb);
  parser.add_positional("FOLDER", words.folder, "the folder of build's --cache (default: $MESHLODE_CACHE)", {});
  parser.group("What to do");
  parser.add_flag("--stats", words.stats,
                  "count entries and bytes, which is all that is done without another of these");
  parser.add_value("--trim SIZE", words.trim,
                   "remove the entries that were used longest ago until the rest has SIZE, such as 20GiB");
  parser.add_flag("--verify", words.verify,
                  "hash every entry again and remove broken ones; exit with 6 if there are any");
  parser.add_flag("--clear", words.clear, "remove all entries");
  parser.group("Output");
  add_output_options(parser, words.out);
  if (const auto exit_code = parser.parse(args)) return *exit_code;
  if ((words.stats ? 1 : 0) + (words.verify ? 1 : 0) + (words.clear ? 1 : 0) + (words.trim ? 1 : 0) > 1) {
    return print_error({ErrorCode::kUsage, "", "give one of --stats, --trim, --verify and --clear"});
  }
  const char* const usual = std::getenv("MESHLODE_CACHE");
  CacheReport report;
  report.folder = words.folder.value_or(usual != nullptr ? usual : "");
  if (report.folder.empty()) return print_error({ErrorCode::kUsage, "FOLDER", "name the folder of the cache"});
  std::uint64_t limit = 0;
  if (words.trim) {
    const auto bytes = parse_byte_size(*words.trim);
    if (!bytes || *bytes == 0) return print_error(wrong_size("--trim", *words.trim, "a size above 0, such as 20GiB"));
    limit = *bytes;
  }
  // A cache is not made, nor anything else taken for one: it is opened as one that is only read, first.
  std::error_code error;
  if (!std::filesystem::is_directory(report.folder, error)) {
    return print_error({ErrorCode::kIo, report.folder, "no such folder"});
  }
  const auto looked_at = app::Store::open(report.folder, {0, true});
  if (!looked_at) return print_error(looked_at.error());
  const bool is_changed = (words.trim || words.clear || words.verify) &&
                          !std::filesystem::is_empty(report.folder, error);  // which would become a cache
  const auto store = app::Store::open(report.folder, {0, !is_changed});
  if (!store) return print_error(store.error());
  if (is_changed && !words.verify) {
    const auto removed = store->trim_to(limit);
    if (!removed) return print_error(removed.error());
    report.removed = *removed;
  }
  if (is_changed && words.verify) report.check = store->check();
  report.counts = store->count();
  const bool is_silent = words.out.quiet && !words.out.json();
  const bool is_broken = report.check && report.check->broken.entries > 0;
  if (!is_silent && !print_out(words.out.json() ? to_json(report) : to_text(report))) {
    return static_cast<int>(ErrorCode::kIo);
  }
  if (!is_broken) return 0;
  return print_error({ErrorCode::kCheckFailed, report.folder,
                      std::to_string(report.check->broken.entries) + " entries were broken and are removed"});
}

}  // namespace

const Verb kCacheVerb{"cache", "count, trim, verify or clear the cache of build",
                      "Counts the entries of a cache and their bytes, by kind: assets, records of what they were made "
                      "from, meshes, and what each output was made of last. Entries can be removed at any time, also "
                      "while builds use the cache: what is missing is built again.",
                      "meshlode cache .meshlode-cache\n"
                      "  meshlode cache .meshlode-cache --trim 20GiB\n"
                      "  meshlode cache .meshlode-cache --verify",
                      run_cache};

}  // namespace meshlode::cli
