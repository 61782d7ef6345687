// SPDX-License-Identifier: GPL-3.0-or-later
// The order of the rules: each step needs what the one before it proved, so that no rule reads beyond anything.
#include "judge/validate/validate.h"

#include <cstring>
#include <memory>
#include <optional>

#include "judge/validate/file_tables.h"
#include "judge/validate/geometry.h"
#include "judge/validate/page_rules.h"
#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::judge {

namespace {

void run_rules(std::span<const std::uint8_t> bytes, RuleLog& log) {
  const std::optional<FileTables> file = read_tables(bytes, log);
  if (!file || !check_tables(*file, log)) return;
  check_dag(*file, log);
  check_trees(*file, log);
  check_promises(*file, log);
  if (!check_page_table(*file, log)) return;

  const Result<run::Asset> asset = run::Asset::from_bytes(bytes);
  if (asset) {
    const Status size = run::check_decoded_bytes(*asset, run::count_decoded_bytes(*asset));
    if (!log.expect(
            size.ok(), Rule::kL099, [&] { return size.error().where; }, [&] { return size.error().detail; }))
      return;
  }
  const LoadedPages loaded = load_pages(*file, asset ? &asset.value() : nullptr, log);
  if (loaded.is_complete && log.count_of(Rule::kL114) == 0) {
    std::vector<std::span<const std::uint8_t>> page_bytes;
    for (const run::PageBytes& page : loaded.pages) page_bytes.push_back(page.bytes());
    check_content_hash(*file, page_bytes, log);
  }
  const bool pages_sound = check_page_bytes(*file, loaded, log);
  // The reader refuses at the first fault of its own rules; where others were named already, that is no news.
  log.check(Rule::kL099);
  if (!asset) {
    if (log.finding_count() == 0) log.add(Rule::kL099, asset.error().where, asset.error().detail);
    return;
  }
  if (!pages_sound) return;
  const Status geometry = check_geometry(*asset, log);
  if (!geometry && log.finding_count() == 0) log.add(Rule::kL099, geometry.error().where, geometry.error().detail);
}

}  // namespace

ValidationReport validate_asset(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint64_t> aligned;  // Asset views its bytes through records of 8-byte alignment
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % 8 != 0) {
    aligned.resize((bytes.size() + 7) / 8);
    std::memcpy(aligned.data(), bytes.data(), bytes.size());
    bytes = {reinterpret_cast<const std::uint8_t*>(aligned.data()), bytes.size()};
  }
  RuleLog log;
  run_rules(bytes, log);
  ValidationReport report;
  report.finding_count = log.finding_count();
  report.checked = log.checked();
  report.findings = log.take_findings();
  return report;
}

}  // namespace meshlode::judge
