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
};

constexpr std::array<Words, scene::kFaultNames.size()> kWords{{
    {FaultKind::kNotFinite, "vertices that are infinite or no number",
     "mend the exporter; build --repair drops triangles at such positions"},
    {FaultKind::kDegenerate, "triangles without area", "remove them, or build with --repair"},
    {FaultKind::kDuplicate, "triangles on the points of another one",
     "remove the copies; where both sides are meant, make the material double-sided"},
    {FaultKind::kNonManifold, "edges of more than two triangles",
     "take sheets that meet apart, or remove the inner one; build --repair cuts there"},
    {FaultKind::kMisoriented, "edges whose two triangles face opposite sides",
     "recalculate normals outside in the modelling program, or build with --repair"},
    {FaultKind::kUnweldedSeam, "border points that are nearly another one",
     "merge vertices by distance: the gap opens as the two borders are simplified apart"},
    {FaultKind::kNeedles, "triangles more than 100 times longer than high",
     "remesh or triangulate anew: their normals are noise, and collapses turn them over"},
    {FaultKind::kErrorInFew, "triangles that hold half of the error and more",
     "look at them first: spikes, stray vertices and slivers keep the rest fine"},
    {FaultKind::kFarFromOrigin, "vertices where floats are too coarse for the edges",
     "move the mesh to its own origin and the distance into its node"},
    {FaultKind::kSplitNormals, "wedges that a normal splits and no angle justifies",
     "shade smooth, with sharp edges by angle, and export again"},
    {FaultKind::kUvIslands, "UV islands",
     "unwrap into fewer islands, or sew those that lie side by side: every seam is locked and stored twice"},
    {FaultKind::kMissingUvs, "primitives whose material samples texture coordinates that they have not",
     "unwrap them, or give them a material without textures"},
    {FaultKind::kUnusedUvs, "UV sets that no texture is sampled with", "remove them from the export"},
    {FaultKind::kManyMaterials, "materials of one mesh", "join materials in an atlas, or split the mesh by material"},
    {FaultKind::kSmallMeshes, "meshes of one cluster, drawn as they are at any distance",
     "merge meshes that lie together and share materials"},
    {FaultKind::kUndrawnMeshes, "meshes that no node draws", "remove them: they are built all the same"},
    {FaultKind::kUnsampledImages, "images that no material samples",
     "remove them: they are carried through as they are"},
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

std::string detail_of(const scene::Fault& fault) {
  std::string text;
  const std::string count = grouped_digits(fault.count), triangles = grouped_digits(fault.triangle_count);
  const char *n = count.c_str(), *t = triangles.c_str();
  switch (fault.kind) {
    case FaultKind::kNotFinite: append_format(text, "%s vertices, %s triangles at them", n, t); break;
    case FaultKind::kDegenerate: append_format(text, "%s triangles", n); break;
    case FaultKind::kDuplicate:
      append_format(text, "%s triangles, %s of them facing the other way", n,
                    grouped_digits(whole(fault.measure)).c_str());
      break;
    case FaultKind::kNonManifold:
      append_format(text, "%s edges of up to %.0f triangles, %s triangles at them", n, fault.measure, t);
      break;
    case FaultKind::kMisoriented: append_format(text, "%s edges, %s triangles to turn", n, t); break;
    case FaultKind::kUnweldedSeam:
      append_format(text, "%s points, gaps of up to %.3g, %s triangles at them", n, fault.measure, t);
      break;
    case FaultKind::kNeedles:
      append_format(text, "%s triangles, the worst %.3g times longer than high", n, fault.measure);
      break;
    case FaultKind::kErrorInFew:
      append_format(text, "%s triangles, a thousandth, hold %.0f%% of the error", n, 100.0 * fault.measure);
      break;
    case FaultKind::kFarFromOrigin:
      append_format(text, "%s vertices, floats there are %.3g apart", n, fault.measure);
      break;
    case FaultKind::kSplitNormals:
      append_format(text, "%s wedges too many on %s points", n, grouped_digits(whole(fault.measure)).c_str());
      break;
    case FaultKind::kUvIslands:
      append_format(text, "%s islands on %s piece(s) of surface, %s triangles at seams", n,
                    grouped_digits(whole(fault.measure)).c_str(), t);
      break;
    case FaultKind::kMissingUvs: append_format(text, "%s primitive(s), %s triangles", n, t); break;
    case FaultKind::kUnusedUvs: append_format(text, "%s set(s) of primitives", n); break;
    case FaultKind::kManyMaterials: append_format(text, "%s materials, %s triangles where two meet", n, t); break;
    case FaultKind::kSmallMeshes:
      append_format(text, "%s mesh(es) with %s triangles, drawn %s times", n, t,
                    grouped_digits(whole(fault.measure)).c_str());
      break;
    case FaultKind::kUndrawnMeshes: append_format(text, "%s mesh(es) with %s triangles", n, t); break;
    case FaultKind::kUnsampledImages: append_format(text, "%s image(s)", n); break;
  }
  if (fault.mesh == kNoId && !fault.meshes.empty()) {
    text += ": mesh";
    for (const std::uint32_t mesh : fault.meshes) text += " " + std::to_string(mesh);
    if (fault.count > fault.meshes.size()) text += " …";
  }
  return text;
}

std::uint64_t triangles_of(const scene::SourceMesh& mesh) {
  std::uint64_t count = 0;
  for (const scene::Primitive& primitive : mesh.primitives) count += primitive.indices.size() / 3;
  return count;
}

std::uint64_t triangles_of(const scene::Scene& scene) {
  std::uint64_t count = 0;
  for (const scene::SourceMesh& mesh : scene.meshes) count += triangles_of(mesh);
  return count;
}

out::DiagnosisPlace place_of(const scene::Scene& scene, const scene::Fault& fault, std::uint64_t all_triangles) {
  out::DiagnosisPlace place;
  double weight = 1.0;
  place.where = "scene";
  if (fault.mesh != kNoId) {
    const scene::SourceMesh& mesh = scene.meshes[fault.mesh];
    place.mesh = fault.mesh;
    place.where = "mesh " + std::to_string(fault.mesh) + " '" + printable(mesh.name) + "'";
    weight = all_triangles == 0 ? 0.0 : static_cast<double>(triangles_of(mesh)) / static_cast<double>(all_triangles);
  }
  place.count = fault.count;
  place.triangle_count = fault.triangle_count;
  place.detail = detail_of(fault);
  place.share = fault.costs.empty() ? 0.0 : weight * fault.costs[0].share;
  for (const scene::FaultTriangle& one : fault.triangles) place.triangles.push_back({one.primitive, one.triangle});
  for (const scene::FaultCost& cost : fault.costs) {
    place.costs.push_back({name_of(cost.kind), cost.amount, name_of(cost.unit)});
  }
  return place;
}

}  // namespace

std::vector<std::string> source_fault_ids() {
  return all_names(scene::kFaultNames);
}

std::vector<out::Diagnosis> diagnose_scene(const scene::Scene& scene) {
  std::vector<out::Diagnosis> diagnoses;
  const std::uint64_t all = triangles_of(scene);
  for (const scene::Fault& fault : scene::examine_scene(scene)) {
    out::Diagnosis words;
    words.id = name_of(fault.kind);
    words.title = words_of(fault.kind).title;
    words.remedy = words_of(fault.kind).remedy;
    out::add_place(diagnoses, words, place_of(scene, fault, all));
  }
  out::rank(diagnoses);
  return diagnoses;
}

out::DoctorReport report_on_scene(const scene::Scene& scene) {
  out::DoctorReport report;
  report.meshes = scene.meshes.size();
  report.triangles = triangles_of(scene);
  report.diagnoses = diagnose_scene(scene);
  return report;
}

}  // namespace meshlode::cli
