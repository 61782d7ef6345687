// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <meshlode/page.h>

#include "app/stream/words.h"
#include "base/box.h"
#include "base/printable.h"
#include "base/try.h"
#include "run/unpack/unpack.h"

namespace meshlode::app {

namespace {

std::string_view file_name(std::string_view path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

/// The one asset that is called so: by its whole path, else by its file name.
Result<std::uint32_t> find_asset(std::string_view word, std::span<const std::string> names, const std::string& where) {
  std::optional<std::uint32_t> found;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    if (names[i] == word) return i;
    if (file_name(names[i]) != word) continue;
    if (found) return Error{ErrorCode::kInvalid, where, "several assets are called '" + printable(word) + "'"};
    found = i;
  }
  if (found) return *found;
  return Error{ErrorCode::kInvalid, where, "no asset of the command line is called '" + printable(word) + "'"};
}

/// Row-major 3×4 matrices: first `m`, then the placement.
void place(const Placement& placement, format::InstanceRecord& instance) {
  const double angle = placement.yaw_degrees * std::numbers::pi / 180.0;
  const double c = std::cos(angle) * placement.scale, s = std::sin(angle) * placement.scale;
  const double rows[3][3] = {{c, 0.0, s}, {0.0, placement.scale, 0.0}, {-s, 0.0, c}};
  double out[12];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? placement.position[row] : 0.0;
      for (int k = 0; k < 3; ++k) sum += rows[row][k] * instance.transform[4 * k + column];
      out[4 * row + column] = sum;
    }
  }
  std::copy(std::begin(out), std::end(out), std::begin(instance.transform));
  instance.scale *= placement.scale * (1.0 + 0x1p-40);  // above the rounding of the product and of sine and cosine
  const bool is_finite = std::isfinite(instance.scale) &&
                         std::all_of(std::begin(out), std::end(out), [](double x) { return std::isfinite(x); });
  if (!is_finite) instance.flags |= format::kInstanceSingular;
}

/// The bytes of each cluster from the starts of their data, which lie one behind the other.
Status add_cluster_bytes(const run::Asset& asset, StreamScene& scene) {
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    const format::PageRecord& page = asset.pages()[p];
    TRY_LET(bytes, run::load_page(asset, PageId(p)));
    const std::span<const std::uint32_t> words = bytes->words();
    const std::uint32_t head_words = format::head_words(asset.meshes()[asset.groups()[page.first_group].mesh]);
    const auto data_of = [&](std::uint32_t c) {
      if (c == page.cluster_count) return static_cast<std::uint32_t>(words.size()) - 1U;
      const std::uint32_t* head = words.data() + 2 + std::size_t{c} * head_words;
      return static_cast<std::uint32_t>(format::get_field(head, format::head::kDataWord));
    };
    for (std::uint32_t c = 0; c < page.cluster_count; ++c) {
      scene.cluster_bytes.push_back(4 * (head_words + data_of(c + 1) - data_of(c)));
    }
  }
  return Ok{};
}

struct Bases {
  std::uint32_t mesh, group, cluster, node, page;
};

Status add_tables(const run::Asset& asset, StreamScene& scene) {
  const auto room = [](std::size_t have, std::size_t more) { return have + more < std::uint64_t{kNoId}; };
  if (!room(scene.meshes.size(), asset.meshes().size()) || !room(scene.groups.size(), asset.groups().size()) ||
      !room(scene.clusters.size(), asset.clusters().size()) || !room(scene.nodes.size(), asset.nodes().size()) ||
      !room(scene.pages.size(), asset.pages().size())) {
    return Error{ErrorCode::kUnsupported, "", "the assets have more records than one scene has ids"};
  }
  const Bases base{static_cast<std::uint32_t>(scene.meshes.size()), static_cast<std::uint32_t>(scene.groups.size()),
                   static_cast<std::uint32_t>(scene.clusters.size()), static_cast<std::uint32_t>(scene.nodes.size()),
                   static_cast<std::uint32_t>(scene.pages.size())};
  for (format::MeshRecord mesh : asset.meshes()) {
    mesh.first_group += base.group;
    mesh.first_cluster += base.cluster;
    mesh.first_node += base.node;
    scene.meshes.push_back(mesh);
  }
  for (format::GroupRecord group : asset.groups()) {
    group.first_cluster += base.cluster;
    group.mesh += base.mesh;
    group.page += base.page;
    scene.groups.push_back(group);
  }
  for (format::ClusterRecord cluster : asset.clusters()) {
    if (cluster.own_group != format::kNone) cluster.own_group += base.group;
    cluster.coarser_group += base.group;
    scene.clusters.push_back(cluster);
  }
  for (format::NodeRecord node : asset.nodes()) {
    node.first += node.child_count == 0 ? base.group : base.node;
    scene.nodes.push_back(node);
  }
  for (const format::PageRecord& page : asset.pages()) scene.pages.push_back({page.bytes, page.stored_bytes});
  return add_cluster_bytes(asset, scene);
}

/// Grows the bounds of the scene by the box of one instance. What is not finite is not drawn.
void add_bounds(format::InstanceRecord& instance, StreamScene& scene) {
  const format::MeshRecord& mesh = scene.meshes[instance.mesh];
  if ((instance.flags & format::kInstanceSingular) != 0 || mesh.cluster_count == 0) return;
  const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
  Box3d of_mesh, box;
  for (int axis = 0; axis < 3; ++axis) {
    of_mesh.low[axis] = mesh.origin[axis] + step * mesh.bounds_min[axis];
    of_mesh.high[axis] = mesh.origin[axis] + step * mesh.bounds_max[axis];
  }
  for (const Vec3d& p : of_mesh.corners()) {
    Vec3d world{0.0};
    for (int row = 0; row < 3; ++row) {
      const double* m = instance.transform + 4 * row;
      world[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
    }
    box.add(world);
  }
  const double radius = 0.5 * glm::length(box.size());
  if (!std::isfinite(radius)) {
    instance.flags |= format::kInstanceSingular;
    return;
  }
  scene.object_radius = scene.box.is_empty() ? radius : std::max(scene.object_radius, radius);
  scene.box.add(box);
}

}  // namespace

Result<std::vector<Placement>> parse_placements(std::string_view text, const std::string& where,
                                                std::span<const std::string> names) {
  std::vector<Placement> out;
  LineReader lines(text);
  while (const auto line = lines.next()) {
    const std::string place_of_line = where + ", line " + std::to_string(lines.number());
    const std::vector<std::string_view> words = split_words(*line, " \t");
    if (words.size() < 6) {
      return Error{ErrorCode::kInvalid, place_of_line, "expected asset x y z yaw scale" + got_text(*line)};
    }
    if (out.size() == kMostInstances) return Error{ErrorCode::kInvalid, place_of_line, "is the 65,537th placement"};
    const std::size_t first = words.size() - 5;  // of the numbers: a name may have blanks
    const char* const end_of_name = words[first - 1].data() + words[first - 1].size();
    const std::string_view name(words[0].data(), static_cast<std::size_t>(end_of_name - words[0].data()));
    TRY_LET(asset, find_asset(name, names, place_of_line));
    double numbers[5];
    for (std::size_t i = 0; i < 5; ++i) {
      const auto number = parse_number(words[first + i]);
      if (!number) {
        return Error{ErrorCode::kInvalid, place_of_line,
                     "expected a number of at most 1e15" + got_text(words[first + i])};
      }
      numbers[i] = *number;
    }
    if (!(numbers[4] > 0.0)) return Error{ErrorCode::kInvalid, place_of_line, "the scale is not above 0"};
    out.push_back({*asset, {numbers[0], numbers[1], numbers[2]}, numbers[3], numbers[4]});
  }
  if (out.empty()) return Error{ErrorCode::kInvalid, where, "has no placement"};
  return out;
}

std::uint64_t StreamScene::page_bytes() const {
  std::uint64_t sum = 0;
  for (const StreamPage& page : pages) sum += page.bytes;
  return sum;
}

std::uint64_t StreamScene::stored_bytes() const {
  std::uint64_t sum = 0;
  for (const StreamPage& page : pages) sum += page.stored_bytes;
  return sum;
}

Result<StreamScene> make_stream_scene(std::span<const run::Asset> assets, std::span<const std::string> names,
                                      std::span<const Placement> placements) {
  StreamScene scene;
  std::vector<std::uint32_t>& first_mesh = scene.first_mesh_of_file;
  for (std::size_t i = 0; i < assets.size(); ++i) {
    first_mesh.push_back(static_cast<std::uint32_t>(scene.meshes.size()));
    if (const Status added = add_tables(assets[i], scene); !added) {
      const Error& error = added.error();
      return Error{error.code, names[i] + (error.where.empty() ? "" : ": ") + error.where, error.detail};
    }
  }
  std::uint64_t clusters = 0;
  for (const Placement& placement : placements) {
    const run::Asset& asset = assets[placement.asset];
    if (asset.instances().size() > kMostInstances - scene.instances.size()) {
      return Error{ErrorCode::kUnsupported, "", "the scene has more than 65,536 instances"};
    }
    for (format::InstanceRecord instance : asset.instances()) {
      instance.mesh += first_mesh[placement.asset];
      clusters += scene.meshes[instance.mesh].cluster_count;
      place(placement, instance);
      add_bounds(instance, scene);
      scene.instances.push_back(instance);
    }
    if (clusters > kMostPlacedClusters) {
      return Error{ErrorCode::kUnsupported, "", "the instances of the scene have more than 134,217,728 clusters"};
    }
  }
  if (scene.box.is_empty()) return Error{ErrorCode::kInvalid, "", "nothing of the scene can be drawn"};
  if (!(scene.object_radius > 0.0)) scene.object_radius = 1.0;
  return scene;
}

}  // namespace meshlode::app
