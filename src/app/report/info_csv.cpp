// SPDX-License-Identifier: GPL-3.0-or-later
// `info --format csv`: the columns are a promise; docs/reference/info.md lists them.
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <string>
#include <string_view>

#include "app/report/info.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

/// Cells of RFC 4180, a line a row: line breaks and other control characters of names become '?'.
class CsvWriter {
 public:
  void cell(std::string_view text) {
    separate();
    out_ += '"';
    for (const char c : text) {
      if (c == '"') out_ += '"';
      out_ += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
    }
    out_ += '"';
  }
  void cell(std::uint64_t number) {
    separate();
    out_ += std::to_string(number);
  }
  /// The shortest decimal that reads back as the same number; empty for what was not measured.
  template <std::floating_point T>
  void cell(T number) {
    separate();
    if (!std::isfinite(number) || number >= format::kInfiniteError) return;
    std::array<char, 32> digits{};
    out_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
  }
  void end_row() {
    out_ += '\n';
    is_first_ = true;
  }
  void head(std::string_view line) {
    out_ += line;
    end_row();
  }
  [[nodiscard]] const std::string& text() const { return out_; }

 private:
  void separate() {
    if (!is_first_) out_ += ',';
    is_first_ = false;
  }
  std::string out_;
  bool is_first_ = true;
};

void add_level(CsvWriter& csv, const LevelInfo& level) {
  csv.cell(std::uint64_t{level.level});
  csv.cell(level.clusters);
  csv.cell(level.triangles);
  csv.cell(level.vertices);
  csv.cell(level.full_clusters);
  csv.cell(level.fill);
  csv.cell(level.groups);
  csv.cell(level.stuck_groups);
  csv.cell(level.error_min);
  csv.cell(level.error_max);
  csv.cell(level.normal_deviation_max);
  csv.cell(level.uv_deviation_max);
}

}  // namespace

std::string info_csv(const run::Asset& asset, const AssetInfo& info, bool list_stuck) {
  CsvWriter csv;
  csv.head(list_stuck ? "mesh,name,group,level,reason,clusters,triangles"
                      : "mesh,name,level,clusters,triangles,vertices,full_clusters,fill,groups,stuck_groups,error_min,"
                        "error_max,normal_deviation_max,uv_deviation_max");
  for (std::uint32_t m = 0; m < info.meshes.size(); ++m) {
    const auto begin_row = [&] {
      csv.cell(std::uint64_t{m});
      csv.cell(asset.string(asset.meshes()[m].name));
    };
    if (!list_stuck) {
      for (const LevelInfo& level : info.meshes[m].levels) {
        begin_row();
        add_level(csv, level);
        csv.end_row();
      }
      continue;
    }
    for (const StuckGroupInfo& stuck : info.meshes[m].stuck) {
      begin_row();
      csv.cell(std::uint64_t{stuck.group});
      csv.cell(std::uint64_t{stuck.level});
      csv.cell(std::string_view(format::name_of(stuck.reason)));
      csv.cell(stuck.clusters);
      csv.cell(stuck.triangles);
      csv.end_row();
    }
  }
  return csv.text();
}

}  // namespace meshlode::app
