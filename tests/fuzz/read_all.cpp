// SPDX-License-Identifier: GPL-3.0-or-later
#include "read_all.h"

#include <cmath>
#include <string_view>

#include "harness.h"
#include "run/decode/decode.h"
#include "run/select/select.h"
#include "run/unpack/content_hash.h"

namespace meshlode::fuzz {

namespace {

/// Reads every byte, so that the address sanitizer sees where the view ends.
std::uint64_t touch(std::span<const std::uint8_t> bytes) {
  std::uint64_t sum = 0;
  for (const std::uint8_t byte : bytes) sum = sum * 31 + byte;
  return sum;
}
std::uint64_t touch(std::string_view text) {
  return touch({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::uint64_t touch_tables(const run::Asset& asset) {
  std::uint64_t sum = touch(asset.meta_json()) + touch(asset.scene_json());
  for (const auto& mesh : asset.meshes()) sum += touch(asset.string(mesh.name));
  for (const auto& material : asset.materials()) sum += touch(asset.string(material.name));
  for (const auto& instance : asset.instances()) sum += touch(asset.string(instance.name));
  for (const auto& blob : asset.blobs()) {
    sum += touch(asset.string(blob.name)) + touch(asset.string(blob.mime_type)) + touch(asset.blob_bytes(blob));
  }
  for (const auto& page : asset.pages()) {
    for (std::uint32_t d = 0; d < page.dependency_count; ++d) {
      const std::uint32_t needed = asset.page_dependencies()[page.first_dependency + d];
      require(needed < asset.pages().size(), "a page depends on a page that does not exist");
    }
  }
  return sum;
}

void decode_page(const run::Asset& asset, PageId id, const run::PageBytes& page) {
  const format::PageRecord& record = asset.pages()[id.value];
  run::DecodedCluster cluster;
  run::ClusterAttributes attributes;
  for (std::uint32_t i = 0; i < record.cluster_count; ++i) {
    const ClusterId c{record.first_cluster + i};
    run::decode_cluster(asset, page, c, cluster);
    require(cluster.channels.size() == std::size_t{cluster.vertex_count} * cluster.channel_count, "channels");
    require(cluster.triangles.size() == cluster.triangle_count, "triangles");
    require(cluster.triangle_material.size() == cluster.triangle_count, "triangle materials");
    for (const auto& triangle : cluster.triangles) {
      for (const std::uint8_t v : triangle) require(v < cluster.vertex_count, "a corner is no vertex");
    }
    for (const std::uint32_t m : cluster.triangle_material) require(m < asset.materials().size(), "no such material");
    const format::MeshRecord& mesh = asset.meshes()[asset.groups()[asset.clusters()[c.value].coarser_group].mesh];
    run::decode_attributes(mesh, cluster, attributes);
    require(attributes.positions.size() == cluster.vertex_count, "positions");
    for (const Vec3f& n : attributes.normals) require(std::isfinite(n.x + n.y + n.z), "a normal is not finite");
  }
}

void select_cuts(const run::Asset& asset) {
  // A scene of a few bytes may name many instances: the work stays in proportion.
  if (asset.instances().size() * asset.clusters().size() < 100000) {
    for (const double distance : {0.0, 3.0, 1e9}) {
      run::Camera camera;
      camera.eye = {distance, 0.5, 0.0};
      camera.is_orthographic = distance > 1e8;
      for (const run::ClusterInstance& d : run::select_bvh(asset, camera, 1.0)) {
        require(d.cluster.value < asset.clusters().size() && d.instance.value < asset.instances().size(), "selection");
      }
      for (const run::ClusterInstance& d : run::select_flat(asset, camera, 1.0)) {
        require(d.cluster.value < asset.clusters().size(), "flat selection");
      }
    }
  }
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    for (const double error : {-1.0, 0.01, 1e30}) {
      const auto& mesh = asset.meshes()[m];
      for (const ClusterId c : run::select_uniform(asset, MeshId(m), error).clusters) {
        require(c.value - mesh.first_cluster < mesh.cluster_count, "a cut has a cluster of another mesh");
      }
    }
  }
}

}  // namespace

void read_all(const run::Asset& asset) {
  volatile std::uint64_t keep = touch_tables(asset);
  (void)keep;
  select_cuts(asset);
  for (std::size_t p = 0; p < asset.pages().size(); ++p) {
    if (const auto page = run::load_page(asset, PageId(p)); page) {
      decode_page(asset, PageId(p), *page);
    } else {
      require(!page.error().detail.empty(), "a refusal without a reason");
    }
  }
}

}  // namespace meshlode::fuzz
