// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/needs.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/byte_size.h"
#include "base/memory.h"
#include "builder/deviation/surface_tree.h"
#include "builder/gap_label.h"
#include "builder/plan/count_wedges.h"
#include "builder/plan/plan.h"

namespace meshlode::builder {

namespace {

// Bytes, measured over the models of docs/log/build-time.md: of the program, of a thread, of each byte of the scene's
// document while it is read, of what is kept of a mesh when it is done; and while it is in work of a triangle, of a
// position (a closed surface has half as many as triangles, loose cards twice as many), of a wedge beside its
// position's first (seams; split at every corner five for each position) and of a vertex's attributes.
constexpr std::uint64_t kProcess = 22u << 20u;
constexpr std::uint64_t kThread = 3u << 20u;
constexpr std::uint64_t kDocumentByte = 40;
constexpr std::uint64_t kKeptTriangle = 30;
constexpr std::uint64_t kTriangle = 10;
constexpr std::uint64_t kTriangleOfCertified = 50;
constexpr std::uint64_t kTriangleHeld = 36;       // in leaves of trees that hold them
constexpr std::uint64_t kTrianglePromised = 950;  // both surfaces, their trees and the samples (src/builder/promise)
// Of an aggregate the ways to thin it out, and pictures of them in all views.
constexpr std::uint64_t kAggregate = 12u << 20u;
constexpr std::uint64_t kTriangleOfAggregate = 50;
constexpr std::uint64_t kPosition = 230;
constexpr std::uint64_t kPositionOfQuadric = 180;
constexpr std::uint64_t kFurtherWedge = 60;
constexpr std::uint64_t kVertexFloat = 8;

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::uint64_t bytes_of(const scene::Primitive& primitive) {
  std::uint64_t sum = bytes_of(primitive.positions) + bytes_of(primitive.normals) + bytes_of(primitive.colors) +
                      bytes_of(primitive.indices);
  for (const auto& uvs : primitive.uvs) sum += bytes_of(uvs);
  return sum;
}

/// What may be kept of a vertex beside its position.
AttributeLayout largest_layout(const scene::SourceMesh& mesh, const MeshOptions& options) {
  AttributeLayout layout;
  if (options.attributes == AttributeChoice::kNone && options.keep == 0) return layout;
  std::array<bool, scene::kMaxUvSets> has_set{};
  for (const scene::Primitive& primitive : mesh.primitives) {
    layout.has_normal = layout.has_normal || !primitive.normals.empty();
    layout.has_color = layout.has_color || !primitive.colors.empty();
    for (std::size_t set = 0; set < has_set.size(); ++set) has_set[set] = has_set[set] || !primitive.uvs[set].empty();
  }
  for (std::size_t set = 0; set < has_set.size(); ++set) {
    if (has_set[set]) layout.uv_set_source[layout.uv_set_count++] = static_cast<std::uint8_t>(set);
  }
  return layout;
}

/// What is needed, for what, and what to do.
Error refuse_memory(const MemoryEstimate& estimate, const scene::Scene& scene, std::uint64_t limit, bool is_asked) {
  std::string text = "the build needs about " + byte_size_text(estimate.bytes(1, 1)) + " of memory";
  if (!estimate.working.empty()) {
    const auto& [bytes, mesh] = estimate.working.front();
    text += ", " + byte_size_text(bytes) + " of it for " + mesh_label(scene.meshes[mesh], mesh) + " of " +
            std::to_string(count_mesh(scene.meshes[mesh]).triangles) + " triangles";
  }
  text += "; " + byte_size_text(limit);
  text += is_asked ? " are allowed by --max-memory: allow more" : " are available: free some";
  return {ErrorCode::kBuildFailed, "", text + ", or split the mesh or the scene"};
}

}  // namespace

MeshCounts count_mesh(const scene::SourceMesh& mesh) {
  const bool has_normals = std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                       [](const scene::Primitive& primitive) { return !primitive.normals.empty(); });
  MeshCounts counts;
  for (const scene::Primitive& primitive : mesh.primitives) {
    counts.triangles += primitive.indices.size() / 3;
    // Beside primitives with normals, one without gets flat ones: a vertex for each corner.
    counts.vertices += has_normals && primitive.normals.empty() ? primitive.indices.size() : primitive.positions.size();
  }
  return counts;
}

Status check_material_count(std::uint64_t count) {
  static_assert(2 * kMaxMaterials <= kMaterialBits);
  if (count <= kMaxMaterials) return Ok{};
  return Error{ErrorCode::kUnsupported, "scene",
               std::to_string(count) + " materials, at most " + std::to_string(kMaxMaterials) + " are built"};
}

Status check_mesh_counts(const MeshCounts& counts, const std::string& mesh) {
  const auto refuse = [&](std::uint64_t count, const char* what, std::uint64_t limit) {
    return Error{ErrorCode::kUnsupported, mesh,
                 std::to_string(count) + " " + what + ", at most " + std::to_string(limit) +
                     " are built into one mesh: split it"};
  };
  if (counts.triangles > kMaxMeshTriangles) return refuse(counts.triangles, "triangles", kMaxMeshTriangles);
  if (counts.vertices > kMaxMeshVertices) return refuse(counts.vertices, "vertices", kMaxMeshVertices);
  return Ok{};
}

std::uint64_t MemoryEstimate::bytes(std::size_t at_once, std::uint32_t threads) const {
  std::uint64_t sum = always + kThread * threads;
  for (std::size_t i = 0; i < std::min(at_once, working.size()); ++i) sum += working[i].bytes;
  return sum;
}

MemoryEstimate estimate_memory(const scene::Scene& scene, const PipelineOptions& options,
                               std::span<const AggregateDecision> aggregates) {
  MemoryEstimate estimate;
  estimate.always = kProcess + kDocumentByte * scene.document.size();
  for (const scene::SceneBlob& blob : scene.blobs) estimate.always += 2 * bytes_of(blob.bytes);  // and the file's
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const scene::SourceMesh& mesh = scene.meshes[i];
    const MeshOptions& own = options.of_mesh(i);
    const bool is_measured = own.error_tier != format::ErrorTier::kQem;
    const bool is_certified = own.error_tier == format::ErrorTier::kCertified;
    const MeshCounts counts = count_mesh(mesh);
    for (const scene::Primitive& primitive : mesh.primitives) estimate.always += bytes_of(primitive);
    estimate.always += kKeptTriangle * counts.triangles;
    const std::uint64_t promised = options.promise == format::Promise::kPosition ? 0 : kTrianglePromised;
    const std::uint64_t held = is_measured && counts.triangles <= SurfaceTree::kFew ? kTriangleHeld : 0;
    const AttributeLayout layout = largest_layout(mesh, own);
    const auto [positions, wedges] = count_wedges(mesh, layout);
    std::uint64_t bytes = ((is_certified ? kTriangleOfCertified : kTriangle) + held + promised) * counts.triangles +
                          (is_measured ? kPosition : kPositionOfQuadric) * positions +
                          kFurtherWedge * (wedges - positions) + kVertexFloat * layout.stride() * counts.vertices;
    const bool is_aggregate = i < aggregates.size() && aggregates[i].is_aggregate;
    if (is_aggregate) bytes += kAggregate + kTriangleOfAggregate * counts.triangles;
    estimate.working.push_back({bytes, i});
  }
  std::stable_sort(estimate.working.begin(), estimate.working.end(),
                   [](const auto& a, const auto& b) { return a.bytes > b.bytes; });
  return estimate;
}

Result<MemoryFit> fit_memory(const MemoryEstimate& estimate, const scene::Scene& scene, std::uint32_t threads,
                             std::uint64_t max_memory) {
  MemoryFit fit;
  fit.threads = std::max(threads, 1U);
  fit.at_once = std::max<std::size_t>(1, std::min<std::size_t>(fit.threads, estimate.working.size()));
  std::uint64_t limit = max_memory;
  if (limit == 0) {
    const auto available = available_memory();
    if (!available) return fit;
    limit = resident_memory() + *available;
  }
  while (fit.at_once > 1 && estimate.bytes(fit.at_once, fit.threads) > limit) --fit.at_once;
  while (fit.threads > 1 && estimate.bytes(1, fit.threads) > limit) --fit.threads;
  if (estimate.bytes(fit.at_once, fit.threads) <= limit) return fit;
  return refuse_memory(estimate, scene, limit, max_memory != 0);
}

}  // namespace meshlode::builder
