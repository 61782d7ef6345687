// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/aggregate_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/disjoint_sets.h"
#include "base/glob.h"
#include "scene/parts/pieces.h"

namespace meshlode::builder {

namespace {

using scene::Piece, scene::Pieces;

constexpr std::uint64_t kFewestPieces = 256;
constexpr std::uint32_t kSmallPiece = 32, kLargestPiece = 512;  // triangles
constexpr double kSmallShare = 0.98;                            // of the triangles are in small pieces
constexpr double kWidestPiece = 0.2;                            // of the mesh's diagonal: the middle one of all pieces

std::uint32_t count_materials(const scene::SourceMesh& mesh) {
  std::uint32_t count = 0;
  for (const scene::Primitive& primitive : mesh.primitives) count = std::max(count, primitive.material.value + 1);
  return count;
}

std::string describe(std::uint64_t pieces, std::uint64_t largest, const std::string& names = {}) {
  return std::to_string(pieces) + " pieces" + names + ", at most " + std::to_string(largest) + " triangles each";
}

/// Pieces together, and whether they are many small ones.
struct Look {
  std::uint64_t count = 0, triangles = 0, in_small = 0, largest = 0;
  Box3d box;
  std::vector<double> widths;

  void add(const Piece& piece) {
    box.add(piece.box);
    ++count;
    triangles += piece.triangles;
    if (piece.triangles <= kSmallPiece) in_small += piece.triangles;
    largest = std::max(largest, piece.triangles);
    widths.push_back(glm::length(piece.box.size()));
  }
  /// Why they are no aggregate; empty where they are one.
  [[nodiscard]] std::string fault() {
    if (largest > kLargestPiece) return "too many for one of many cards";
    if (count < kFewestPieces) return "too few to be seen together";
    if (static_cast<double>(in_small) < kSmallShare * static_cast<double>(triangles)) return "not all are small";
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    if (*middle > kWidestPiece * glm::length(box.size())) return "as wide as much of the mesh";
    return {};
  }
};

Look look_at(std::span<const Piece> pieces) {
  Look all;
  for (const Piece& piece : pieces) all.add(piece);
  return all;
}

/// By material of the mesh: may its pieces be thinned out? With kMasked those that are masked.
std::vector<std::uint8_t> find_eligible(const AggregateQuestion& question, std::uint32_t materials) {
  std::vector<std::uint8_t> is_eligible(materials, 1);
  for (std::uint32_t m = 0; question.choice == AggregateChoice::kMasked && m < materials; ++m) {
    const bool is_masked = m < question.materials.size() && question.materials[m].alpha_mode == scene::AlphaMode::kMask;
    is_eligible[m] = is_masked ? 1 : 0;
  }
  return is_eligible;
}

/// Parts that are aggregates by themselves where the whole is none: most_triangles by material.
std::vector<std::uint32_t> find_parts(const scene::SourceMesh& mesh, const Pieces& all,
                                      const std::vector<std::uint8_t>& is_eligible) {
  const auto materials = static_cast<std::uint32_t>(is_eligible.size());
  // A part has all materials that some piece has together.
  DisjointSets parts(materials);
  std::size_t next = 0;
  scene::for_each_triangle(mesh, [&](const auto&, std::uint32_t material) {
    parts.join(all.pieces[all.of_triangle[next++]].material, material);
  });
  std::vector<Look> whole(materials), small(materials);  // at what stands for the part
  for (const Piece& piece : all.pieces) {
    const std::uint32_t part = parts.find(piece.material);
    whole[part].add(piece);
    if (piece.triangles <= kSmallPiece) small[part].add(piece);
  }
  std::vector<std::uint8_t> is_out(materials, 0);
  for (std::uint32_t m = 0; m < materials; ++m) {
    if (is_eligible[m] == 0) is_out[parts.find(m)] = 1;
  }
  std::vector<std::uint32_t> most(materials, 0);
  for (std::uint32_t m = 0; m < materials; ++m) {
    if (parts.find(m) != m || whole[m].count == 0 || is_out[m] != 0) continue;
    if (whole[m].fault().empty()) {
      most[m] = kLargestPiece;
    } else if (2 * small[m].triangles >= whole[m].triangles && small[m].fault().empty()) {
      most[m] = kSmallPiece;
    }
  }
  for (std::uint32_t m = 0; m < materials; ++m) most[m] = most[parts.find(m)];
  return most;
}

/// The decision that `most` comes to.
AggregateDecision decide_by(const scene::SourceMesh& mesh, const Pieces& all, std::vector<std::uint32_t> most,
                            std::span<const scene::SceneMaterial> materials, const std::string& otherwise) {
  const std::vector<std::uint8_t> is_in = all.find_small(mesh, most);
  std::uint64_t count = 0, largest = 0;
  for (std::size_t p = 0; p < all.pieces.size(); ++p) {
    if (is_in[p] == 0) continue;
    ++count;
    largest = std::max(largest, all.pieces[p].triangles);
  }
  if (count == 0) return {false, otherwise, {}};
  if (count == all.pieces.size()) return {true, describe(count, largest), {}};
  std::vector<std::uint8_t> is_of(most.size(), 0);  // some piece has a triangle of it
  std::size_t next = 0;
  scene::for_each_triangle(mesh, [&](const auto&, std::uint32_t material) {
    if (is_in[all.of_triangle[next++]] != 0) is_of[material] = 1;
  });
  std::string names;
  for (std::size_t m = 0; m < is_of.size(); ++m) {
    if (is_of[m] == 0) most[m] = 0;
    if (is_of[m] == 0 || m >= materials.size() || materials[m].name.empty()) continue;
    names += (names.empty() ? " of '" : ", '") + materials[m].name + "'";
  }
  const std::size_t others = all.pieces.size() - count;
  return {true,
          describe(count, largest, names) + ", become a mesh of their own; " + std::to_string(others) +
              (others == 1 ? " other piece is" : " other pieces are") + " simplified by distance",
          std::move(most)};
}

/// Whether a mesh has texture coordinates in these sets beyond what a float tells texels apart by: at 4,096 they are
/// 1/2048 of a texture apart.
std::array<bool, scene::kMaxUvSets> find_far_sets(const scene::SourceMesh& mesh) {
  constexpr float kFarthest = 4096.0F;
  std::array<bool, scene::kMaxUvSets> is_far{};
  for (const scene::Primitive& primitive : mesh.primitives) {
    for (std::size_t set = 0; set < is_far.size(); ++set) {
      const auto is_beyond = [](const Vec2f& uv) {
        return !(std::fabs(uv.x) <= kFarthest && std::fabs(uv.y) <= kFarthest);
      };
      is_far[set] = is_far[set] || std::any_of(primitive.uvs[set].begin(), primitive.uvs[set].end(), is_beyond);
    }
  }
  return is_far;
}

/// Nobody can say what such a mask lets through.
void leave_out_far_masks(const scene::SourceMesh& mesh, std::span<const scene::SceneMaterial> materials,
                         AggregateDecision& decision) {
  if (!decision.is_aggregate) return;
  const std::array<bool, scene::kMaxUvSets> is_far = find_far_sets(mesh);
  std::vector<std::uint8_t> is_out(std::max<std::size_t>(materials.size(), count_materials(mesh)), 0);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const std::uint32_t set = materials[m].base_color_uv_set;  // any number, or none
    const bool is_masked = materials[m].alpha_mode == scene::AlphaMode::kMask && set < is_far.size();
    is_out[m] = is_masked && is_far[set] ? 1 : 0;
  }
  leave_out(mesh, is_out, "its mask lies at texture coordinates beyond 4096, where nothing tells texels apart",
            decision);
}

AggregateDecision decide_by_pieces(const scene::SourceMesh& mesh, const AggregateQuestion& question) {
  if (question.choice == AggregateChoice::kNever) return {};
  const std::uint32_t materials = count_materials(mesh);
  const bool is_named = question.choice == AggregateChoice::kNamed;
  std::vector<std::uint32_t> most(materials, 0);
  bool is_asked = !is_named || is_match_of_any(question.names, mesh.name);
  if (is_asked) most.assign(materials, kLargestPiece);
  if (is_named && !is_asked) {
    for (const scene::Primitive& primitive : mesh.primitives) {
      const std::uint32_t m = primitive.material.value;
      if (m >= question.materials.size() || !is_match_of_any(question.names, question.materials[m].name)) continue;
      most[m] = kLargestPiece;
      is_asked = true;
    }
    if (!is_asked) return {};
  }
  const std::vector<std::uint8_t> is_eligible = find_eligible(question, materials);
  bool is_any = false, is_every = true;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const bool is_of_these = is_eligible[primitive.material.value] != 0;
    is_any = is_any || is_of_these;
    is_every = is_every && is_of_these;
  }
  if (!is_any && question.choice == AggregateChoice::kMasked) return {};
  if (question.keep_topology) return {false, "its topology is kept, and so is each piece", {}};
  if (question.lock_borders) return {false, "its borders are locked, and so is each piece", {}};
  const Pieces all(mesh);
  if (all.pieces.empty()) return {false, "it has no triangles", {}};
  Look whole = look_at(all.pieces);
  const std::string what = describe(whole.count, whole.largest) + ": ";
  if (question.choice != AggregateChoice::kAuto && question.choice != AggregateChoice::kMasked) {
    return decide_by(mesh, all, std::move(most), question.materials, what + "too many for one of many cards");
  }
  const std::string fault = whole.fault();
  if (fault.empty() && is_every) return {true, describe(whole.count, whole.largest), {}};
  return decide_by(mesh, all, find_parts(mesh, all, is_eligible), question.materials,
                   what + (fault.empty() ? "those with a mask are no aggregate of their own" : fault));
}

}  // namespace

AggregateDecision decide_aggregate(const scene::SourceMesh& mesh, const AggregateQuestion& question) {
  AggregateDecision decision = decide_by_pieces(mesh, question);
  leave_out_far_masks(mesh, question.materials, decision);
  return decision;
}

void leave_out(const scene::SourceMesh& mesh, std::span<const std::uint8_t> is_out, const std::string& reason,
               AggregateDecision& decision) {
  if (!decision.is_aggregate) return;
  const auto is_of_any_out = [&](const scene::Primitive& primitive) { return is_out[primitive.material.value] != 0; };
  if (std::none_of(mesh.primitives.begin(), mesh.primitives.end(), is_of_any_out)) return;
  std::vector<std::uint32_t>& most = decision.most_triangles;
  for (std::size_t m = 0; m < most.size(); ++m) most[m] = is_out[m] != 0 ? 0 : most[m];
  const std::vector<std::uint8_t> is_in = Pieces(mesh).find_small(mesh, most);  // of all of a mesh none
  if (std::find(is_in.begin(), is_in.end(), 1) == is_in.end()) decision = {false, reason, {}};
}

void add_materials(const scene::SourceMesh& mesh, const AggregateDecision& decision,
                   std::vector<std::uint8_t>& is_used) {
  if (!decision.is_aggregate) return;
  for (const scene::Primitive& primitive : mesh.primitives) {
    const std::uint32_t m = primitive.material.value;
    if (decision.most_triangles.empty() || decision.most_triangles[m] > 0) is_used[m] = 1;
  }
}

std::vector<std::string> find_unknown_names(const scene::Scene& scene, std::string_view names) {
  std::vector<std::string> unknown;
  while (!names.empty()) {
    const std::string_view name = names.substr(0, std::min(names.find(','), names.size()));
    names.remove_prefix(std::min(name.size() + 1, names.size()));
    const auto has_name = [&](const auto& named) { return is_match(name, named.name); };
    if (!name.empty() && std::none_of(scene.meshes.begin(), scene.meshes.end(), has_name) &&
        std::none_of(scene.materials.begin(), scene.materials.end(), has_name)) {
      unknown.emplace_back(name);
    }
  }
  return unknown;
}

}  // namespace meshlode::builder
