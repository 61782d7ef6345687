// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "app/compare/match.h"
#include "base/hash.h"

namespace meshlode::app {

namespace {

/// A side of a comparison: the asset and its statistics.
struct Described {
  const run::Asset& asset;
  AssetInfo info;
};

Change count(const char* name, std::uint64_t before, std::uint64_t after) {
  return {name, static_cast<double>(before), static_cast<double>(after), Change::Kind::kCount};
}
Change float_change(const char* name, float before, float after) {
  return {name, double{before}, double{after}, Change::Kind::kFloat};
}

Side describe_side(const Described& side) {
  const format::FileHeader& header = side.asset.header();
  Hash128 hash{};
  std::copy(std::begin(header.content_hash), std::end(header.content_hash), hash.begin());
  const MetaInfo& meta = side.info.meta;
  return {{}, to_hex(hash), meta.generator, meta.source_file, meta.source_hash, header.version};
}

std::optional<double> bytes_per_source_triangle(const AssetInfo& info) {
  if (info.source_triangles == 0) return std::nullopt;
  return static_cast<double>(info.geometry_bytes) / static_cast<double>(info.source_triangles);
}

std::uint64_t image_count(const run::Asset& asset) {
  return static_cast<std::uint64_t>(
      std::ranges::count(asset.blobs(), format::BlobKind::kImage, &format::BlobRecord::kind));
}

void compare_totals(const Described& a, const Described& b, AssetComparison& out) {
  out.sizes = {count("file_bytes", a.asset.header().file_bytes, b.asset.header().file_bytes),
               count("geometry_bytes", a.info.geometry_bytes, b.info.geometry_bytes),
               count("image_bytes", a.info.image_bytes, b.info.image_bytes)};
  out.totals = {count("meshes", a.asset.meshes().size(), b.asset.meshes().size()),
                count("instances", a.asset.instances().size(), b.asset.instances().size()),
                count("materials", a.asset.materials().size(), b.asset.materials().size()),
                count("images", image_count(a.asset), image_count(b.asset)),
                count("source_triangles", a.info.source_triangles, b.info.source_triangles),
                count("source_vertices", a.info.source_vertices, b.info.source_vertices),
                count("stored_triangles", a.info.stored_triangles, b.info.stored_triangles),
                count("stored_vertices", a.info.stored_vertices, b.info.stored_vertices),
                count("clusters", a.asset.clusters().size(), b.asset.clusters().size()),
                count("groups", a.asset.groups().size(), b.asset.groups().size()),
                count("levels", a.info.levels, b.info.levels),
                count("roots", a.info.roots, b.info.roots),
                count("max_roots_per_mesh", a.info.max_roots_per_mesh, b.info.max_roots_per_mesh),
                count("stuck_groups", a.info.stuck_groups, b.info.stuck_groups),
                count("pages", a.asset.pages().size(), b.asset.pages().size()),
                {"bytes_per_source_triangle", bytes_per_source_triangle(a.info), bytes_per_source_triangle(b.info),
                 Change::Kind::kDouble}};
  out.dropped = {count("degenerate", a.info.dropped_degenerate, b.info.dropped_degenerate),
                 count("duplicate", a.info.dropped_duplicate, b.info.dropped_duplicate),
                 count("repaired", a.info.dropped_repaired, b.info.dropped_repaired)};
}

/// A number of a level; nothing where the side has no such level.
template <class Member>
Change level_change(const char* name, const LevelInfo* before, const LevelInfo* after, Member LevelInfo::*member) {
  constexpr bool kIsFloat = std::is_same_v<Member, float>;
  constexpr bool kIsDouble = std::is_same_v<Member, double>;
  const auto get = [&](const LevelInfo* level) {
    return level == nullptr ? std::optional<double>() : std::optional<double>(static_cast<double>(level->*member));
  };
  const Change::Kind kind = kIsFloat ? Change::Kind::kFloat : kIsDouble ? Change::Kind::kDouble : Change::Kind::kCount;
  return {name, get(before), get(after), kind};
}

LevelChange compare_level(std::uint32_t level, const MeshInfo& a, const MeshInfo& b, const TierChange& tier) {
  const auto error_change = [&](const char* name, const LevelInfo* before, const LevelInfo* after,
                                auto LevelInfo::*member) {
    Change change = level_change(name, before, after, member);
    change.is_comparable = tier.is_comparable();
    return change;
  };
  const LevelInfo* before = level < a.levels.size() ? &a.levels[level] : nullptr;
  const LevelInfo* after = level < b.levels.size() ? &b.levels[level] : nullptr;
  return {
      level,
      {level_change("clusters", before, after, &LevelInfo::clusters),
       level_change("triangles", before, after, &LevelInfo::triangles),
       level_change("vertices", before, after, &LevelInfo::vertices),
       level_change("fill", before, after, &LevelInfo::fill), level_change("groups", before, after, &LevelInfo::groups),
       level_change("stuck_groups", before, after, &LevelInfo::stuck_groups),
       error_change("error_min", before, after, &LevelInfo::error_min),
       error_change("error_max", before, after, &LevelInfo::error_max),
       level_change("normal_deviation_max", before, after, &LevelInfo::normal_deviation_max),
       level_change("uv_deviation_max", before, after, &LevelInfo::uv_deviation_max)}};
}

/// A mesh of one side, with the parts of it that the other side does not have as meshes.
struct ComparedMesh {
  std::uint32_t index = 0;
  std::string_view name;
  format::MeshRecord record;
  MeshInfo info;
};

void add_level(const LevelInfo& part, LevelInfo& whole) {
  const auto clusters = static_cast<double>(whole.clusters), more = static_cast<double>(part.clusters);
  if (more > 0.0) whole.fill = (clusters * whole.fill + more * part.fill) / (clusters + more);
  for (auto count : {&LevelInfo::clusters, &LevelInfo::triangles, &LevelInfo::vertices, &LevelInfo::full_clusters,
                     &LevelInfo::groups, &LevelInfo::stuck_groups}) {
    whole.*count += part.*count;
  }
  whole.error_min = std::min(whole.error_min, part.error_min);
  for (auto most : {&LevelInfo::error_max, &LevelInfo::normal_deviation_max, &LevelInfo::uv_deviation_max}) {
    whole.*most = std::max(whole.*most, part.*most);
  }
}

void add_part(const ComparedMesh& part, ComparedMesh& whole) {
  whole.record.source_triangles += part.record.source_triangles;
  whole.record.source_vertices += part.record.source_vertices;
  whole.record.group_count += part.record.group_count;
  whole.record.grid_collapsed += part.record.grid_collapsed;
  whole.record.diagonal = std::max(whole.record.diagonal, part.record.diagonal);
  whole.record.level0_deviation = std::max(whole.record.level0_deviation, part.record.level0_deviation);
  for (auto count : {&MeshInfo::roots, &MeshInfo::root_triangles, &MeshInfo::clusters, &MeshInfo::triangles,
                     &MeshInfo::vertices, &MeshInfo::stuck_groups}) {
    whole.info.*count += part.info.*count;
  }
  std::vector<LevelInfo>& levels = whole.info.levels;
  const std::size_t common = std::min(levels.size(), part.info.levels.size());
  for (std::size_t k = 0; k < common; ++k) add_level(part.info.levels[k], levels[k]);
  levels.insert(levels.end(), part.info.levels.begin() + static_cast<std::ptrdiff_t>(common), part.info.levels.end());
}

std::vector<ComparedMesh> compared_meshes(const Described& side, const Described& other) {
  std::set<std::string_view> parts;  // that the other side has too
  for (std::size_t m = 0; m < other.info.meshes.size(); ++m) {
    if (other.info.meshes[m].part_of) parts.insert(other.asset.string(other.asset.meshes()[m].name));
  }
  const auto meshes = side.asset.meshes();
  std::vector<ComparedMesh> out;
  std::vector<std::size_t> place(meshes.size());  // a part comes behind its mesh
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    place[m] = out.size();
    const MeshInfo& info = side.info.meshes[m];
    ComparedMesh mesh{static_cast<std::uint32_t>(m), side.asset.string(meshes[m].name), meshes[m], info};
    if (info.part_of && !parts.contains(mesh.name)) {
      add_part(mesh, out[place[*info.part_of]]);
    } else {
      out.push_back(std::move(mesh));
    }
  }
  return out;
}

MeshChange compare_mesh(const ComparedMesh& before, const ComparedMesh& after) {
  const auto& [old_index, old_name, a, info_a] = before;
  const auto& [new_index, new_name, b, info_b] = after;
  MeshChange out;
  out.mesh = {std::string(old_name), std::string(new_name), old_index, new_index};
  out.tier = {a.error_tier, b.error_tier};
  out.changes = {count("source_triangles", a.source_triangles, b.source_triangles),
                 count("source_vertices", a.source_vertices, b.source_vertices),
                 count("stored_triangles", info_a.triangles, info_b.triangles),
                 count("stored_vertices", info_a.vertices, info_b.vertices),
                 count("clusters", info_a.clusters, info_b.clusters),
                 count("groups", a.group_count, b.group_count),
                 count("roots", info_a.roots, info_b.roots),
                 count("root_triangles", info_a.root_triangles, info_b.root_triangles),
                 count("stuck_groups", info_a.stuck_groups, info_b.stuck_groups),
                 count("grid_collapsed", a.grid_collapsed, b.grid_collapsed),
                 {"diagonal", a.diagonal, b.diagonal, Change::Kind::kDouble},
                 float_change("level0_deviation", a.level0_deviation, b.level0_deviation),
                 count("levels", info_a.levels.size(), info_b.levels.size())};
  const std::size_t levels = std::max(info_a.levels.size(), info_b.levels.size());
  for (std::size_t level = 0; level < levels; ++level) {
    out.levels.push_back(compare_level(static_cast<std::uint32_t>(level), info_a, info_b, out.tier));
  }
  return out;
}

std::vector<OneSided> one_sided(const std::vector<std::string_view>& names, const std::vector<std::size_t>& indices) {
  std::vector<OneSided> out;
  out.reserve(indices.size());
  for (const std::size_t i : indices) out.push_back({std::string(names[i]), static_cast<std::uint32_t>(i)});
  return out;
}

std::vector<EntryPair> entry_pairs(const std::vector<std::string_view>& before,
                                   const std::vector<std::string_view>& after, const Matches& matches) {
  std::vector<EntryPair> out;
  for (const auto& [i, j] : matches.pairs) {
    out.push_back(
        {std::string(before[i]), std::string(after[j]), static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
  }
  return out;
}

/// Names of records that have one.
template <class Record>
std::vector<std::string_view> names_of(const run::Asset& asset, const std::vector<const Record*>& records) {
  std::vector<std::string_view> names;
  names.reserve(records.size());
  for (const Record* record : records) names.push_back(asset.string(record->name));
  return names;
}

template <class Record>
std::vector<const Record*> pointers_to(std::span<const Record> records) {
  std::vector<const Record*> out;
  out.reserve(records.size());
  for (const Record& record : records) out.push_back(&record);
  return out;
}

void compare_meshes(const Described& a, const Described& b, AssetComparison& out) {
  const std::vector<ComparedMesh> before = compared_meshes(a, b), after = compared_meshes(b, a);
  const auto names = [](const std::vector<ComparedMesh>& meshes) {
    std::vector<std::string_view> of_meshes;
    for (const ComparedMesh& mesh : meshes) of_meshes.push_back(mesh.name);
    return of_meshes;
  };
  const Matches matches = match_by_name(names(before), names(after));
  for (const auto& [i, j] : matches.pairs) out.meshes.push_back(compare_mesh(before[i], after[j]));
  for (const std::size_t i : matches.removed) {
    out.meshes_removed.push_back({std::string(before[i].name), before[i].index});
  }
  for (const std::size_t j : matches.added) out.meshes_added.push_back({std::string(after[j].name), after[j].index});
}

/// What the asset's own records say of a material; which texture is which index may change though the picture stays.
std::vector<std::string> material_changes(const format::MaterialRecord& a, const format::MaterialRecord& b) {
  std::vector<std::string> what;
  const auto add = [&](const char* name, bool is_different) {
    if (is_different) what.emplace_back(name);
  };
  add("alpha_mode", a.alpha_mode != b.alpha_mode);
  add("alpha_cutoff", a.alpha_cutoff != b.alpha_cutoff);
  add("double_sided", a.double_sided != b.double_sided);
  add("base_color", !std::equal(std::begin(a.base_color), std::end(a.base_color), std::begin(b.base_color)));
  add("base_color_texture", a.base_color_texture != b.base_color_texture);
  add("base_color_uv_set", a.base_color_uv_set != b.base_color_uv_set);
  return what;
}

void compare_materials(const run::Asset& a, const run::Asset& b, ListChange& out) {
  const auto before = names_of(a, pointers_to(a.materials()));
  const auto after = names_of(b, pointers_to(b.materials()));
  const Matches matches = match_by_name(before, after);
  const std::vector<EntryPair> pairs = entry_pairs(before, after, matches);
  std::vector<std::pair<std::size_t, std::size_t>> sources;
  sources.reserve(pairs.size());
  for (const EntryPair& pair : pairs) {
    sources.emplace_back(a.materials()[pair.old_index].source_index, b.materials()[pair.new_index].source_index);
  }
  const auto members = compare_document_materials(a.scene_json(), b.scene_json(), sources);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    auto what = material_changes(a.materials()[pairs[i].old_index], b.materials()[pairs[i].new_index]);
    what.insert(what.end(), members[i].begin(), members[i].end());
    if (!what.empty()) out.changed.push_back({pairs[i], std::move(what)});
  }
  out.removed = one_sided(before, matches.removed);
  out.added = one_sided(after, matches.added);
}

void compare_images(const run::Asset& a, const run::Asset& b, ListChange& out) {
  const auto images_of = [](const run::Asset& asset) {
    auto blobs = pointers_to(asset.blobs());
    std::erase_if(blobs, [](const format::BlobRecord* blob) { return blob->kind != format::BlobKind::kImage; });
    return blobs;
  };
  const auto old_images = images_of(a), new_images = images_of(b);
  const auto before = names_of(a, old_images), after = names_of(b, new_images);
  const Matches matches = match_by_name(before, after);
  for (const EntryPair& pair : entry_pairs(before, after, matches)) {
    const format::BlobRecord& old_image = *old_images[pair.old_index];
    const format::BlobRecord& new_image = *new_images[pair.new_index];
    std::vector<std::string> what;
    if (a.string(old_image.mime_type) != b.string(new_image.mime_type)) what.emplace_back("mime_type");
    if (old_image.bytes != new_image.bytes) what.emplace_back("bytes");
    if (old_image.checksum != new_image.checksum) what.emplace_back("content");
    if (!what.empty()) out.changed.push_back({pair, std::move(what)});
  }
  out.removed = one_sided(before, matches.removed);
  out.added = one_sided(after, matches.added);
}

/// A section that one side alone has is nothing on the other.
void compare_sections(const run::Asset& a, const run::Asset& b, std::vector<SectionChange>& out) {
  std::map<std::uint32_t, std::size_t> place_of;
  for (const bool is_new : {false, true}) {
    const run::Asset& asset = is_new ? b : a;
    for (const format::SectionEntry& section : asset.sections()) {
      const auto [place, is_first] = place_of.try_emplace(section.id, out.size());
      if (is_first) out.push_back({section_name(section.id), {Change{"bytes"}, Change{"bytes_decoded"}}});
      std::vector<Change>& changes = out[place->second].changes;
      const auto add = [&](Change& change, std::uint64_t bytes) {
        std::optional<double>& side = is_new ? change.after : change.before;
        side = side.value_or(0.0) + static_cast<double>(bytes);
      };
      add(changes[0], section.bytes);
      add(changes[1], section_decoded_bytes(asset, section));
    }
  }
}

/// Whether the number stands for infinity in the format, or is none.
bool is_infinite(double number) {
  return !std::isfinite(number) || number >= static_cast<double>(format::kInfiniteError);
}

}  // namespace

std::optional<double> Change::difference() const {
  if (!before || !after || !is_comparable) return std::nullopt;
  if (*before == *after) return 0.0;
  if (is_infinite(*before) || is_infinite(*after)) return std::nullopt;
  return *after - *before;
}

std::optional<double> Change::ratio() const {
  if (!before || !after || !is_comparable) return std::nullopt;
  if (*before == *after) return 1.0;
  if (*before == 0.0 || is_infinite(*before) || is_infinite(*after)) return std::nullopt;
  return *after / *before;
}

AssetComparison compare_assets(const run::Asset& before, const run::Asset& after) {
  const Described a{before, describe_asset(before)}, b{after, describe_asset(after)};
  AssetComparison out;
  out.before = describe_side(a);
  out.after = describe_side(b);
  out.is_content_equal = out.before.content_hash == out.after.content_hash;
  out.is_source_equal = out.before.source_hash == out.after.source_hash;
  compare_totals(a, b, out);
  out.settings = compare_settings(a.info.meta.settings, b.info.meta.settings);
  compare_meshes(a, b, out);
  compare_materials(before, after, out.materials);
  compare_images(before, after, out.images);
  compare_sections(before, after, out.sections);
  return out;
}

}  // namespace meshlode::app
