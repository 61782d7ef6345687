// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/measure/measure_asset.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "app/measure/read_dag.h"
#include "app/report/read_meta.h"
#include "app/rewrite/rewrite_asset.h"
#include "base/try.h"
#include "builder/encode/encode.h"
#include "builder/hierarchy/bvh.h"
#include "builder/hierarchy/lod_bounds.h"
#include "builder/measure/canonical_form.h"
#include "builder/measure/measure.h"
#include "builder/prepare/prepare.h"
#include "builder/write_meta.h"
#include "format/names.h"
#include "format/page_hint.h"
#include "judge/verify/source_parts.h"
#include "run/decode/decode.h"

namespace meshlode::app {

namespace {

/// The tables that errors stand in.
struct Tables {
  std::vector<format::MeshRecord> meshes;
  std::vector<format::GroupRecord> groups;
  std::vector<format::NodeRecord> nodes;
  std::vector<format::PageHintRecord> page_hints;  ///< where the asset has them

  explicit Tables(const run::Asset& asset)
      : meshes(asset.meshes().begin(), asset.meshes().end()),
        groups(asset.groups().begin(), asset.groups().end()),
        nodes(asset.nodes().begin(), asset.nodes().end()) {}

  /// Nothing for sections that stay.
  [[nodiscard]] std::span<const std::uint8_t> bytes_of(const format::SectionEntry& section) const {
    const auto bytes = [](const auto& records) {
      return std::span(reinterpret_cast<const std::uint8_t*>(records.data()), records.size() * sizeof(records[0]));
    };
    if (section.id == static_cast<std::uint32_t>(format::SectionId::kMeshes)) return bytes(meshes);
    if (section.id == static_cast<std::uint32_t>(format::SectionId::kGroups)) return bytes(groups);
    if (section.id == static_cast<std::uint32_t>(format::SectionId::kNodes)) return bytes(nodes);
    if (section.id == static_cast<std::uint32_t>(format::SectionId::kPageHints)) return bytes(page_hints);
    return {};
  }
};

/// Where some of the mesh is an aggregate, all of it has to be.
Result<bool> is_aggregate(const builder::LodDag& dag) {
  std::size_t replaced = 0, aggregates = 0;
  for (const builder::DagGroup& group : dag.groups) {
    replaced += group.is_terminal ? 0 : 1;
    aggregates += group.is_aggregate ? 1 : 0;
  }
  if (aggregates == 0 || aggregates == replaced) return aggregates != 0;
  return Error{ErrorCode::kUnsupported, {}, "some of it is an aggregate, some is not: build it with the tier"};
}

/// Sets the errors of the DAG's groups. The writer moves vertices of needles, or does not (--grid): what explains level
/// 0 is what it did.
Status measure_dag(const format::MeshRecord& record, const scene::SourceMesh& source,
                   const builder::AttributeLayout& layout, format::ErrorTier tier, builder::LodDag& dag) {
  TRY_LET(aggregate, is_aggregate(dag));
  const bool needs_source = tier != format::ErrorTier::kQem && !*aggregate && !dag.triangles.empty();
  builder::PrepareOptions options;
  options.frame = builder::GridFrame{{record.origin[0], record.origin[1], record.origin[2]},
                                     {record.grid.log2, record.grid.mantissa}};
  Status status = Ok{};
  for (const bool separates : {true, false}) {
    options.separates_needles = separates;
    TRY_LET(mesh, builder::prepare_mesh(source, layout, options));
    if (!needs_source) {
      const auto form = builder::canonical_form(*mesh, dag);
      status = form ? builder::measure(*mesh, tier, dag) : Status(form.error());
    } else {
      status = builder::measure(*mesh, tier, dag);
    }
    if (status || status.error().code != ErrorCode::kCheckFailed) break;
  }
  return status;
}

Status measure_mesh(const run::Asset& asset, MeshId id, const scene::SourceMesh& source, format::ErrorTier tier,
                    Tables& tables) {
  format::MeshRecord& record = tables.meshes[id.value];
  TRY_LET(layout, layout_of(record));
  TRY_LET(dag, read_dag(asset, id, *layout));
  if (const Status measured = measure_dag(record, source, *layout, tier, *dag); !measured) return measured;

  record.error_tier = tier;
  const std::vector<float> errors = builder::nest_errors(*dag);
  for (std::uint32_t g = 0; g < record.group_count; ++g) {
    builder::put_errors(dag->groups[g], errors[g], tables.groups[record.first_group + g]);
  }
  const std::span nodes = std::span(tables.nodes).subspan(record.first_node, record.node_count);
  const auto first_of = [&](const format::NodeRecord& node) {
    return node.child_count == 0 ? record.first_group : record.first_node;
  };
  for (format::NodeRecord& node : nodes) node.first -= first_of(node);  // ids per mesh, for a while
  builder::set_node_errors(errors, nodes);
  for (format::NodeRecord& node : nodes) node.first += first_of(node);
  return Ok{};
}

/// How its pages are stored: as it says, or else as they are. Strips in the place of what is not written any more.
format::Codec codec_of(const run::Asset& asset, const MetaInfo& meta) {
  auto codec = value_in(format::kCodecNames, meta.codec);
  for (std::size_t p = 0; !codec && p < asset.pages().size(); ++p) {
    if (asset.pages()[p].codec != format::Codec::kNone) codec = asset.pages()[p].codec;
  }
  if (!codec) return format::Codec::kNone;
  return format::is_written(*codec) ? *codec : format::Codec::kStrips;
}

}  // namespace

Result<std::vector<std::uint8_t>> measure_asset(const run::Asset& asset, const scene::Scene& given,
                                                format::ErrorTier tier) {
  TRY(run::check_decoded_bytes(asset, run::count_decoded_bytes(asset)));
  if (!asset.promises().empty()) {
    return Error{ErrorCode::kUnsupported, "promises",
                 "the asset keeps more than positions, and what it keeps depends on the tier: build it with the tier"};
  }
  const std::optional<scene::Scene> split = judge::split_source(asset, given);
  const scene::Scene& source = split ? *split : given;
  if (asset.meshes().size() != source.meshes.size()) {
    return Error{ErrorCode::kCheckFailed,
                 {},
                 "the asset has " + std::to_string(asset.meshes().size()) + " meshes, the source " +
                     std::to_string(source.meshes.size())};
  }
  Tables tables(asset);
  for (std::size_t m = 0; m < source.meshes.size(); ++m) {
    const Status measured = measure_mesh(asset, MeshId(m), source.meshes[m], tier, tables);
    if (measured) continue;
    const std::string& place = measured.error().where;
    return Error{measured.error().code, "mesh " + std::to_string(m) + (place.empty() ? "" : ", " + place),
                 measured.error().detail};
  }
  for (std::size_t p = 0; p < asset.page_hints().size(); ++p) {
    const format::PageRecord& page = asset.pages()[p];
    tables.page_hints.push_back(
        format::make_page_hint(std::span(tables.groups).subspan(page.first_group, page.group_count)));
  }
  const format::Codec codec = codec_of(asset, read_meta(asset.meta_json()));
  return rewrite_asset(asset, {codec, builder::meta_with_codec(builder::meta_with_tier(asset.meta_json(), tier), codec),
                               [&](const format::SectionEntry& section) { return tables.bytes_of(section); }});
}

}  // namespace meshlode::app
