// SPDX-License-Identifier: GPL-3.0-or-later
#include "doctor_words.h"

#include <array>
#include <cstdint>
#include <utility>

#include "base/append_format.h"
#include "base/printable.h"
#include "scene/detect/detect.h"
#include "scene/detect/fault.h"

namespace meshlode::cli {

namespace {

using scene::FaultKind;

struct Words {
  FaultKind kind;
  const char *title, *remedy;
  const char* hard_case = "";  ///< of docs/reference/hard-cases.md
};

constexpr std::array<Words, scene::kFaultNames.size()> kWords{{
    {FaultKind::kNothingToDraw, "scene with nothing left to draw",
     "check the exporter's settings and what was left out; its asset is empty, and build --strict refuses it"},
    {FaultKind::kMissing, "triangles that are in the file but not in the scene",
     "export the file again, or fix the faces that are named as left out; build --strict refuses it"},
    {FaultKind::kNotFinite, "vertices with an infinity or what is not a number",
     "fix the exporter; build --repair drops triangles at such positions", "nan"},
    {FaultKind::kDegenerate, "triangles without area",
     "merge vertices by distance and dissolve such faces; build --repair removes those with two corners in one place",
     "repeated"},
    {FaultKind::kDuplicate, "triangles with the same corners as another one",
     "delete the copies; if both sides should be visible, make the material double-sided", "repeated"},
    {FaultKind::kNonManifold, "edges of more than two triangles",
     "separate the sheets that meet there, or delete inner faces; build --repair splits them", "book"},
    {FaultKind::kMisoriented, "edges whose two triangles face opposite sides",
     "recalculate normals to the outside in the modelling program, or build with --repair", "mixed-winding"},
    {FaultKind::kUnweldedSeam, "border points that almost coincide with another one",
     "merge vertices by a distance just above the gaps; otherwise the borders are simplified separately and the gaps "
     "open"},
    {FaultKind::kNeedles, "triangles more than 100 times longer than high",
     "remesh or triangulate again: their normals are noise, and collapses flip them", "needles"},
    {FaultKind::kErrorInFew, "triangles, 0.1% of all, that cause half of the error or more",
     "check them first: a spike or a stray vertex there costs as much as the rest of the surface"},
    {FaultKind::kFarFromOrigin, "vertices so far from the origin that float steps are large compared with the edges",
     "move the mesh to its own origin, and the distance into the translation of its node", "far-floats"},
    {FaultKind::kFinerThanGrid, "triangles that vanish on the position grid: the mesh is too large for them",
     "give fine parts a mesh of their own, delete them, or build with a smaller --position-error", "two-sizes"},
    {FaultKind::kSplitNormals, "vertices that normals split although the surface is smooth",
     "shade smooth, with sharp edges by angle, and export again"},
    {FaultKind::kUvIslands, "UV islands, many more than pieces of the surface",
     "unwrap into fewer islands, or sew those that lie side by side: vertices at seams are stored twice, and seams "
     "hold up simplification"},
    {FaultKind::kMissingUvs, "primitives without the texture coordinates that their material samples",
     "unwrap them, or give them a material without textures"},
    {FaultKind::kUnusedUvs, "UV sets that no texture uses", "leave them out of the export: assets do not store them"},
    {FaultKind::kManyMaterials, "materials of one mesh", "join materials in an atlas, or split the mesh by material"},
    {FaultKind::kSmallMeshes, "meshes of one cluster, drawn as they are at any distance",
     "merge meshes that lie together and share materials"},
    {FaultKind::kUndrawnMeshes, "meshes that no node of the scene draws", "delete them: they are built anyway"},
    {FaultKind::kUnsampledImages, "images that no material samples",
     "delete them unless an extension needs them: assets carry them anyway"},
}};

const Words& words_of(FaultKind kind) {
  for (const Words& words : kWords) {
    if (words.kind == kind) return words;
  }
  return kWords[0];  // every kind is in the table: a test holds it
}

std::uint64_t whole(double figure) {
  return static_cast<std::uint64_t>(figure);
}

std::string short_of(double figure) {
  std::string text;
  append_format(text, "%.3g", figure);
  return text;
}

/// What was counted, and the figure that goes with it (FaultKind says which).
std::string detail_of(const scene::Fault& fault) {
  const auto count = [&](const char* many) { return app::counted(fault.count, many); };
  const auto measured = [&](const char* many) { return app::counted(whole(fault.measure), many); };
  const std::string triangles = app::counted(fault.triangle_count, "triangles");
  switch (fault.kind) {
    case FaultKind::kNothingToDraw:
      return fault.triangle_count == 0 ? "no triangle" : triangles + ", none with an area";
    case FaultKind::kMissing: return count("triangles") + " of " + measured("triangles") + " in the file";
    case FaultKind::kNotFinite: return count("vertices") + ", " + triangles + " at them";
    case FaultKind::kDegenerate: return triangles;
    case FaultKind::kDuplicate:
      return triangles + ", " + grouped_digits(whole(fault.measure)) + " of them facing the other way";
    case FaultKind::kNonManifold:
      return count("edges") + " of up to " + measured("triangles") + ", " + triangles + " at them";
    case FaultKind::kMisoriented: return count("edges") + ", " + triangles + " to turn";
    case FaultKind::kUnweldedSeam:
      return count("points") + ", gaps of up to " + short_of(fault.measure) + ", " + triangles + " at them";
    case FaultKind::kNeedles: return triangles + ", the worst " + short_of(fault.measure) + " times longer than high";
    case FaultKind::kErrorInFew: return triangles + " with " + short_of(100.0 * fault.measure) + "% of the error";
    case FaultKind::kFarFromOrigin:
      return count("vertices") + ", floats there are " + short_of(fault.measure) + " apart";
    case FaultKind::kFinerThanGrid: return triangles + ", on a grid of " + short_of(fault.measure);
    case FaultKind::kSplitNormals: return count("vertices") + " too many on " + measured("points");
    case FaultKind::kUvIslands:
      return count("islands") + " on " + measured("pieces") + " of surface, " + triangles + " at seams";
    case FaultKind::kMissingUvs: return count("primitives") + " of " + triangles;
    case FaultKind::kUnusedUvs: return count("sets");
    case FaultKind::kManyMaterials: return count("materials") + ", " + triangles + " where two meet";
    case FaultKind::kSmallMeshes:
      return count("meshes") + " of " + triangles + ", drawn " + grouped_digits(whole(fault.measure)) + " times";
    case FaultKind::kUndrawnMeshes: return count("meshes") + " of " + triangles;
    case FaultKind::kUnsampledImages: return count("images");
  }
  return {};
}

/// Those of a fault of the scene, by number.
std::string list_meshes(const scene::Fault& fault) {
  if (fault.meshes.empty()) return {};
  std::string text = fault.count == 1 ? ": mesh" : ": meshes";
  for (const std::uint32_t mesh : fault.meshes) text += " " + std::to_string(mesh);
  return text + (fault.count > fault.meshes.size() ? " …" : "");
}

std::uint64_t triangles_of(const scene::Scene& scene) {
  std::uint64_t count = 0;
  for (const scene::SourceMesh& mesh : scene.meshes) count += scene::triangles_of(mesh);
  return count;
}

app::DiagnosisPlace place_of(const scene::Scene& scene, const scene::Fault& fault, std::uint64_t all_triangles) {
  app::DiagnosisPlace place;
  double weight = 1.0;
  place.where = "scene";
  if (fault.mesh != kNoId) {
    const scene::SourceMesh& mesh = scene.meshes[fault.mesh];
    place.mesh = fault.mesh;
    place.where = app::mesh_words(fault.mesh, mesh.name);
    weight =
        all_triangles == 0 ? 0.0 : static_cast<double>(scene::triangles_of(mesh)) / static_cast<double>(all_triangles);
  }
  place.count = fault.count;
  place.triangle_count = fault.triangle_count;
  place.detail = detail_of(fault) + (fault.mesh == kNoId ? list_meshes(fault) : "");
  place.share = fault.costs.empty() ? 0.0 : weight * fault.costs[0].share;
  for (const scene::FaultTriangle& one : fault.triangles) place.triangles.push_back({one.primitive, one.triangle});
  for (const scene::FaultCost& cost : fault.costs) {
    place.costs.push_back({name_of(cost.kind), cost.amount, name_of(cost.unit)});
  }
  return place;
}

}  // namespace

const char* hard_case_of(FaultKind kind) {
  return words_of(kind).hard_case;
}

std::vector<std::string> source_fault_ids() {
  std::vector<std::string> ids = all_names(scene::kFaultNames);
  ids.emplace_back(app::kLeftOutId);
  return ids;
}

std::vector<app::Diagnosis> diagnose_scene(const scene::Scene& scene) {
  std::vector<app::Diagnosis> diagnoses;
  const std::uint64_t all = triangles_of(scene);
  for (const scene::Fault& fault : scene::examine_scene(scene)) {
    app::Diagnosis words;
    words.id = name_of(fault.kind);
    words.title = words_of(fault.kind).title;
    words.remedy = words_of(fault.kind).remedy;
    words.hard_case = hard_case_of(fault.kind);
    app::add_place(diagnoses, words, place_of(scene, fault, all));
  }
  for (const scene::LeftOut& left : scene.left_out) app::add_left_out(diagnoses, left.what, left.why);
  app::rank(diagnoses);
  return diagnoses;
}

app::DoctorReport report_on_scene(const scene::Scene& scene) {
  app::DoctorReport report;
  report.meshes = scene.meshes.size();
  report.triangles = triangles_of(scene);
  report.diagnoses = diagnose_scene(scene);
  return report;
}

}  // namespace meshlode::cli
