// SPDX-License-Identifier: GPL-3.0-or-later
// Every rule of validate has a file that breaks it, and the sample breaks none.
#include <algorithm>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "judge/validate/edit.h"
#include "judge/validate/judged_sample.h"
#include "judge/validate/rules.h"
#include "judge/validate/validate.h"
#include "support/reseal.h"

namespace meshlode::judge {
namespace {

using format::SectionId;
using test::AssetEdit;
namespace head = format::head;

const std::vector<std::uint8_t>& sample() {
  static const std::vector<std::uint8_t> bytes = test::judged_sample_bytes();
  return bytes;
}

std::string describe(const ValidationReport& report) {
  std::string text;
  for (const Finding& f : report.findings) text += f.id + ": " + f.where + ": " + f.detail + "\n";
  return text;
}

bool has(const ValidationReport& report, const std::string& id) {
  return std::any_of(report.findings.begin(), report.findings.end(), [&](const Finding& f) { return f.id == id; });
}

TEST(Validate, FindsNothingInTheSample) {
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                    format::Codec::kStrips, format::Codec::kDraco}) {
    const ValidationReport report = validate_asset(test::judged_sample_bytes(codec));
    EXPECT_EQ(report.finding_count, 0U) << describe(report);
  }
}

TEST(Validate, FindsNothingInBytesThatLieUnaligned) {
  std::vector<std::uint8_t> shifted(sample().size() + 1);
  std::copy(sample().begin(), sample().end(), shifted.begin() + 1);
  const ValidationReport report = validate_asset(std::span(shifted).subspan(1));
  EXPECT_EQ(report.finding_count, 0U) << describe(report);
}

TEST(Validate, RunsEveryStructuralRuleOnASoundFile) {
  const ValidationReport report = validate_asset(sample());
  for (const RuleInfo& rule : all_rules()) {
    if (rule.id[0] != 'L') continue;
    EXPECT_NE(std::find(report.checked.begin(), report.checked.end(), rule.id), report.checked.end()) << rule.id;
  }
}

TEST(Validate, SealingAnUnchangedFileChangesNothing) {
  AssetEdit edit(sample());
  edit.seal();
  EXPECT_EQ(edit.bytes(), sample());
}

/// Attribute deviations as a build would measure them: they grow with the level. Sound by themselves.
void set_attribute_deviations(AssetEdit& edit) {
  for (std::size_t g = 0; g < edit.groups().size(); ++g) {
    edit.group(g, [](auto& r) {
      if ((r.flags & format::kGroupTerminal) != 0) return;
      r.normal_deviation = r.uv_deviation = 1.0F + static_cast<float>(r.level);
    });
  }
}

TEST(Validate, FindsNothingInMeasuredAttributeDeviations) {
  AssetEdit edit(sample());
  set_attribute_deviations(edit);
  edit.seal();
  const ValidationReport report = validate_asset(edit.bytes());
  EXPECT_EQ(report.finding_count, 0U) << describe(report);
}

TEST(Validate, KeepsFewFindingsAndCountsAll) {
  AssetEdit edit(sample());
  const std::size_t count = edit.clusters().size();
  for (std::size_t c = 0; c < count; ++c) edit.cluster(c, [](auto& r) { r.radius = 0; });
  edit.seal();
  const ValidationReport report = validate_asset(edit.bytes());
  const auto kept =
      std::count_if(report.findings.begin(), report.findings.end(), [](const Finding& f) { return f.id == "L502"; });
  EXPECT_EQ(kept, std::min<std::ptrdiff_t>(kMaxFindingsPerRule, static_cast<std::ptrdiff_t>(count)));
  EXPECT_GE(report.finding_count, count);
}

struct Break {
  const char* rule;
  const char* what;
  std::function<void(AssetEdit&)> change;
  bool seal = true;
};

/// The first group of the mesh that is not terminal, and a terminal one with something below it.
std::uint32_t inner_group(const AssetEdit& edit) {
  const auto groups = edit.groups();
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    if ((groups[g].flags & format::kGroupTerminal) == 0) return g;
  }
  return format::kNone;
}

/// A group of level 0 that shares its border with others.
std::uint32_t shared_group(const AssetEdit& edit) {
  const auto groups = edit.groups();
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    if ((groups[g].flags & format::kGroupTerminal) == 0 && groups[g].level == 0) return g;
  }
  return format::kNone;
}

std::uint32_t cluster_above(const AssetEdit& edit, std::uint32_t group) {
  const auto clusters = edit.clusters();
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].own_group == group) return c;
  }
  return format::kNone;
}

std::uint32_t level0_cluster(const AssetEdit& edit) {
  const auto clusters = edit.clusters();
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].own_group == format::kNone) return c;
  }
  return format::kNone;
}

std::uint32_t inner_node(const AssetEdit& edit) {
  const auto nodes = edit.nodes();
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].child_count > 0) return n;
  }
  return format::kNone;
}

std::uint32_t leaf_node(const AssetEdit& edit) {
  const auto nodes = edit.nodes();
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].child_count == 0) return n;
  }
  return format::kNone;
}

AssetEdit promised() {
  return AssetEdit(test::judged_sample_bytes(format::Codec::kNone, true));
}

/// What is promised of a mesh, changed.
template <class Change>
void promise(AssetEdit& e, std::uint64_t mesh, const Change& change) {
  e = promised();
  e.change_at<format::PromiseMeshRecord>(e.offset_of<format::PromiseMeshRecord>(SectionId::kPromises, mesh), change);
}

/// The same of a group that is not terminal.
template <class Change>
void promised_error(AssetEdit& e, const Change& change) {
  e = promised();
  e.change_at<format::PromiseGroupRecord>(
      e.offset_of<format::PromiseGroupRecord>(SectionId::kPromiseErrors, inner_group(e)), change);
}

/// The hint of a page that has a group which is not terminal, changed.
template <class Change>
void hint(AssetEdit& e, const Change& change) {
  e = promised();
  const std::uint32_t page = e.groups()[inner_group(e)].page;
  e.change_at<format::PageHintRecord>(e.offset_of<format::PageHintRecord>(SectionId::kPageHints, page), change);
}

TEST(Validate, FindsNothingInPromises) {
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kStrips}) {
    const ValidationReport report = validate_asset(test::judged_sample_bytes(codec, true));
    EXPECT_EQ(report.finding_count, 0U) << describe(report);
  }
}

const std::vector<Break>& breaks() {
  static const std::vector<Break> all{
      {"L001", "wrong magic", [](AssetEdit& e) { e.header([](auto& h) { h.magic ^= 1U; }); }},
      {"L001", "version 0", [](AssetEdit& e) { e.header([](auto& h) { h.version = 0; }); }},
      {"L001", "version 3", [](AssetEdit& e) { e.header([](auto& h) { h.version = 3; }); }},
      {"L001", "longer header", [](AssetEdit& e) { e.header([](auto& h) { h.header_bytes = 72; }); }},
      {"L001", "truncated to nothing", [](AssetEdit& e) { e.bytes().resize(63); }, false},
      {"L002", "a byte more", [](AssetEdit& e) { e.bytes().push_back(0); }},
      {"L003", "header flag", [](AssetEdit& e) { e.header([](auto& h) { h.flags = 1; }); }},
      {"L004", "table outside", [](AssetEdit& e) { e.header([](auto& h) { h.section_table_offset = 1ULL << 60; }); },
       false},
      {"L004", "too many sections", [](AssetEdit& e) { e.header([](auto& h) { h.section_count = 0x7FFFFFFF; }); },
       false},
      {"L004", "stride", [](AssetEdit& e) { e.header([](auto& h) { h.section_entry_bytes = 72; }); }},
      {"L005", "header checksum", [](AssetEdit& e) { e.header([](auto& h) { h.header_checksum ^= 1U; }); }, false},
      {"L006", "section outside",
       [](AssetEdit& e) { e.entry(SectionId::kMeta, [](auto& s) { s.offset = ~0ULL - 15; }); }},
      {"L006", "section unaligned", [](AssetEdit& e) { e.entry(SectionId::kScene, [](auto& s) { s.offset += 1; }); }},
      {"L007", "sections overlap",
       [](AssetEdit& e) {
         const auto at = e.section(SectionId::kScene).offset;
         e.entry(SectionId::kMeta, [&](auto& s) { s.offset = at; });
       }},
      {"L008", "section twice",
       [](AssetEdit& e) {
         e.entry(SectionId::kBlobs, [](auto& s) { s.id = static_cast<std::uint32_t>(SectionId::kMeshes); });
       }},
      {"L008", "section missing",
       [](AssetEdit& e) {
         e.entry(SectionId::kNodes, [](auto& s) {
           s.id = 77;
           s.flags = 0;
         });
       }},
      {"L009", "unknown required",
       [](AssetEdit& e) {
         e.entry(SectionId::kNodes, [](auto& s) {
           s.id = 77;
           s.flags = 1;
         });
       }},
      {"L009", "section codec", [](AssetEdit& e) { e.entry(SectionId::kMeta, [](auto& s) { s.codec = 2; }); }},
      {"L009", "section version", [](AssetEdit& e) { e.entry(SectionId::kMeta, [](auto& s) { s.version = 3; }); }},
      {"L010", "section checksum", [](AssetEdit& e) { e.entry(SectionId::kGroups, [](auto& s) { s.checksum ^= 1U; }); },
       false},
      {"L011", "stride", [](AssetEdit& e) { e.entry(SectionId::kMeshes, [](auto& s) { s.record_bytes = 208; }); }},
      {"L011", "count", [](AssetEdit& e) { e.entry(SectionId::kMeshes, [](auto& s) { s.record_count += 1; }); }},
      {"L012", "content hash",
       [](AssetEdit& e) {
         e.header([](auto& h) { h.content_hash[3] ^= 1U; });
         test::reseal(e.bytes());
       },
       false},
      {"L013", "META is no JSON", [](AssetEdit& e) { e.bytes()[e.section(SectionId::kMeta).offset] = 'x'; }},
      {"L013", "SCNE is no UTF-8", [](AssetEdit& e) { e.bytes()[e.section(SectionId::kScene).offset + 1] = 0xFF; }},
      {"L101", "name outside", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.name.bytes = 0xFFFFFFF0U; }); }},
      {"L102", "normal mode",
       [](AssetEdit& e) { e.mesh(2, [](auto& m) { m.normal_mode = static_cast<format::NormalMode>(9); }); }},
      {"L102", "tier",
       [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.error_tier = static_cast<format::ErrorTier>(3); }); }},
      {"L102", "alpha mode",
       [](AssetEdit& e) { e.material(0, [](auto& m) { m.alpha_mode = static_cast<format::AlphaMode>(3); }); }},
      {"L103", "an unused UV set", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.uv_log2[3] = 1; }); }},
      {"L103", "group flags", [](AssetEdit& e) { e.group(0, [](auto& g) { g.flags |= 8U; }); }},
      {"L103", "version 2 without an aggregate",
       [](AssetEdit& e) { e.header([](auto& h) { h.version = format::kVersion; }); }},
      {"L103", "an aggregate in version 1",
       [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.flags |= format::kGroupAggregate; }); }},
      {"L305", "a terminal aggregate",
       [](AssetEdit& e) {
         e.header([](auto& h) { h.version = format::kVersion; });
         e.group(0, [](auto& g) { g.flags |= format::kGroupAggregate; });
       }},
      {"L104", "origin not finite",
       [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.origin[1] = std::numeric_limits<double>::quiet_NaN(); }); }},
      {"L104", "grid of no step", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.grid.mantissa = 0; }); }},
      {"L105", "negative diagonal", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.diagonal = -1.0; }); }},
      {"L105", "diagonal shorter than the bounds", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.diagonal *= 0.5; }); }},
      {"L105", "deviation beyond the grid",
       [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.level0_deviation = 1e9F; }); }},
      {"L106", "normal scale", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.normal_scale = 8192; }); }},
      {"L106", "material", [](AssetEdit& e) { e.mesh(1, [](auto& m) { m.material = 99; }); }},
      {"L106", "sphere unit", [](AssetEdit& e) { e.mesh(1, [](auto& m) { m.sphere_log2 = 105; }); }},
      {"L106", "five UV sets", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.uv_set_count = 5; }); }},
      {"L107", "groups not partitioned", [](AssetEdit& e) { e.mesh(1, [](auto& m) { m.first_group += 1; }); }},
      {"L108", "clusters not partitioned", [](AssetEdit& e) { e.mesh(1, [](auto& m) { m.cluster_count -= 1; }); }},
      {"L109", "nodes not partitioned", [](AssetEdit& e) { e.mesh(1, [](auto& m) { m.node_count += 1; }); }},
      {"L110", "group of another mesh", [](AssetEdit& e) { e.group(0, [](auto& g) { g.mesh = 1; }); }},
      {"L110", "groups overlap", [](AssetEdit& e) { e.group(0, [](auto& g) { g.cluster_count += 1; }); }},
      {"L111", "coarser group of no mesh",
       [](AssetEdit& e) { e.cluster(0, [](auto& c) { c.coarser_group = 0xFFFFFFF0U; }); }},
      {"L111", "instance of no mesh", [](AssetEdit& e) { e.instance(0, [](auto& i) { i.mesh = 99; }); }},
      {"L112", "colour not finite",
       [](AssetEdit& e) { e.material(0, [](auto& m) { m.base_color[2] = std::numeric_limits<float>::quiet_NaN(); }); }},
      {"L113", "scale too small", [](AssetEdit& e) { e.instance(0, [](auto& i) { i.scale *= 0.999; }); }},
      {"L113", "mirror mark",
       [](AssetEdit& e) { e.instance(0, [](auto& i) { i.flags ^= format::kInstanceMirrored; }); }},
      {"L113", "singular mark",
       [](AssetEdit& e) { e.instance(0, [](auto& i) { i.flags ^= format::kInstanceSingular; }); }},
      {"L114", "blob outside", [](AssetEdit& e) { e.blob(0, [](auto& b) { b.bytes = 1ULL << 50; }); }},
      {"L114", "blob checksum", [](AssetEdit& e) { e.bytes()[e.blobs()[0].offset] ^= 1U; }, false},
      {"L115", "level count", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.level_count += 1; }); }},
      {"L116", "source triangles", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.source_triangles += 1; }); }},
      {"L116", "a drop that was not", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.dropped_duplicate += 1; }); }},
      {"L201", "group of another page", [](AssetEdit& e) { e.page(0, [](auto& p) { p.group_count += 1; }); }},
      {"L202", "page outside", [](AssetEdit& e) { e.page(0, [](auto& p) { p.offset -= 16; }); }},
      {"L203", "page checksum", [](AssetEdit& e) { e.bytes()[e.pages()[0].offset + e.pages()[0].bytes - 1] ^= 1U; },
       false},
      {"L204", "sizes differ", [](AssetEdit& e) { e.page(0, [](auto& p) { p.bytes -= 1; }); }},
      {"L204", "packed bytes are none",
       [](AssetEdit& e) { e.page(0, [](auto& p) { p.codec = format::Codec::kZstd; }); }},
      {"L205", "page names other clusters", [](AssetEdit& e) { e.bytes()[e.pages()[0].offset] ^= 1U; }},
      {"L205", "data word",
       [](AssetEdit& e) { e.put_head(0, format::head::kDataWord, e.head(0, format::head::kDataWord) + 1); }},
      {"L206", "triangle count", [](AssetEdit& e) { e.cluster(0, [](auto& c) { c.triangles_less_1 -= 1; }); }},
      {"L206", "vertex count",
       [](AssetEdit& e) { e.put_head(0, format::head::kVerticesLess1, e.head(0, format::head::kVerticesLess1) - 1); }},
      {"L207", "a bit that no vertex needs",
       [](AssetEdit& e) {
         // The largest value of an axis loses its top bit.
         const std::uint32_t top = 1U << (e.place_of(0, 0, 0).count - 1);
         for (std::uint32_t v = 0; v < e.clusters()[0].vertex_count(); ++v) {
           e.put_stored(0, v, 0, e.stored(0, v, 0) & ~top);
         }
       }},
      {"L208", "25 bits", [](AssetEdit& e) { e.put_head(0, format::head::kBits[1], 25); }},
      {"L208", "a chart that is none", [](AssetEdit& e) { e.put_head(0, format::head::kChart, 6); }},
      {"L208", "an axis that is none", [](AssetEdit& e) { e.put_head(0, format::head::kShearAxis, 3); }},
      {"L208", "beyond the page",
       [](AssetEdit& e) {
         // The last cluster of the sphere's page: all its axes claim as many bits as there are.
         const auto page = e.pages()[1];
         const auto c = page.first_cluster + page.cluster_count - 1;
         for (const auto& field : format::head::kBits) e.put_head(c, field, 24);
       }},
      {"L208", "UV ranges cover too much",
       [](AssetEdit& e) { e.put_field(0, e.layout(0).uv_word[0], format::uv_range::kVerticesLess1, 255); }},
      {"L209", "a reference to what was not named",
       [](AssetEdit& e) {
         const auto at = e.layout(0);
         e.put_page_bits(0, at.reference_bit, at.reference_bits, 0xFFU);
       }},
      {"L210", "a vertex too few",
       [](AssetEdit& e) {
         const auto at = e.layout(0);
         std::uint32_t slot = at.slot_count;
         while (e.page_bits(0, at.fresh_bit + slot - 1, 1) == 0) --slot;
         e.put_page_bits(0, at.fresh_bit + slot - 1, 1, 0);
       }},
      {"L211", "no such material",
       [](AssetEdit& e) { e.put_field(0, e.layout(0).material_word, format::material_range::kMaterial, 99); }},
      {"L211", "ranges cover too much",
       [](AssetEdit& e) { e.put_field(0, e.layout(0).material_word, format::material_range::kTrianglesLess1, 255); }},
      {"L212", "beyond 24 bits", [](AssetEdit& e) { e.put_head(0, format::head::kMinimum[0], (1 << 23) - 1); }},
      {"L212", "normal out of range",
       [](AssetEdit& e) { e.put_head(0, format::head::kNormalMinimumA, (1 << 14) - 1); }},
      {"L212", "UV out of range", [](AssetEdit& e) { e.move_minimum(0, 5, 1 << 25); }},
      {"L215", "a normal by another name",
       [](AssetEdit& e) {
         // The vertex with the largest second value gets the pair (-1, M): A is 0 there, so its one name is (1, M).
         const auto m = static_cast<std::int32_t>(e.meshes()[0].normal_scale);
         std::int32_t a = 0;
         std::int32_t b = -1;
         for (std::uint32_t v = 0; v < e.clusters()[0].vertex_count(); ++v) {
           const auto value = static_cast<std::int32_t>(e.stored(0, v, 4));
           if (value > b) a = static_cast<std::int32_t>(e.stored(0, v, 3));
           b = std::max(b, value);
         }
         e.put_head(0, format::head::kNormalMinimumA, m - 1 - a);
         e.put_head(0, format::head::kNormalMinimumB, 2 * m - b);
       }},
      {"L216", "a strip starts with a right turn",
       [](AssetEdit& e) { e.put_page_bits(0, e.layout(0).turn_bit, 1, 1); }},
      {"L216", "more strips than triangles", [](AssetEdit& e) { e.put_head(0, format::head::kStripsLess1, 255); }},
      {"L301", "level 0 with an own group",
       [](AssetEdit& e) {
         const auto c = level0_cluster(e);
         e.cluster(c, [](auto& r) { r.level = 1; });
       }},
      {"L301", "orphan",
       [](AssetEdit& e) {
         const auto c = cluster_above(e, inner_group(e));
         e.cluster(c, [](auto& r) { r.own_group = format::kNone; });
       }},
      {"L302", "member of another group",
       [](AssetEdit& e) {
         const auto g = inner_group(e);
         const auto c = level0_cluster(e);
         e.cluster(c, [&](auto& r) { r.coarser_group = r.coarser_group == g ? g + 1 : g; });
       }},
      {"L303", "level too high",
       [](AssetEdit& e) {
         const auto c = cluster_above(e, inner_group(e));
         e.cluster(c, [](auto& r) { r.level += 1; });
       }},
      {"L304", "group level", [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.level += 1; }); }},
      {"L305", "terminal with a finite error", [](AssetEdit& e) { e.group(0, [](auto& g) { g.error = 1.0F; }); }},
      {"L305", "stuck without a reason",
       [](AssetEdit& e) { e.group(0, [](auto& g) { g.flags |= format::kGroupStuck; }); }},
      {"L306", "nothing above",
       [](AssetEdit& e) {
         const auto g = inner_group(e);
         const auto clusters = e.clusters();
         for (std::uint32_t c = 0; c < clusters.size(); ++c) {
           if (clusters[c].own_group == g) e.cluster(c, [&](auto& r) { r.own_group = g + 1; });
         }
       }},
      {"L307", "error falls", [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.error = 0.0F; }); }},
      {"L307", "error is NaN",
       [](AssetEdit& e) {
         e.group(inner_group(e), [](auto& g) { g.error = std::numeric_limits<float>::quiet_NaN(); });
       }},
      {"L307", "error is negative", [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.error = -1.0F; }); }},
      {"L308", "sphere shrunk", [](AssetEdit& e) { e.group(0, [](auto& g) { g.radius *= 0.5F; }); }},
      {"L308", "sphere moved", [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.center[1] += g.radius; }); }},
      {"L309", "sphere without margin", [](AssetEdit& e) { e.group(0, [](auto& g) { g.radius *= 1.0F - 0x1p-21F; }); }},
      {"L310", "level 0 sticks out",
       [](AssetEdit& e) { e.cluster(level0_cluster(e), [](auto& c) { c.radius = 65535; }); }},
      {"L311", "quadric error falls",
       [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.quadric_error = -1.0F; }); }},
      {"L311", "measured in the qem tier",
       [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.deviation = 0.25F; }); }},
      {"L312", "normal deviation falls",
       [](AssetEdit& e) {
         set_attribute_deviations(e);
         e.group(inner_group(e), [](auto& g) { g.normal_deviation = 0.5F; });
       }},
      {"L312", "UV deviation falls",
       [](AssetEdit& e) {
         set_attribute_deviations(e);
         e.group(inner_group(e), [](auto& g) { g.uv_deviation = 0.5F; });
       }},
      {"L312", "a root with a normal deviation",
       [](AssetEdit& e) { e.group(0, [](auto& g) { g.normal_deviation = 1.0F; }); }},
      {"L312", "UV deviation of one group alone",
       [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.uv_deviation = 1.0F; }); }},
      {"L312", "normal deviation is negative",
       [](AssetEdit& e) { e.group(inner_group(e), [](auto& g) { g.normal_deviation = -0.0F; }); }},
      {"L117", "one of its sections alone",
       [](AssetEdit& e) {
         e = promised();
         // Not required: a reader that does not know the id skips it.
         e.entry(SectionId::kPromiseErrors, [](auto& s) { s.id = format::four_cc('P', 'R', 'M', 'X'); });
       }},
      {"L117", "an unknown promise", [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.promises |= 4; }); }},
      {"L117", "no promise", [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.promises = 0; }); }},
      {"L117", "promises of one mesh", [](AssetEdit& e) { promise(e, 1, [](auto& p) { p.promises = 1; }); }},
      {"L117", "a negative unit", [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.normal_object = -1.0F; }); }},
      {"L117", "a unit along one axis", [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.uv_object[0][1] = 0.0F; }); }},
      {"L117", "a unit of no set",
       [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.uv_object[3][0] = p.uv_object[3][1] = 1.0F; }); }},
      {"L117", "level 0 below its deviation",
       [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.level0_texels = -1.0F; }); }},
      {"L117", "level 0 below its texels",
       [](AssetEdit& e) { promise(e, 0, [](auto& p) { p.level0_texels = 2.0F * p.level0_appearance + 1.0F; }); }},
      {"L217", "a hint fewer than pages",
       [](AssetEdit& e) {
         e = promised();
         e.entry(SectionId::kPageHints, [](auto& s) { s.record_count -= 1, s.bytes -= 32, s.decoded_bytes -= 32; });
       }},
      {"L217", "a sphere that is too small", [](AssetEdit& e) { hint(e, [](auto& h) { h.radius *= 0.99F; }); }},
      {"L217", "a sphere elsewhere", [](AssetEdit& e) { hint(e, [](auto& h) { h.center[1] += h.radius; }); }},
      {"L217", "an error below its groups", [](AssetEdit& e) { hint(e, [](auto& h) { h.largest_error *= 0.99F; }); }},
      {"L217", "a smallest error that none has",
       [](AssetEdit& e) { hint(e, [](auto& h) { h.smallest_error *= 0.5F; }); }},
      {"L103", "a hint with more", [](AssetEdit& e) { hint(e, [](auto& h) { h.reserved[1] = 1; }); }},
      {"L313", "texels below positions",
       [](AssetEdit& e) { promised_error(e, [](auto& p) { p.texel_error *= 0.9F; }); }},
      {"L313", "appearance below texels",
       [](AssetEdit& e) { promised_error(e, [](auto& p) { p.appearance_error *= 0.9F; }); }},
      {"L313", "infinite and not terminal",
       [](AssetEdit& e) { promised_error(e, [](auto& p) { p.appearance_error = format::kInfiniteError; }); }},
      {"L313", "a terminal one is finite",
       [](AssetEdit& e) {
         e = promised();
         e.change_at<format::PromiseGroupRecord>(e.section(SectionId::kPromiseErrors).offset,
                                                 [](auto& p) { p.appearance_error = 1.0F; });
       }},
      {"L313", "a finer one is above a coarser one",
       [](AssetEdit& e) {
         e = promised();
         const std::uint32_t finer = e.clusters()[cluster_above(e, shared_group(e))].own_group;
         e.change_at<format::PromiseGroupRecord>(
             e.offset_of<format::PromiseGroupRecord>(SectionId::kPromiseErrors, finer),
             [](auto& p) { p.appearance_error = 1e30F; });
       }},
      {"L401", "child before its parent",
       [](AssetEdit& e) {
         const auto n = inner_node(e);
         e.node(n, [&](auto& r) { r.first = n; });
       }},
      {"L401", "nine children", [](AssetEdit& e) { e.node(inner_node(e), [&](auto& r) { r.child_count = 9; }); }},
      {"L402", "group left out", [](AssetEdit& e) { e.node(leaf_node(e), [](auto& r) { r.first += 1; }); }},
      {"L403", "node shrunk", [](AssetEdit& e) { e.node(inner_node(e), [](auto& r) { r.radius *= 0.5F; }); }},
      {"L403", "leaf grown", [](AssetEdit& e) { e.node(leaf_node(e), [](auto& r) { r.radius *= 1.001F; }); }},
      {"L404", "node error too small", [](AssetEdit& e) { e.node(inner_node(e), [](auto& r) { r.error = 1e-20F; }); }},
      {"L404", "leaf error grown",
       [](AssetEdit& e) {
         e.node(leaf_node(e), [](auto& r) { r.error = r.error < 1e30F ? r.error * 2.0F + 1.0F : 1.0F; });
       }},
      {"L501", "more vertices than corners",
       [](AssetEdit& e) { e.cluster(0, [](auto& c) { c.vertices_less_1 = 255; }); }},
      {"L502", "culling sphere shrunk by 0.1%",
       [](AssetEdit& e) { e.cluster(0, [](auto& c) { c.radius = static_cast<std::uint16_t>(c.radius * 0.998); }); }},
      {"L503", "cone too narrow", [](AssetEdit& e) { e.cluster(0, [](auto& c) { c.cone_cutoff = -1; }); }},
      {"L504", "bounds", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.bounds_max[0] += 1; }); }},
      {"L505", "collapsed", [](AssetEdit& e) { e.mesh(0, [](auto& m) { m.grid_collapsed += 1; }); }},
      {"L506", "a normal on a shared border",
       [](AssetEdit& e) {
         // The normals of one whole cluster move: every corner on its border changes.
         const auto c = cluster_above(e, shared_group(e));
         e.move_minimum(c, 3, e.minimum(c, 3) > 4 ? -1 : 1);
       }},
      {"L507", "a vertex on a shared border",
       [](AssetEdit& e) { e.move_minimum(cluster_above(e, shared_group(e)), 0, 1); }},
      {"L507", "an aggregate takes a border of others",
       [](AssetEdit& e) {
         e.header([](auto& h) { h.version = format::kVersion; });
         e.group(shared_group(e), [](auto& g) { g.flags |= format::kGroupAggregate; });
         e.move_minimum(cluster_above(e, shared_group(e)), 0, 1);
       }},
      {"L507", "a turn the other way",
       [](AssetEdit& e) {
         const auto c = cluster_above(e, shared_group(e));
         const auto at = e.layout(c);
         e.put_page_bits(c, at.turn_bit + 1, 1, 1U - e.page_bits(c, at.turn_bit + 1, 1));
       }},
      {"L508", "two corners in one place",
       [](AssetEdit& e) {
         // The triangle of the first reference that can name the slot before it.
         const auto c = cluster_above(e, shared_group(e));
         const auto at = e.layout(c);
         std::uint32_t reference = 0;
         for (std::uint32_t s = 3; s < at.slot_count; ++s) {
           if (e.page_bits(c, at.fresh_bit + s, 1) != 0) continue;
           const bool fresh_before = e.page_bits(c, at.fresh_bit + s - 1, 1) != 0;
           if (fresh_before) {
             e.put_page_bits(c, at.reference_bit + reference * at.reference_bits, at.reference_bits, 0);
             return;
           }
           ++reference;
         }
       }},
      {"L509", "a material from nowhere",
       [](AssetEdit& e) {
         // A cluster of level 0 in the patch says it has the other material: what replaces it has both.
         const auto patch = e.meshes()[0];
         const auto clusters = e.clusters();
         for (std::uint32_t c = patch.first_cluster; c < patch.first_cluster + patch.cluster_count; ++c) {
           if (clusters[c].own_group == format::kNone) continue;
           const auto word = e.layout(c).material_word;
           const auto material = e.field(c, word, format::material_range::kMaterial);
           e.put_field(c, word, format::material_range::kMaterial, 1 - material);
         }
       }},
  };
  return all;
}

TEST(Validate, EachBreakIsFoundByItsRule) {
  for (const Break& broken : breaks()) {
    AssetEdit edit(sample());
    broken.change(edit);
    if (broken.seal) edit.seal();
    const ValidationReport report = validate_asset(edit.bytes());
    EXPECT_TRUE(has(report, broken.rule)) << broken.rule << ", " << broken.what << "; found:\n" << describe(report);
  }
}

TEST(Validate, EachRuleHasABreak) {
  std::set<std::string> broken;
  for (const Break& b : breaks()) broken.insert(b.rule);
  // L014 and L214 have tests below; L213 needs several pages (tests/mutation); L099 is for what should not be: a reader
  // stricter than these rules.
  for (const char* id : {"L014", "L099", "L213", "L214"}) broken.insert(id);
  for (const RuleInfo& rule : all_rules()) {
    EXPECT_TRUE(rule.id[0] != 'L' || broken.contains(std::string(rule.id))) << rule.id;
  }
}

TEST(Validate, BytesBetweenSectionsAreZero) {
  AssetEdit edit(sample());
  const auto meta = edit.section(SectionId::kMeta);
  const std::uint64_t gap = meta.offset + meta.bytes;
  if (gap % 16 == 0) {  // the sample's META ends on a boundary: make it one byte shorter and keep it JSON
    edit.entry(SectionId::kMeta, [](auto& s) {
      s.bytes -= 1;
      s.decoded_bytes -= 1;
    });
    edit.seal();
    EXPECT_TRUE(has(validate_asset(edit.bytes()), "L014"));
    return;
  }
  edit.bytes()[gap] = 1;
  edit.seal();
  EXPECT_TRUE(has(validate_asset(edit.bytes()), "L014"));
}

TEST(Validate, UnnamedBitsOfAPageAreZero) {
  const auto expect_found = [](const char* what, const std::function<void(AssetEdit&)>& change) {
    AssetEdit edit(sample());
    change(edit);
    edit.seal();
    EXPECT_TRUE(has(validate_asset(edit.bytes()), "L214")) << what;
  };
  expect_found("head, word 2", [](AssetEdit& e) { e.put_head(0, {2, 31, 1, false}, 1); });
  expect_found("head, word 3", [](AssetEdit& e) { e.put_head(0, {3, 29, 3, false}, 4); });
  expect_found("UV range", [](AssetEdit& e) { e.put_field(0, e.layout(0).uv_word[0], {0, 29, 3, false}, 1); });
  expect_found("the page's last word", [](AssetEdit& e) {
    const auto page = e.pages()[0];
    e.bytes()[page.offset + page.bytes - 4] = 1;
  });
  const auto sphere = AssetEdit(sample()).meshes()[1].first_cluster;
  expect_found("colour range", [&](AssetEdit& e) {
    e.put_field(sphere, e.layout(sphere).color_word, {1, 16, 16, false}, 1);
  });
  AssetEdit edit(sample());
  std::uint32_t c = 0;
  while (edit.layout(c).end_bit % 32 == 0) ++c;
  expect_found("behind a stream", [&](AssetEdit& e) { e.put_page_bits(c, e.layout(c).end_bit, 1, 1); });
}

TEST(Validate, NoTruncationPasses) {
  for (std::size_t size = 0; size < sample().size(); size += size < 4096 ? 1 : 37) {
    const ValidationReport report = validate_asset(std::span(sample()).first(size));
    ASSERT_GT(report.finding_count, 0U) << size;
  }
}

TEST(Validate, NoFlippedByteOutsidePaddingPasses) {
  std::vector<std::uint8_t> bytes = sample();
  for (std::size_t i = 0; i < bytes.size(); i += 1 + i / 997) {
    bytes[i] ^= 0x10U;
    EXPECT_GT(validate_asset(bytes).finding_count, 0U) << "byte " << i;
    bytes[i] ^= 0x10U;
  }
}

#ifdef MESHLODE_SOURCE_DIR
TEST(Validate, DocumentListsEveryRule) {
  std::ifstream file(std::string(MESHLODE_SOURCE_DIR) + "/docs/reference/rules.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const RuleInfo& rule : all_rules()) {
    const std::string row = "| " + std::string(rule.id) + " | " +
                            (rule.invariant.empty() ? "" : std::string(rule.invariant) + " ") + "| " +
                            std::string(rule.text) + " |";
    EXPECT_NE(text.str().find(row), std::string::npos) << row;
  }
}
#endif

}  // namespace
}  // namespace meshlode::judge
