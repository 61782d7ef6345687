// SPDX-License-Identifier: GPL-3.0-or-later
// `info --format markdown`: for a change's description or a wiki. Tables as GitHub reads them.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/report/info.h"
#include "app/report/markdown.h"
#include "app/report/rows.h"
#include "base/append_format.h"
#include "base/printable.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

std::string number(double value) {
  std::string text;
  append_format(text, "%.4g", value);
  return text;
}

void add_more_paragraph(std::string& out, std::size_t total, const char* what) {
  if (const std::string text = more_text(total, what); !text.empty()) out += "\n" + markdown_text(text) + "\n";
}

void add_mesh(std::string& out, const run::Asset& asset, std::uint32_t id, const MeshInfo& info) {
  const format::MeshRecord& mesh = asset.meshes()[id];
  out += "\n## Mesh " + std::to_string(id) + ": " + markdown_text(printable(asset.string(mesh.name))) + "\n\n";
  for (const std::string& line : mesh_lines(asset, id, info)) out += "- " + markdown_text(line) + "\n";
  out += "\n";
  const DeviationColumns columns = deviation_columns(mesh, info);
  std::vector<std::string> head{"level", "clusters", "triangles",    "vertices",  "full",
                                "fill",  "groups",   "stuck groups", "error min", "error max"};
  if (columns.normals) head.emplace_back("normals, degrees");
  if (columns.uvs) head.emplace_back("UVs");
  MarkdownTable table(out, head, 0);
  for (const LevelInfo& level : info.levels) {
    std::string fill;
    append_format(fill, "%.3f", level.fill);
    std::vector<std::string> cells{
        std::to_string(level.level),    grouped_digits(level.clusters),      grouped_digits(level.triangles),
        grouped_digits(level.vertices), grouped_digits(level.full_clusters), fill,
        grouped_digits(level.groups),   grouped_digits(level.stuck_groups),  number(level.error_min),
        number(level.error_max)};
    if (columns.normals) cells.push_back(number(level.normal_deviation_max));
    if (columns.uvs) cells.push_back(number(level.uv_deviation_max));
    table.row(cells);
  }
}

void add_stuck(std::string& out, const AssetInfo& info) {
  out += "\n## Stuck groups\n\n";
  if (info.stuck_groups + info.border_groups == 0) {
    out += "none\n";
    return;
  }
  MarkdownTable table(out, {"reason", "mesh", "group", "level", "clusters", "triangles"}, 1);
  for (const MeshInfo& mesh : info.meshes) {
    for (const StuckGroupInfo& stuck : mesh.stuck) {
      table.row({markdown_text(format::name_of(stuck.reason)), std::to_string(stuck.mesh), std::to_string(stuck.group),
                 std::to_string(stuck.level), grouped_digits(stuck.clusters), grouped_digits(stuck.triangles)});
    }
  }
}

void add_materials(std::string& out, const run::Asset& asset) {
  out += "\n## Materials\n\n";
  MarkdownTable table(out, {"name", "alpha", "sides", "index"}, 3);
  for (std::size_t i = 0; i < asset.materials().size() && i < kMaxRows; ++i) {
    const format::MaterialRecord& material = asset.materials()[i];
    table.row({markdown_text(printable(asset.string(material.name))) +
                   (material.source_index == format::kNone ? " (default)" : ""),
               markdown_text(alpha_text(material)), material.double_sided != 0 ? "both" : "front", std::to_string(i)});
  }
  add_more_paragraph(out, asset.materials().size(), "materials");
}

void add_byte_map(std::string& out, const ByteMap& map) {
  out += "\n## Bytes of decoded pages\n\n";
  std::vector<std::string> head{"level"};
  for (const ByteColumn& column : byte_columns(map.total)) head.emplace_back(column.name);
  MarkdownTable table(out, head, 1);
  const auto row = [&](std::string name, const PageBits& bits, double divisor, int digits) {
    std::vector<std::string> cells{std::move(name)};
    for (const ByteColumn& column : byte_columns(bits)) {
      cells.push_back(rounded_text(static_cast<double>(column.bits) / 8.0 / divisor, digits));
    }
    table.row(cells);
  };
  for (std::size_t level = 0; level < map.levels.size(); ++level) row(std::to_string(level), map.levels[level], 1.0, 0);
  row("all", map.total, 1.0, 0);
  if (map.total.total() > 0) row("%", map.total, static_cast<double>(map.total.total()) / 800.0, 1);
}

}  // namespace

std::string info_markdown(const run::Asset& asset, const AssetInfo& info, bool list_stuck) {
  std::string out = "# " + markdown_text(printable(info.meta.source_file)) + "\n\n";
  MarkdownTable summary(out, {"", ""}, 2);
  for (const Row& row : summary_rows(asset, info)) summary.row({row.label, markdown_text(row.value)});
  for (std::uint32_t m = 0; m < info.meshes.size() && m < kMaxRows; ++m) add_mesh(out, asset, m, info.meshes[m]);
  add_more_paragraph(out, info.meshes.size(), "meshes");
  if (list_stuck) add_stuck(out, info);
  add_materials(out, asset);
  if (info.byte_map) add_byte_map(out, *info.byte_map);
  out += "\n## Sections\n\n";
  MarkdownTable sections(out, {"section", "bytes", "decoded"}, 1);
  for (const format::SectionEntry& section : asset.sections()) {
    sections.row({markdown_text(section_name(section.id)), grouped_digits(section.bytes),
                  grouped_digits(section_decoded_bytes(asset, section))});
  }
  return out;
}

}  // namespace meshlode::app
