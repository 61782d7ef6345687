// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/rules.h"

#include <array>
#include <cstdio>
#include <utility>

namespace meshlode::judge {

namespace {

#define RULE(id, invariant, text)     \
  RuleInfo {                          \
    Rule::k##id, #id, invariant, text \
  }
constexpr std::array kRules{
    // container
    RULE(L001, "I11", "the file starts with a whole header of the right magic, version and size"),
    RULE(L002, "I11", "file_bytes is the size of the file"),
    RULE(L003, "", "header flags are zero"),
    RULE(L004, "I11", "the section table lies inside the file, aligned, with a known stride"),
    RULE(L005, "I11", "the header checksum covers header and section table"),
    RULE(L006, "I11", "every section lies inside the file on a multiple of 16"),
    RULE(L007, "I11", "sections follow the section table in its order, without overlap"),
    RULE(L008, "I11", "each section id occurs once, and every section of version 1 is there"),
    RULE(L009, "I11",
         "unknown sections are not required ones; flags, version, codec and reserved field are as specified"),
    RULE(L010, "I11", "section checksums match"),
    RULE(L011, "I11", "stride, count and size of a table agree with the records of version 1"),
    RULE(L012, "I10", "the content hash is the hash of the decoded content"),
    RULE(L013, "", "SCNE is a UTF-8 JSON object, and META too unless it is empty; what META has is of its type"),
    RULE(L014, "", "between sections lie the fewest zero bytes that align the next, and none behind the last"),
    RULE(L099, "I11", "the reader accepts what these rules accept"),
    // tables
    RULE(L101, "I11", "string references lie inside the string table and are UTF-8"),
    RULE(L102, "", "enumerated values are known ones"),
    RULE(L103, "",
         "reserved fields and unused entries are zero; the version is 2 exactly where a group is an aggregate's"),
    RULE(L104, "I11", "a mesh's origin, grid and bounds are finite, in range and ordered"),
    RULE(L105, "", "diagonal and level-0 deviation are finite, not negative and of the grid's size"),
    RULE(L106, "", "normal scale, UV sets, colour flag, material and sphere unit are in range and agree"),
    RULE(L107, "I11", "meshes partition the groups"),
    RULE(L108, "I11", "meshes partition the clusters"),
    RULE(L109, "I11", "meshes partition the BVH nodes"),
    RULE(L110, "I11", "groups name their mesh and partition its clusters"),
    RULE(L111, "I11", "ids in clusters, instances and pages name something of the same mesh"),
    RULE(L112, "", "material values are finite, flags are 0 or 1"),
    RULE(L113, "", "an instance's scale is its largest singular value and its flags mirrored and singular are right"),
    RULE(L114, "I11", "blobs fill the blob section in order and match their checksums"),
    RULE(L115, "", "level_count is the number of levels"),
    RULE(L116, "I1", "source triangles are those of level 0 plus those dropped, by kind"),
    RULE(L117, "I11",
         "what is promised besides positions has a record of each mesh and group, with lengths for units, or is not "
         "there"),
    // pages
    RULE(L201, "I2", "pages partition groups and clusters in order, and groups name their page"),
    RULE(L202, "I11", "pages fill the page section in order, each on the next multiple of 16"),
    RULE(L203, "I11", "page checksums match, stored and decoded"),
    RULE(L204, "I2", "a page decodes to its stated size, a multiple of 4 of at most 128 KiB"),
    RULE(L205, "I11",
         "a page's header matches the page table, and the data of its clusters follow each other without gaps"),
    RULE(L206, "I11", "counts in a page's cluster equal those of its record"),
    RULE(L207, "", "every field of a cluster has as few bits as its values need, and its minimum is reached"),
    RULE(L208, "I11", "heads, ranges and streams lie inside the page, in order, with bit counts that the format has"),
    RULE(L209, "I11", "a reference in a strip names a vertex that was named before"),
    RULE(L210, "", "a cluster has as many fresh slots as vertices: each is used by a triangle"),
    RULE(L211, "I11", "material ranges name materials, ascending, and cover the triangles once"),
    RULE(L212, "I11", "decoded integers are in the range of their attribute"),
    RULE(L213, "", "a page's dependencies are exactly the pages of the coarser clusters made from its groups"),
    RULE(L214, "", "unused bits and padding in a page are zero"),
    RULE(L215, "I3", "a stored normal has the one pair of values that its direction has in its chart"),
    RULE(L216, "I1", "the strips of a cluster start in order, each with a left turn"),
    RULE(L217, "",
         "page hints, where a file has them, are one for each page: a sphere that contains the LOD spheres of its "
         "groups, and their largest and smallest error"),
    // DAG
    RULE(L301, "I5", "level-0 clusters and no others lack an own group"),
    RULE(L302, "I5", "a cluster's coarser group is the group that lists it"),
    RULE(L303, "I5", "a cluster's level is its own group's level plus one: the DAG has no cycle"),
    RULE(L304, "", "a group's level is the largest of its members, and groups are stored from coarse to fine"),
    RULE(L305, "I5",
         "a group is terminal if and only if its error is infinite; stuck only with a reason, and terminal"),
    RULE(L306, "I5", "every group that is not terminal has coarser clusters, and no terminal one has: no cut is empty"),
    RULE(L307, "I4", "errors are finite numbers, never negative, and grow strictly along the DAG except from 0 to 0"),
    RULE(L308, "I4", "LOD spheres are finite and contain those of the finer groups, in exact arithmetic"),
    RULE(L309, "I4", "LOD spheres and errors keep the margin that covers the rounding of the run-time rule"),
    RULE(L310, "I4",
         "LOD spheres contain the culling spheres of level-0 members and of the clusters made from them, exactly"),
    RULE(L311, "I4",
         "quadric errors never fall along the DAG; deviations are as the tier says, and no error is below its group's "
         "times "
         "META's error_margin"),
    RULE(L312, "I4",
         "normal and UV deviations never fall along the DAG; infinite where terminal, and measured for all or none"),
    RULE(L313, "I4",
         "promised errors are infinite exactly where the group's is, never below it nor appearance below texels, and "
         "grow along the DAG with the margin"),
    // hierarchy
    RULE(L401, "I8",
         "a mesh's BVH is one tree: children after their parent, at most 8, each node reached once, 64 deep at most"),
    RULE(L402, "I8", "every group is in exactly one leaf"),
    RULE(L403, "I8", "a node's sphere contains those below it with the margin; a leaf's is its group's, bit for bit"),
    RULE(L404, "I8",
         "a node's error bounds those below it and is infinite exactly where one is; a leaf's is its group's"),
    // geometry
    RULE(L501, "I2",
         "a cluster has 1 to 256 triangles and 1 to 256 vertices, at most three per triangle; a group has a cluster"),
    RULE(L502, "I8", "culling spheres contain their vertices, in exact arithmetic"),
    RULE(L503, "I8", "normal cones hold every triangle's normal, in exact arithmetic"),
    RULE(L504, "", "the mesh's bounds are those of level 0"),
    RULE(L505, "I1", "grid_collapsed counts level 0's triangles without area"),
    RULE(L506, "I3",
         "corners of a border edge that a group shares have attributes that its finer set has in their place"),
    RULE(L507, "I6", "a group's coarser set has the border edges of its finer set, except where the source is open"),
    RULE(L508, "I6", "triangles above level 0 have three distinct corner positions"),
    RULE(L509, "", "the coarser set of a group has the materials of its finer set alone"),
    // verify
    RULE(V101, "I1", "every source triangle is in exactly one level-0 cluster, with its material and orientation"),
    RULE(V102, "I1", "triangles dropped as degenerate or duplicate are counted correctly"),
    RULE(V103, "I1", "source counts, mesh names and diagonals are the source's"),
    RULE(V104, "I3", "level-0 attributes are those of the source within their quantization"),
    RULE(V105, "", "the level-0 deviation is the largest move of a vertex onto the grid, rounded up"),
    RULE(V106, "", "materials are the source's"),
    RULE(V107, "", "instances are the source's, and their transforms"),
    RULE(V108, "", "the source hash in META is the source's"),
    RULE(V109, "", "images and buffers are the source's bytes, or images what the settings make of them"),
    RULE(V110, "",
         "normals, UV sets and colours that the source's shading needs are stored, unless left out by option"),
    RULE(V111, "I2", "clusters keep the caps of the settings"),
    RULE(V112, "I7", "a mesh's error tier is that of the settings"),
    RULE(V113, "",
         "what V104 and V105 hold level 0 to is within the accuracy budgets of the settings; UV budgets in texels are "
         "held "
         "against the images of the source, and a set so large that 24 bits leave no finer step is within any"),
    RULE(V114, "I6", "where lock_borders is set, every vertex of the source's open border is in every cut"),
    RULE(V115, "",
         "the asset accounts for as many triangles as the source's file has by its size (binary STL), and for at least "
         "as many as it has faces (text STL, OBJ, PLY), counted without the importer"),
    RULE(V201, "I5", "a cut draws each piece of surface exactly once and is never empty"),
    RULE(V202, "I6", "the border of a cut consists of edges of the source's border alone"),
    RULE(V203, "I8", "hierarchy traversal selects what the flat rule selects"),
    RULE(V204, "I5", "the selection is the one the rule gives in double precision, but for rounding"),
    RULE(V205, "I5", "a uniform cut's stored error is its largest selected error, or level 0's deviation"),
    RULE(V206, "I7", "a uniform cut deviates from the source by no more than it stores (measured: within 5%)"),
    RULE(V207, "I6", "where keep_topology is set, no cut has more edges of more than two triangles than level 0"),
    RULE(
        V208, "I7",
        "a uniform cut of an aggregate covers what level 0 covers: pixels of its error's size within 22%, all together "
        "within 2%, their contrast at most 1.25 times"),
    RULE(V209, "I7",
         "what is promised of texels or appearance holds: a uniform cut is no farther from the source, UVs or normals "
         "counted as lengths, than it stores (within 5%, `certified` exactly)"),
    RULE(V210, "I7",
         "what UVs and normals count as in promises is the mean size of a texel times the texture's sides, and an "
         "eighth "
         "of the diagonal"),
    RULE(V211, "I7",
         "from a camera each pixel of the source's picture and of the cut's shows a mesh and material that the other "
         "picture has within the allowed pixels and 1.5, but for 1% of them"),
    RULE(V212, "I5",
         "`--stream`: whichever pages are resident, the cut is closed and drawn from them, as fine as they allow, with "
         "all of them the rule's, off by no more than it shows, and the pages that a finer one needs are requested"),
    // verify --gpu
    RULE(V401, "I9", "`--gpu`: the device decodes every cluster to the CPU's integers"),
    RULE(V402, "I8", "`--gpu`: the device's traversal selects what the flat rule selects"),
    RULE(V403, "I9", "`--gpu`: the device's software rasterizer draws the CPU's ids and depths, each pixel"),
    RULE(V404, "I9", "`--gpu`: frustum and occlusion culling change no pixel"),
    RULE(V405, "I7",
         "`--gpu`: no pixel's surface point, of the cut's picture or of the source's own triangles, is displaced "
         "by more than the allowed pixels (measured: within 5%); with `--promise` UVs or normals counted as lengths"),
    RULE(V406, "I6", "`--gpu`: no background is seen through the cut of closed meshes"),
    RULE(V409, "I9", "`--gpu`: hardware raster is held within a stated distance of the CPU's coverage and depth"),
    RULE(V410, "I9",
         "`--stream --gpu`: from a pool of pages the device selects, requests and draws what the CPU does, each frame"),
};

#undef RULE

constexpr std::size_t index_of(Rule rule) {
  return static_cast<std::size_t>(rule);
}

constexpr bool is_each_in_its_row() {
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    if (index_of(kRules[i].rule) != i || (i > 0 && kRules[i].id <= kRules[i - 1].id)) return false;
  }
  return kRules.size() == index_of(Rule::kV410) + 1;
}
static_assert(is_each_in_its_row(), "the table has the rules of enum Rule, in its order");

}  // namespace

std::span<const RuleInfo> all_rules() {
  return kRules;
}

const RuleInfo& info_of(Rule rule) {
  return kRules[index_of(rule)];
}

Finding make_finding(Rule rule, std::string where, std::string detail) {
  const RuleInfo& info = info_of(rule);
  return {std::string(info.id), std::string(info.invariant), std::move(where), std::move(detail)};
}

RuleLog::RuleLog() : counts_(kRules.size(), 0), checked_(kRules.size(), false) {}

void RuleLog::check(Rule rule) {
  checked_[index_of(rule)] = true;
}

void RuleLog::add(Rule rule, std::string where, std::string detail) {
  checked_[index_of(rule)] = true;
  ++finding_count_;
  if (counts_[index_of(rule)]++ < kMaxFindingsPerRule) {
    findings_.push_back(make_finding(rule, std::move(where), std::move(detail)));
  }
}

std::uint64_t RuleLog::count_of(Rule rule) const {
  return counts_[index_of(rule)];
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
