// SPDX-License-Identifier: GPL-3.0-or-later
// An asset on the device: its pages as they lie in the file, one after the other, and the tables that selection and
// culling read, in a form of their own (shaders/frame.h).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "draw/gpu/vulkan/vulkan.h"
#include "draw/textures/alpha_mask.h"
#include "draw/textures/texture_set.h"
#include "run/read/asset.h"
#include "run/select/attribute_bounds.h"

namespace meshlode::draw {

struct GpuScene {
  Buffer meshes, instances, nodes, groups, clusters, materials, pages, roots;
  Buffer page_words, ready, priorities;           ///< of pages, of groups, of pages (shaders/frame.h)
  Buffer surfaces, textures, texels;              ///< after upload_textures()
  Buffer mesh_uvs, masks, mask_texels;            ///< read where materials are masked
  std::shared_ptr<const AlphaMasks> alpha_masks;  ///< of the asset, for who compares; never null
  std::vector<MaterialTextures> material_textures;
  std::uint32_t instance_count = 0;
  std::uint32_t cluster_count = 0;
  std::uint32_t mesh_count = 0;
  std::uint32_t bvh_depth = 0;  ///< nodes on the longest way from a root
  std::uint32_t max_cluster_triangles = 0, max_cluster_vertices = 0;
  std::uint32_t max_root_triangles = 0, max_root_vertices = 0;  ///< of decoded roots
  std::uint64_t group_instances = 0;                            ///< groups of all instances together: no cut opens more
  std::uint64_t cluster_instances = 0;
  std::uint64_t page_bytes = 0;
  std::uint32_t slot_count = 0, slot_bytes = 0;  ///< of a pool of pages (page_pool.h); 0: all pages are there
  bool has_double_sided = false;
  bool has_alpha_mask = false;  ///< some sample may fail the alpha test
  bool has_textures = false;    ///< some material has a base colour or a normal texture
  bool has_stored_normals = false;
};

/// `instances` replaces the asset's own where it is not empty: a benchmark's scene. Their meshes are the asset's.
/// `bounds`: a group that deviates by more never passes, as in select_flat(). `images`: what decoded masks may take;
/// one of kDefaultMaxDecoded where it is null. `slots`: above 0, no page is uploaded, and there is room for so many
/// (page_pool.h). Errors: kInvalid for a broken page; kUnsupported where the device has no
/// room or a limit is passed.
[[nodiscard]] Result<GpuScene> upload_scene(Device& device, const run::Asset& asset,
                                            std::span<const format::InstanceRecord> instances = {},
                                            const run::AttributeBounds& bounds = {}, ImageBudget* images = nullptr,
                                            std::uint32_t slots = 0);

/// Textures for colours, which a visibility buffer does not need: before Renderer::make(), where colours are wanted.
/// Errors: kUnsupported where the device has no room.
[[nodiscard]] Status upload_textures(Device& device, const TextureSet& textures, GpuScene& scene);

}  // namespace meshlode::draw
