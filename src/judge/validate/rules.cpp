// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/rules.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdio>

namespace meshlode::judge {

namespace {

constexpr std::array kRules{
    // container
    Rule{"L001", "I11", "the file starts with a whole header of the right magic, version and size"},
    Rule{"L002", "I11", "file_bytes is the size of the file"},
    Rule{"L003", "", "header flags are zero"},
    Rule{"L004", "I11", "the section table lies inside the file, aligned, with a known stride"},
    Rule{"L005", "I11", "the header checksum covers header and section table"},
    Rule{"L006", "I11", "every section lies inside the file on a multiple of 16"},
    Rule{"L007", "I11", "sections follow the section table in its order, without overlap"},
    Rule{"L008", "I11", "each section id occurs once, and every section of version 1 is there"},
    Rule{"L009", "I11",
         "unknown sections are not required ones; flags, version, codec and reserved field are as specified"},
    Rule{"L010", "I11", "section checksums match"},
    Rule{"L011", "I11", "stride, count and size of a table agree with the records of version 1"},
    Rule{"L012", "I10", "the content hash is the hash of the decoded content"},
    Rule{"L013", "", "SCNE is a UTF-8 JSON object, and META too unless it is empty; what META has is of its type"},
    Rule{"L014", "", "between sections lie the fewest zero bytes that align the next, and none behind the last"},
    Rule{"L099", "I11", "the reader accepts what these rules accept"},
    // tables
    Rule{"L101", "I11", "string references lie inside the string table and are UTF-8"},
    Rule{"L102", "", "enumerated values are known ones"},
    Rule{"L103", "", "reserved fields and unused entries are zero"},
    Rule{"L104", "I11", "a mesh's origin, grid and bounds are finite, in range and ordered"},
    Rule{"L105", "", "diagonal and level-0 deviation are finite, not negative and of the grid's size"},
    Rule{"L106", "", "normal scale, UV sets, colour flag, material and sphere unit are in range and agree"},
    Rule{"L107", "I11", "meshes partition the groups"},
    Rule{"L108", "I11", "meshes partition the clusters"},
    Rule{"L109", "I11", "meshes partition the BVH nodes"},
    Rule{"L110", "I11", "groups name their mesh and partition its clusters"},
    Rule{"L111", "I11", "ids in clusters, instances and pages name something of the same mesh"},
    Rule{"L112", "", "material values are finite, flags are 0 or 1"},
    Rule{"L113", "", "an instance's scale is its largest singular value and its flags mirrored and singular are right"},
    Rule{"L114", "I11", "blobs fill the blob section in order and match their checksums"},
    Rule{"L115", "", "level_count is the number of levels"},
    Rule{"L116", "I1", "source triangles are those of level 0 plus those dropped, by kind"},
    // pages
    Rule{"L201", "I2", "pages partition groups and clusters in order, and groups name their page"},
    Rule{"L202", "I11", "pages fill the page section in order, each on the next multiple of 16"},
    Rule{"L203", "I11", "page checksums match, stored and decoded"},
    Rule{"L204", "I2", "a page decodes to its stated size, a multiple of 4 of at most 128 KiB"},
    Rule{"L205", "I11", "a page's header matches the page table, and the data of its clusters follow each other without gaps"},
    Rule{"L206", "I11", "counts in a page's cluster equal those of its record"},
    Rule{"L207", "", "every field of a cluster has as few bits as its values need, and its minimum is reached"},
    Rule{"L208", "I11", "heads, ranges and streams lie inside the page, in order, with bit counts that the format has"},
    Rule{"L209", "I11", "a reference in a strip names a vertex that was named before"},
    Rule{"L210", "", "a cluster has as many fresh slots as vertices: each is used by a triangle"},
    Rule{"L211", "I11", "material ranges name materials, ascending, and cover the triangles once"},
    Rule{"L212", "I11", "decoded integers are in the range of their attribute"},
    Rule{"L213", "", "a page's dependencies are exactly the pages of the coarser clusters made from its groups"},
    Rule{"L214", "", "unused bits and padding in a page are zero"},
    Rule{"L215", "I3", "a stored normal has the one pair of values that its direction has in its chart"},
    Rule{"L216", "I1", "the strips of a cluster start in order, each with a left turn"},
    // DAG
    Rule{"L301", "I5", "level-0 clusters and no others lack an own group"},
    Rule{"L302", "I5", "a cluster's coarser group is the group that lists it"},
    Rule{"L303", "I5", "a cluster's level is its own group's level plus one: the DAG has no cycle"},
    Rule{"L304", "", "a group's level is the largest of its members, and groups are stored from coarse to fine"},
    Rule{"L305", "I5",
         "a group is terminal if and only if its error is infinite; stuck only with a reason, and terminal"},
    Rule{"L306", "I5",
         "every group that is not terminal has coarser clusters, and no terminal one has: no cut is empty"},
    Rule{"L307", "I4", "errors are finite numbers, never negative, and grow strictly along the DAG except from 0 to 0"},
    Rule{"L308", "I4", "LOD spheres are finite and contain those of the finer groups, in exact arithmetic"},
    Rule{"L309", "I4", "LOD spheres and errors keep the margin that covers the rounding of the run-time rule"},
    Rule{"L310", "I4",
         "LOD spheres contain the culling spheres of level-0 members and of the clusters made from them, exactly"},
    Rule{"L311", "I4",
         "quadric errors never fall along the DAG; deviations are as the tier says, and no error is below its group's times "
         "META's error_margin"},
    Rule{"L312", "I4",
         "normal and UV deviations never fall along the DAG; infinite where terminal, and measured for all or none"},
    // hierarchy
    Rule{"L401", "I8",
         "a mesh's BVH is one tree: children after their parent, at most 8, each node reached once, 64 deep at most"},
    Rule{"L402", "I8", "every group is in exactly one leaf"},
    Rule{"L403", "I8", "a node's sphere contains those below it with the margin; a leaf's is its group's, bit for bit"},
    Rule{"L404", "I8",
         "a node's error bounds those below it and is infinite exactly where one is; a leaf's is its group's"},
    // geometry
    Rule{"L501", "I2",
         "a cluster has 1 to 256 triangles and 1 to 256 vertices, three a triangle at most; a group has a cluster"},
    Rule{"L502", "I8", "culling spheres contain their vertices, in exact arithmetic"},
    Rule{"L503", "I8", "normal cones hold every triangle's normal, in exact arithmetic"},
    Rule{"L504", "", "the mesh's bounds are those of level 0"},
    Rule{"L505", "I1", "grid_collapsed counts level 0's triangles without area"},
    Rule{"L506", "I3",
         "corners of a border edge that a group shares have attributes that its finer set has in their place"},
    Rule{"L507", "I6", "a group's coarser set has the border edges of its finer set, except where the source is open"},
    Rule{"L508", "I6", "triangles above level 0 have three distinct corner positions"},
    Rule{"L509", "", "the coarser set of a group has the materials of its finer set alone"},
    // verify
    Rule{"V101", "I1", "every source triangle is in exactly one level-0 cluster, with its material and orientation"},
    Rule{"V102", "I1", "triangles dropped as degenerate or duplicate are counted correctly"},
    Rule{"V103", "I1", "source counts, mesh names and diagonals are the source's"},
    Rule{"V104", "I3", "level-0 attributes are those of the source within their quantization"},
    Rule{"V105", "", "the level-0 deviation is the largest move of a vertex onto the grid, rounded up"},
    Rule{"V106", "", "materials are the source's"},
    Rule{"V107", "", "instances are the source's, and their transforms"},
    Rule{"V108", "", "the source hash in META is the source's"},
    Rule{"V109", "", "images and buffers are the source's bytes"},
    Rule{"V110", "",
         "normals, UV sets and colours that the source's shading needs are stored, unless left out by option"},
    Rule{"V111", "I2", "clusters keep the caps of the settings"},
    Rule{"V112", "I7", "a mesh's error tier is that of the settings"},
    Rule{"V113", "",
         "what V104 and V105 hold level 0 to is within the accuracy budgets of the settings; UV budgets in texels are held "
         "against the images of the source, and a set so large that 24 bits leave no finer step is within any"},
    Rule{"V201", "I5", "a cut draws each piece of surface exactly once and is never empty"},
    Rule{"V202", "I6", "the border of a cut consists of edges of the source's border alone"},
    Rule{"V203", "I8", "hierarchy traversal selects what the flat rule selects"},
    Rule{"V204", "I5", "the selection is the one the rule gives in double precision, but for rounding"},
    Rule{"V205", "I5", "a uniform cut's stored error is its largest selected error, or level 0's deviation"},
    Rule{"V206", "I7", "a uniform cut deviates from the source by no more than it stores (measured: within 5%)"},
};

std::size_t index_of(std::string_view id) {
  const auto* found = std::lower_bound(kRules.begin(), kRules.end(), id,
                                       [](const Rule& rule, std::string_view key) { return rule.id < key; });
  assert(found != kRules.end() && found->id == id);
  return static_cast<std::size_t>(found - kRules.begin());
}

}  // namespace

std::span<const Rule> all_rules() {
  return kRules;
}

RuleLog::RuleLog() : counts_(kRules.size(), 0), checked_(kRules.size(), false) {}

void RuleLog::check(std::string_view id) {
  checked_[index_of(id)] = true;
}

void RuleLog::add(std::string_view id, std::string where, std::string detail) {
  const std::size_t rule = index_of(id);
  checked_[rule] = true;
  ++finding_count_;
  if (counts_[rule]++ < kMaxFindingsPerRule) {
    findings_.push_back({std::string(id), std::string(kRules[rule].invariant), std::move(where), std::move(detail)});
  }
}

std::uint64_t RuleLog::count_of(std::string_view id) const {
  return counts_[index_of(id)];
}

std::vector<std::string> RuleLog::checked() const {
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    if (checked_[i]) ids.emplace_back(kRules[i].id);
  }
  return ids;
}

std::string place(std::string_view what, std::size_t index) {
  return std::string(what) + " " + std::to_string(index);
}

std::string place(std::string_view what, std::size_t index, std::string_view inner, std::size_t inner_index) {
  return place(what, index) + ", " + place(inner, inner_index);
}

std::string differs(std::string_view a, double x, std::string_view b, double y) {
  char text[64];
  std::string out(a);
  std::snprintf(text, sizeof text, " = %.9g, ", x);
  out += text;
  out += b;
  std::snprintf(text, sizeof text, " = %.9g", y);
  return out + text;
}

std::string differs(std::string_view a, std::uint64_t x, std::string_view b, std::uint64_t y) {
  return std::string(a) + " = " + std::to_string(x) + ", " + std::string(b) + " = " + std::to_string(y);
}

}  // namespace meshlode::judge
