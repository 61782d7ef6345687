// SPDX-License-Identifier: GPL-3.0-or-later
// `info` for people: totals, one table of levels per mesh, materials, sections.
#include <map>

#include "base/append_format.h"
#include "base/hash.h"
#include "base/printable.h"
#include "format/names.h"
#include "out/report/info.h"

namespace meshlode::out {

namespace {

constexpr std::size_t kMaxRows = 40;  ///< of meshes, materials and the like: a city has thousands; JSON lists all

void add_mesh(std::string& out, const run::Asset& asset, std::uint32_t id, const MeshInfo& info) {
  const format::MeshRecord& mesh = asset.meshes()[id];
  append_format(out, "\nmesh %u  %s\n", id, printable(asset.string(mesh.name)).c_str());
  append_format(out, "  %s source triangles, %s stored (%.3fx), diagonal %.6g, grid step %u * 2^%d, tier %s\n",
                grouped_digits(mesh.source_triangles).c_str(), grouped_digits(info.triangles).c_str(),
                mesh.source_triangles == 0
                    ? 0.0
                    : static_cast<double>(info.triangles) / static_cast<double>(mesh.source_triangles),
                mesh.diagonal, mesh.grid.mantissa, mesh.grid.log2, format::name_of(mesh.error_tier));
  append_format(out, "  %llu root(s) with %llu triangles, %zu stuck group(s), level 0 deviates by %.3g\n",
                static_cast<unsigned long long>(info.roots), static_cast<unsigned long long>(info.root_triangles),
                info.stuck.size(), static_cast<double>(mesh.level0_deviation));
  if (!info.stuck.empty()) {
    std::map<std::string, std::uint64_t> reasons;
    for (const StuckGroupInfo& stuck : info.stuck) ++reasons[format::name_of(stuck.reason)];
    append_format(out, "  stuck:");
    for (const auto& [reason, count] : reasons) {
      append_format(out, " %s %llu", reason.c_str(), static_cast<unsigned long long>(count));
    }
    append_format(out, "\n");
  }
  // Columns for what was measured alone.
  const auto is_measured = [&](float LevelInfo::*deviation) {
    return info.levels.size() > 1 && info.levels.back().*deviation < format::kInfiniteError;
  };
  const bool has_normals =
      mesh.normal_mode != format::NormalMode::kNone && is_measured(&LevelInfo::normal_deviation_max);
  const bool has_uvs = mesh.uv_set_count > 0 && is_measured(&LevelInfo::uv_deviation_max);
  append_format(out,
                "  level  clusters   triangles    vertices   full   fill  groups  stuck   error min   error max%s%s\n",
                has_normals ? "  normals/deg" : "", has_uvs ? "         UVs" : "");
  for (const LevelInfo& level : info.levels) {
    append_format(out, "  %5u  %8s  %10s  %10s  %5llu  %5.3f  %6llu  %5llu  %10.4g  %10.4g", level.level,
                  grouped_digits(level.clusters).c_str(), grouped_digits(level.triangles).c_str(),
                  grouped_digits(level.vertices).c_str(), static_cast<unsigned long long>(level.full_clusters),
                  level.fill, static_cast<unsigned long long>(level.groups),
                  static_cast<unsigned long long>(level.stuck_groups), static_cast<double>(level.error_min),
                  static_cast<double>(level.error_max));
    if (has_normals) append_format(out, "  %11.4g", static_cast<double>(level.normal_deviation_max));
    if (has_uvs) append_format(out, "  %10.4g", static_cast<double>(level.uv_deviation_max));
    out += '\n';
  }
}

void add_byte_map(std::string& out, const ByteMap& map, const AssetInfo& info) {
  append_format(
      out,
      "\nbytes of decoded pages\n  level       total   positions     normals         UVs     colours    topology"
      "       heads   materials     padding\n");
  const auto row = [&](const char* name, const PageBits& bits, double divisor, int digits) {
    append_format(out, "  %-5s", name);
    for (const std::uint64_t count : {bits.total(), bits.positions, bits.normals, bits.uvs, bits.colors, bits.topology,
                                      bits.heads, bits.materials, bits.padding}) {
      append_format(out, "  %10.*f", digits, static_cast<double>(count) / 8.0 / divisor);
    }
    out += '\n';
  };
  for (std::size_t level = 0; level < map.levels.size(); ++level) {
    row(std::to_string(level).c_str(), map.levels[level], 1.0, 0);
  }
  row("all", map.total, 1.0, 0);
  if (info.source_triangles > 0) row("/src", map.total, static_cast<double>(info.source_triangles), 3);
  if (info.stored_triangles > 0) {
    row("/tri", map.total, static_cast<double>(info.stored_triangles), 3);
    append_format(out, "  (/src, /tri: bytes per source and per stored triangle; tables beside the pages: %s bytes)\n",
                  grouped_digits(map.table_bytes).c_str());
  }
}

void add_more(std::string& out, std::size_t total, const char* what) {
  if (total > kMaxRows) append_format(out, "  … and %zu more %s (--format json lists all)\n", total - kMaxRows, what);
}

void append_sections(std::string& out, const run::Asset& asset) {
  append_format(out, "\nsections        bytes     decoded\n");
  for (const format::SectionEntry& section : asset.sections()) {
    append_format(out, "  %s  %12s %11s\n", section_name(section.id).c_str(), grouped_digits(section.bytes).c_str(),
                  grouped_digits(section_decoded_bytes(asset, section)).c_str());
  }
}

}  // namespace

std::string info_text(const run::Asset& asset, const AssetInfo& info, bool list_stuck) {
  const MetaInfo& meta = info.meta;
  const format::FileHeader& header = asset.header();
  Hash128 hash{};
  for (std::size_t i = 0; i < hash.size(); ++i) hash[i] = header.content_hash[i];

  std::string out;
  append_format(out, "format version    %u   (%s)\n", header.version, printable(meta.generator).c_str());
  append_format(out, "content hash      %s\n", to_hex(hash).c_str());
  append_format(out, "source            %s   %s\n", printable(meta.source_file).c_str(),
                printable(meta.source_hash).c_str());
  if (!meta.preset.empty() && meta.preset != "default") {
    append_format(out, "preset            %s\n", printable(meta.preset).c_str());
  }
  append_format(out, "bytes             %s: geometry %s, images %s\n", grouped_digits(header.file_bytes).c_str(),
                grouped_digits(info.geometry_bytes).c_str(), grouped_digits(info.image_bytes).c_str());
  if (info.source_triangles > 0) {
    append_format(out, "                  %.2f geometry bytes per source triangle\n",
                  static_cast<double>(info.geometry_bytes) / static_cast<double>(info.source_triangles));
  }
  append_format(out, "scene             %zu mesh(es), %zu instance(s), %zu material(s), %zu page(s)\n",
                asset.meshes().size(), asset.instances().size(), asset.materials().size(), asset.pages().size());
  append_format(out, "source            %s triangles, %s vertices\n", grouped_digits(info.source_triangles).c_str(),
                grouped_digits(info.source_vertices).c_str());
  append_format(out, "stored            %s triangles, %s vertices in %s clusters, %s groups, %s level(s)\n",
                grouped_digits(info.stored_triangles).c_str(), grouped_digits(info.stored_vertices).c_str(),
                grouped_digits(asset.clusters().size()).c_str(), grouped_digits(asset.groups().size()).c_str(),
                grouped_digits(info.levels).c_str());
  append_format(out, "roots             %s (at most %s a mesh), %s stuck group(s)\n",
                grouped_digits(info.roots).c_str(), grouped_digits(info.max_roots_per_mesh).c_str(),
                grouped_digits(info.stuck_groups).c_str());
  append_format(out, "dropped           %s degenerate, %s duplicate, %s repaired\n",
                grouped_digits(info.dropped_degenerate).c_str(), grouped_digits(info.dropped_duplicate).c_str(),
                grouped_digits(info.dropped_repaired).c_str());
  std::size_t setting_rows = 0;
  for (const std::string& line : meta.setting_lines) {
    if (setting_rows++ < kMaxRows) append_format(out, "settings          %s\n", printable(line, 400).c_str());
  }
  add_more(out, setting_rows, "meshes' settings");
  // What the plan leaves out is among what was left out, with its reason.
  std::size_t rows = 0;
  for (const MetaInfo::Decision& decision : meta.decisions) {
    if (!decision.is_kept || rows++ >= kMaxRows) continue;
    append_format(out, "kept              %s: %s\n", printable(decision.what, 120).c_str(),
                  printable(decision.reason, 160).c_str());
  }
  add_more(out, rows, "kept attributes");
  rows = 0;
  for (const MetaInfo::LeftOut& left : meta.left_outs) {
    if (rows++ >= kMaxRows) continue;
    append_format(out, "left out          %s: %s\n", printable(left.what, 120).c_str(),
                  printable(left.why, 160).c_str());
  }
  add_more(out, rows, "left out");
  for (std::uint32_t m = 0; m < info.meshes.size() && m < kMaxRows; ++m) add_mesh(out, asset, m, info.meshes[m]);
  add_more(out, info.meshes.size(), "meshes");

  if (list_stuck) {
    append_format(out, "\nstuck groups\n");
    for (const MeshInfo& mesh : info.meshes) {
      for (const StuckGroupInfo& stuck : mesh.stuck) {
        append_format(out, "  mesh %u  group %u  level %u  %s: %llu cluster(s), %llu triangles\n", stuck.mesh,
                      stuck.group, stuck.level, format::name_of(stuck.reason),
                      static_cast<unsigned long long>(stuck.clusters),
                      static_cast<unsigned long long>(stuck.triangles));
      }
    }
    if (info.stuck_groups == 0) append_format(out, "  none\n");
  }
  append_format(out, "\nmaterials\n");
  for (std::size_t i = 0; i < asset.materials().size() && i < kMaxRows; ++i) {
    const format::MaterialRecord& material = asset.materials()[i];
    append_format(out, "  %3zu  %s%s%s\n", i, printable(asset.string(material.name)).c_str(),
                  material.source_index == format::kNone ? " (default)" : "",
                  material.double_sided != 0 ? ", double sided" : "");
  }
  add_more(out, asset.materials().size(), "materials");
  if (info.byte_map) add_byte_map(out, *info.byte_map, info);
  append_sections(out, asset);
  return out;
}

}  // namespace meshlode::out
