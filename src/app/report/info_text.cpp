// SPDX-License-Identifier: GPL-3.0-or-later
// `info` for people: totals, the plan, levels as bars, materials, the byte map, sections.
#include <algorithm>
#include <array>
#include <string_view>

#include "app/report/info.h"
#include "app/report/rows.h"
#include "base/append_format.h"
#include "base/printable.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

constexpr int kBarWidth = 10;  ///< characters

/// Errors have bars where the columns of normals and UVs leave room. \returns whether they have
bool add_mesh(std::string& out, const run::Asset& asset, std::uint32_t id, const MeshInfo& info, BarStyle style) {
  const format::MeshRecord& mesh = asset.meshes()[id];
  append_format(out, "\nmesh %u  %s\n", id, printable(asset.string(mesh.name)).c_str());
  for (const std::string& line : mesh_lines(asset, id, info)) out += "  " + line + "\n";
  const DeviationColumns columns = deviation_columns(mesh, info);
  const bool has_bars = !columns.normals && !columns.uvs;
  append_format(out, "level clusters  triangles   vertices fill groups stuck error max");
  append_format(out, "%s%s\n", columns.normals ? " normals" : "", columns.uvs ? "     UVs" : "");
  double largest = 0.0;
  for (const LevelInfo& level : info.levels) largest = std::max(largest, double{level.error_max});
  for (const LevelInfo& level : info.levels) {
    append_format(out, "%5u %8s %10s %10s %3.0f%% %6llu %5llu %9.3g", level.level,
                  grouped_digits(level.clusters).c_str(), grouped_digits(level.triangles).c_str(),
                  grouped_digits(level.vertices).c_str(), 100.0 * level.fill,
                  static_cast<unsigned long long>(level.groups), static_cast<unsigned long long>(level.stuck_groups),
                  static_cast<double>(level.error_max));
    if (has_bars) out += " " + bar(error_fraction(level.error_max, largest), kBarWidth, style);
    if (columns.normals) append_format(out, " %7.3g", static_cast<double>(level.normal_deviation_max));
    if (columns.uvs) append_format(out, " %7.2g", static_cast<double>(level.uv_deviation_max));
    out += '\n';
  }
  return has_bars;
}

/// So that no figure of a column has more than six digits.
struct ByteUnit {
  const char* name;
  double bytes;
};
ByteUnit byte_unit(const PageBits& total) {
  constexpr std::uint64_t kMost = 999'999ULL * 8U;  // bits
  if (total.total() <= kMost) return {"bytes", 1.0};
  return total.total() / 1024U <= kMost ? ByteUnit{"KiB", 0x1p10} : ByteUnit{"MiB", 0x1p20};
}

/// Columns of nothing are left out, which any asset has: no colours, or no materials within a mesh.
void add_byte_map(std::string& out, const ByteMap& map, const AssetInfo& info) {
  const ByteUnit unit = byte_unit(map.total);
  const auto totals = byte_columns(map.total);
  append_format(out, "\ndecoded pages, %s\nlevel", unit.name);
  const auto width = [](const ByteColumn& column) {
    return std::max(6, static_cast<int>(std::string_view(column.name).size()));
  };
  for (const ByteColumn& column : totals) {
    if (column.bits > 0) append_format(out, " %*s", width(column), column.name);
  }
  out += '\n';
  const auto row = [&](const char* name, const PageBits& bits, double divisor, int digits) {
    append_format(out, "%-5s", name);
    const auto columns = byte_columns(bits);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (totals[i].bits == 0) continue;
      append_format(out, " %*s", width(columns[i]),
                    rounded_text(static_cast<double>(columns[i].bits) / 8.0 / divisor, digits).c_str());
    }
    out += '\n';
  };
  for (std::size_t level = 0; level < map.levels.size(); ++level) {
    row(std::to_string(level).c_str(), map.levels[level], unit.bytes, 0);
  }
  row("all", map.total, unit.bytes, 0);
  if (map.total.total() > 0) row("%", map.total, static_cast<double>(map.total.total()) / 800.0, 1);
  if (info.source_triangles > 0) row("/src", map.total, static_cast<double>(info.source_triangles), 3);
  if (info.stored_triangles == 0) return;
  row("/tri", map.total, static_cast<double>(info.stored_triangles), 3);
  out += "  /src, /tri: bytes per source and per stored triangle\n";
  append_format(out, "  tables beside the pages: %s bytes\n", grouped_digits(map.table_bytes).c_str());
}

void add_more_line(std::string& out, std::size_t total, const char* what) {
  if (const std::string text = more_text(total, what); !text.empty()) out += "  " + text + "\n";
}

void add_stuck(std::string& out, const AssetInfo& info) {
  append_format(out, "\nstuck groups\n");
  for (const MeshInfo& mesh : info.meshes) {
    for (const StuckGroupInfo& stuck : mesh.stuck) {
      append_format(out, "  mesh %u  group %u  level %u  %s: %llu cluster(s), %llu triangles\n", stuck.mesh,
                    stuck.group, stuck.level, format::name_of(stuck.reason),
                    static_cast<unsigned long long>(stuck.clusters), static_cast<unsigned long long>(stuck.triangles));
    }
  }
  if (info.stuck_groups + info.border_groups == 0) append_format(out, "  none\n");
}

void add_materials(std::string& out, const run::Asset& asset) {
  append_format(out, "\nmaterials\n");
  for (std::size_t i = 0; i < asset.materials().size() && i < kMaxRows; ++i) {
    const format::MaterialRecord& material = asset.materials()[i];
    append_format(out, "  %3zu  %s%s: %s%s\n", i, printable(asset.string(material.name)).c_str(),
                  material.source_index == format::kNone ? " (default)" : "", alpha_text(material).c_str(),
                  material.double_sided != 0 ? ", double sided" : "");
  }
  add_more_line(out, asset.materials().size(), "materials");
}

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return width == 0 ? "size not known" : std::to_string(width) + "x" + std::to_string(height);
}

void add_image_list(std::string& out, const run::Asset& asset, const AssetInfo& info) {
  if (info.images.empty()) return;
  append_format(out, "\nimages\n");
  for (std::size_t i = 0; i < info.images.size() && i < kMaxRows; ++i) {
    const ImageInfo& image = info.images[i];
    const format::BlobRecord& blob = asset.blobs()[image.blob];
    append_format(out, "  %3u  %s: %s, %s, %s bytes", blob.source_index, printable(asset.string(blob.name), 80).c_str(),
                  printable(asset.string(blob.mime_type), 40).c_str(), size_text(image.width, image.height).c_str(),
                  grouped_digits(blob.bytes).c_str());
    if (image.gpu_bytes) append_format(out, ", %s on a GPU", grouped_digits(*image.gpu_bytes).c_str());
    if (image.source) {
      append_format(out, "; was %s, %s, %s bytes", printable(image.source->mime_type, 40).c_str(),
                    size_text(image.source->width, image.source->height).c_str(),
                    grouped_digits(image.source->bytes).c_str());
    }
    out += "\n";
  }
  add_more_line(out, info.images.size(), "images");
}

void append_sections(std::string& out, const run::Asset& asset) {
  append_format(out, "\nsections        bytes     decoded\n");
  for (const format::SectionEntry& section : asset.sections()) {
    append_format(out, "  %s  %12s %11s\n", section_name(section.id).c_str(), grouped_digits(section.bytes).c_str(),
                  grouped_digits(section_decoded_bytes(asset, section)).c_str());
  }
}

}  // namespace

std::string info_text(const run::Asset& asset, const AssetInfo& info, bool list_stuck, BarStyle style) {
  std::string out;
  for (const Row& row : summary_rows(asset, info)) {
    append_format(out, "%-16s  ", row.label.c_str());
    out += row.value + "\n";
  }
  bool has_bars = false;
  for (std::uint32_t m = 0; m < info.meshes.size() && m < kMaxRows; ++m) {
    has_bars = add_mesh(out, asset, m, info.meshes[m], style) || has_bars;
  }
  add_more_line(out, info.meshes.size(), "meshes");
  if (has_bars) out += "  (the bar of an error is half as long for a quarter of it)\n";
  if (list_stuck) add_stuck(out, info);
  add_materials(out, asset);
  add_image_list(out, asset, info);
  if (info.byte_map) add_byte_map(out, *info.byte_map, info);
  append_sections(out, asset);
  return out;
}

}  // namespace meshlode::app
