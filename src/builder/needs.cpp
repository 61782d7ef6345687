// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/needs.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "base/byte_size.h"
#include "base/memory.h"
#include "builder/deviation/deviation.h"
#include "builder/plan/count_wedges.h"

namespace meshlode::builder {

namespace {

// Bytes, measured over the models of docs/performance.md: of the program, of a thread, of each byte of the scene's
// document while it is read, of what is kept of a mesh when it is done; and while it is in work of a triangle, of a
// position (a closed surface has half as many as triangles, loose cards twice as many) and of a vertex's attributes.
constexpr std::uint64_t kProcess = 22u << 20u;
constexpr std::uint64_t kThread = 3u << 20u;
constexpr std::uint64_t kDocumentByte = 40;
constexpr std::uint64_t kKeptTriangle = 30;
constexpr std::uint64_t kTriangle = 10;
constexpr std::uint64_t kTriangleOfCertified = 50;
constexpr std::uint64_t kTriangleHeld = 36;       // in the leaves of the source's tree
constexpr std::uint64_t kTrianglePromised = 550;  // both surfaces, their trees and the samples (src/builder/promise)
// Of an aggregate the ways to thin it out, and pictures of them in all views.
constexpr std::uint64_t kAggregate = 12u << 20u;
constexpr std::uint64_t kTriangleOfAggregate = 50;
constexpr std::uint64_t kPosition = 230;
constexpr std::uint64_t kPositionOfQuadric = 180;
constexpr std::uint64_t kVertexFloat = 8;
// Where large arrays go to a file: of a triangle what stays in memory all the same, and what the groups in hand take. A
// quarter of the limit is for the arrays.
constexpr std::uint64_t kUnspilledTriangle = 30;
constexpr std::uint64_t kSpillRoom = 24u << 20u;
constexpr std::uint64_t kLimitOfThread = 128u << 20u;

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

/// Floats of a vertex beside its position, as many as may be kept.
std::uint64_t attribute_floats(const scene::SourceMesh& mesh, const MeshOptions& options) {
  if (options.attributes == AttributeChoice::kNone && options.keep == 0) return 0;
  std::uint64_t floats = 0;
  for (const scene::Primitive& primitive : mesh.primitives) {
    std::uint64_t own = primitive.normals.empty() ? 0 : 3;
    for (const auto& uvs : primitive.uvs) own += uvs.empty() ? 0 : 2;
    own += primitive.colors.empty() ? 0 : 4;
    floats = std::max(floats, own);
  }
  return floats;
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

std::uint64_t MemoryEstimate::bytes(std::size_t at_once) const {
  std::uint64_t sum = always;
  for (std::size_t i = 0; i < std::min(at_once, working.size()); ++i) sum += working[i];
  return sum;
}

MemoryEstimate estimate_memory(const scene::Scene& scene, const PipelineOptions& options, std::uint32_t threads,
                               std::span<const AggregateDecision> aggregates) {
  MemoryEstimate estimate;
  estimate.always = kProcess + kThread * std::max(threads, 1U) + kDocumentByte * scene.document.size();
  estimate.spilled = estimate.always + kSpillRoom;
  for (const scene::SceneBlob& blob : scene.blobs) estimate.always += 2 * bytes_of(blob.bytes);  // and the file's
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const scene::SourceMesh& mesh = scene.meshes[i];
    const MeshOptions& own = options.of_mesh(i);
    const bool is_measured = own.error_tier != format::ErrorTier::kQem;
    const bool is_certified = own.error_tier == format::ErrorTier::kCertified;
    const MeshCounts counts = count_mesh(mesh);
    for (const scene::Primitive& primitive : mesh.primitives) estimate.always += bytes_of(primitive);
    estimate.always += kKeptTriangle * counts.triangles;
    estimate.spilled += kUnspilledTriangle * counts.triangles;
    const std::uint64_t promised = options.promise == format::Promise::kPosition ? 0 : kTrianglePromised;
    const std::uint64_t held = is_measured && counts.triangles <= kMostHeldTriangles ? kTriangleHeld : 0;
    estimate.working.push_back(((is_certified ? kTriangleOfCertified : kTriangle) + held + promised) *
                                   counts.triangles +
                               (is_measured ? kPosition : kPositionOfQuadric) * count_wedges(mesh, {}) +
                               kVertexFloat * attribute_floats(mesh, own) * counts.vertices);
    const bool is_aggregate = i < aggregates.size() && aggregates[i].is_aggregate;
    if (!is_aggregate) continue;
    estimate.working.back() += kAggregate + kTriangleOfAggregate * counts.triangles;
    estimate.spilled += kAggregate + kTriangleOfAggregate * counts.triangles;  // small arrays
  }
  estimate.spilled += estimate.spilled / 3;
  std::sort(estimate.working.begin(), estimate.working.end(), std::greater<>());
  return estimate;
}

std::uint32_t threads_within(const MemoryEstimate& estimate, std::uint32_t threads, std::uint64_t limit) {
  if (estimate.bytes(1) <= limit) return threads;
  const std::uint64_t too_many = (estimate.bytes(1) - limit + kThread - 1) / kThread;
  if (too_many + 2 <= threads) return threads - static_cast<std::uint32_t>(too_many);
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(threads, std::max<std::uint64_t>(2, limit / kLimitOfThread)));
}

Result<std::size_t> fit_memory(const MemoryEstimate& estimate, std::uint32_t threads, const PipelineOptions& options) {
  std::size_t at_once = std::max<std::size_t>(1, std::min<std::size_t>(threads, estimate.working.size()));
  std::uint64_t limit = options.max_memory;
  if (limit == 0) {
    const auto available = available_memory();
    if (!available) return at_once;
    limit = resident_memory() + *available;
  }
  while (at_once > 1 && estimate.bytes(at_once) > limit) --at_once;
  if (estimate.bytes(at_once) <= limit || (options.spills && estimate.spilled <= limit)) return at_once;
  const std::uint64_t needed = options.spills ? std::min(estimate.spilled, estimate.bytes(1)) : estimate.bytes(1);
  return Error{ErrorCode::kBuildFailed, "",
               "the build needs about " + byte_size_text(needed) + " of memory, " + byte_size_text(limit) +
                   (options.max_memory == 0 ? " are available (meshlode --max-memory SIZE keeps to SIZE with a file)"
                                            : " are allowed by --max-memory")};
}

}  // namespace meshlode::builder
