// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/rows.h"

#include <cmath>
#include <map>
#include <span>

#include "app/report/fold_reasons.h"
#include "base/append_format.h"
#include "base/hash.h"
#include "base/printable.h"
#include "format/names.h"

namespace meshlode::app {

namespace {

/// The file and its source.
void add_file_rows(std::vector<Row>& rows, const run::Asset& asset, const AssetInfo& info) {
  const MetaInfo& meta = info.meta;
  const format::FileHeader& header = asset.header();
  Hash128 hash{};
  for (std::size_t i = 0; i < hash.size(); ++i) hash[i] = header.content_hash[i];
  rows.push_back({"format version", std::to_string(header.version) + "   (" + printable(meta.generator) + ")"});
  rows.push_back({"content hash", to_hex(hash)});
  rows.push_back({"source", printable(meta.source_file) + "   " + printable(meta.source_hash)});
  if (!meta.preset.empty() && meta.preset != "default") rows.push_back({"preset", printable(meta.preset)});
  rows.push_back({"bytes", grouped_digits(header.file_bytes) + ": geometry " + grouped_digits(info.geometry_bytes) +
                               ", images " + grouped_digits(info.image_bytes)});
  if (!info.images.empty()) {
    const auto on_gpu = [](std::uint64_t bytes) { return ", " + grouped_digits(bytes) + " decoded on a GPU"; };
    std::string text =
        std::to_string(info.images.size()) + ": " + grouped_digits(info.image_bytes) + on_gpu(info.image_gpu_bytes);
    if (!info.meta.source_images.empty()) {
      text += "; in the source " + grouped_digits(info.source_image_bytes) + on_gpu(info.source_image_gpu_bytes);
    }
    rows.push_back({"images", text});
  }
  if (info.source_triangles > 0) {
    std::string text;
    append_format(text, "%.2f geometry bytes per source triangle",
                  static_cast<double>(info.geometry_bytes) / static_cast<double>(info.source_triangles));
    rows.push_back({"", text});
  }
}

void add_count_rows(std::vector<Row>& rows, const run::Asset& asset, const AssetInfo& info) {
  std::string scene;
  append_format(scene, "%zu mesh(es), %zu instance(s), %zu material(s), %zu page(s)", asset.meshes().size(),
                asset.instances().size(), asset.materials().size(), asset.pages().size());
  rows.push_back({"scene", scene});
  rows.push_back({"source", grouped_digits(info.source_triangles) + " triangles, " +
                                grouped_digits(info.source_vertices) + " vertices"});
  rows.push_back(
      {"stored", grouped_digits(info.stored_triangles) + " triangles, " + grouped_digits(info.stored_vertices) +
                     " vertices in " + grouped_digits(asset.clusters().size()) + " clusters, " +
                     grouped_digits(asset.groups().size()) + " groups, " + grouped_digits(info.levels) + " level(s)"});
  rows.push_back(
      {"roots", grouped_digits(info.roots) + " (at most " + grouped_digits(info.max_roots_per_mesh) + " per mesh), " +
                    grouped_digits(info.stuck_groups) + " stuck group(s)" +
                    (info.border_groups > 0 ? ", " + grouped_digits(info.border_groups) + " of locked borders" : "")});
  rows.push_back({"dropped", grouped_digits(info.dropped_degenerate) + " degenerate, " +
                                 grouped_digits(info.dropped_duplicate) + " duplicate, " +
                                 grouped_digits(info.dropped_repaired) + " repaired"});
  std::uint64_t collapsed = 0;
  for (const format::MeshRecord& mesh : asset.meshes()) collapsed += mesh.grid_collapsed;
  if (collapsed > 0) {
    rows.push_back({"flat", grouped_digits(collapsed) + " triangles of level 0 have no area on the position grid"});
  }
}

void add_more_row(std::vector<Row>& rows, std::size_t total, const char* what) {
  if (total > kMaxRows) rows.push_back({"", more_text(total, what)});
}

void add_reason_rows(std::vector<Row>& rows, const char* label, std::span<const Reason> reasons, std::size_t meshes,
                     const char* more) {
  const std::vector<Reason> folded = fold_reasons(reasons, meshes);
  for (std::size_t i = 0; i < folded.size() && i < kMaxRows; ++i) {
    rows.push_back({label, printable(folded[i].what, 120) + ": " + printable(folded[i].why, 160)});
  }
  add_more_row(rows, folded.size(), more);
}

/// Settings, the plan and what was left out, as META has them.
void add_plan_rows(std::vector<Row>& rows, const MetaInfo& meta, std::size_t meshes) {
  std::size_t count = 0;
  for (const std::string& line : meta.setting_lines) {
    if (count++ < kMaxRows) rows.push_back({"settings", printable(line, 400)});
  }
  add_more_row(rows, count, "meshes' settings");
  std::vector<Reason> kept, left_out;
  for (const MetaInfo::Decision& decision : meta.decisions) {
    if (decision.is_kept) kept.push_back({decision.what, decision.reason});
  }
  // What the plan leaves out is among these, with its reason.
  for (const MetaInfo::LeftOut& left : meta.left_outs) left_out.push_back({left.what, left.why});
  add_reason_rows(rows, "kept", kept, meshes, "kept attributes");
  add_reason_rows(rows, "left out", left_out, meshes, "left out");
}

}  // namespace

std::vector<Row> summary_rows(const run::Asset& asset, const AssetInfo& info) {
  std::vector<Row> rows;
  add_file_rows(rows, asset, info);
  add_count_rows(rows, asset, info);
  add_plan_rows(rows, info.meta, asset.meshes().size());
  return rows;
}

std::vector<std::string> mesh_lines(const run::Asset& asset, std::uint32_t id, const MeshInfo& info) {
  const format::MeshRecord& mesh = asset.meshes()[id];
  std::vector<std::string> lines(3);
  append_format(lines[0], "%s source triangles, %s stored (%.3fx), diagonal %.6g",
                grouped_digits(mesh.source_triangles).c_str(), grouped_digits(info.triangles).c_str(),
                mesh.source_triangles == 0
                    ? 0.0
                    : static_cast<double>(info.triangles) / static_cast<double>(mesh.source_triangles),
                mesh.diagonal);
  append_format(lines[1], "tier %s, grid step %u * 2^%d, level 0 deviates by %.3g", format::name_of(mesh.error_tier),
                mesh.grid.mantissa, mesh.grid.log2, static_cast<double>(mesh.level0_deviation));
  append_format(lines[2], "%llu root(s) with %llu triangles, %llu stuck group(s)",
                static_cast<unsigned long long>(info.roots), static_cast<unsigned long long>(info.root_triangles),
                static_cast<unsigned long long>(info.stuck_groups));
  if (info.part_of) lines.push_back("pieces of mesh " + std::to_string(*info.part_of));
  if (!asset.promises().empty()) {
    const format::PromiseMeshRecord& promise = asset.promises()[id];
    const bool has_appearance = (promise.promises & format::kPromisesAppearance) != 0;
    lines.emplace_back("promises ");
    append_format(lines.back(), "%s, level 0 off by %.3g", has_appearance ? "texels and appearance" : "texels",
                  static_cast<double>(promise.level0_texels));
    if (has_appearance) append_format(lines.back(), " and %.3g", static_cast<double>(promise.level0_appearance));
    for (std::uint32_t k = 0; k < mesh.uv_set_count; ++k) {
      append_format(lines.back(), "; UV unit of set %u %.4g x %.4g", k, static_cast<double>(promise.uv_object[k][0]),
                    static_cast<double>(promise.uv_object[k][1]));
    }
    if (has_appearance) append_format(lines.back(), "; normal %.4g", static_cast<double>(promise.normal_object));
  }
  if (info.stuck.empty()) return lines;
  std::map<std::string, std::uint64_t> reasons;
  for (const StuckGroupInfo& stuck : info.stuck) ++reasons[format::name_of(stuck.reason)];
  lines.emplace_back("stuck:");
  for (const auto& [reason, count] : reasons) lines.back() += " " + reason + " " + std::to_string(count);
  return lines;
}

DeviationColumns deviation_columns(const format::MeshRecord& mesh, const MeshInfo& info) {
  const auto is_measured = [&](float LevelInfo::*deviation) {
    return info.levels.size() > 1 && info.levels.back().*deviation < format::kInfiniteError;
  };
  return {mesh.normal_mode != format::NormalMode::kNone && is_measured(&LevelInfo::normal_deviation_max),
          mesh.uv_set_count > 0 && is_measured(&LevelInfo::uv_deviation_max)};
}

std::string alpha_text(const format::MaterialRecord& material) {
  std::string text = format::name_of(material.alpha_mode);
  if (material.alpha_mode == format::AlphaMode::kMask) {
    append_format(text, " below %.4g", static_cast<double>(material.alpha_cutoff));
  }
  return text;
}

std::string more_text(std::size_t total, const char* what) {
  if (total <= kMaxRows) return {};
  return "… and " + std::to_string(total - kMaxRows) + " more " + what + " (--format json lists all)";
}

std::array<ByteColumn, 9> byte_columns(const PageBits& bits) {
  return {{{"total", bits.total()},
           {"positions", bits.positions},
           {"normals", bits.normals},
           {"UVs", bits.uvs},
           {"colours", bits.colors},
           {"topology", bits.topology},
           {"heads", bits.heads},
           {"materials", bits.materials},
           {"padding", bits.padding}}};
}

std::string rounded_text(double value, int digits) {
  std::string text;
  append_format(text, "%.*f", digits, digits == 0 ? std::floor(value + 0.5) : value);
  return text;
}

}  // namespace meshlode::app
