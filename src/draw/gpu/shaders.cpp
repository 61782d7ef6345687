// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/gpu/shaders.h"

namespace meshlode::draw::shaders {

namespace {

constexpr std::uint32_t kInstances[] = {
#include "instances.comp.inc"
};
constexpr std::uint32_t kTraverse[] = {
#include "traverse.comp.inc"
};
constexpr std::uint32_t kClusters[] = {
#include "clusters.comp.inc"
};
constexpr std::uint32_t kRaster[] = {
#include "raster.comp.inc"
};
constexpr std::uint32_t kRasterClip[] = {
#include "raster_clip.comp.inc"
};
constexpr std::uint32_t kPyramid[] = {
#include "pyramid.comp.inc"
};
constexpr std::uint32_t kDecode[] = {
#include "decode.comp.inc"
};
constexpr std::uint32_t kRoots[] = {
#include "roots.comp.inc"
};
constexpr std::uint32_t kRasterFar[] = {
#include "raster_far.comp.inc"
};
constexpr std::uint32_t kResolve[] = {
#include "resolve.comp.inc"
};
constexpr std::uint32_t kSort[] = {
#include "sort.comp.inc"
};
constexpr std::uint32_t kFlat[] = {
#include "flat.comp.inc"
};
constexpr std::uint32_t kPersistent[] = {
#include "persistent.comp.inc"
};
constexpr std::uint32_t kHardwareVert[] = {
#include "hardware.vert.inc"
};
constexpr std::uint32_t kHardwareMesh[] = {
#include "hardware.mesh.inc"
};
constexpr std::uint32_t kHardwareFrag[] = {
#include "hardware.frag.inc"
};
constexpr std::uint32_t kHardwareMeshFrag[] = {
#include "hardware_mesh.frag.inc"
};
constexpr std::uint32_t kResolveTextures[] = {
#include "resolve_textures.comp.inc"
};
constexpr std::uint32_t kRasterMask[] = {
#include "raster_mask.comp.inc"
};
constexpr std::uint32_t kRasterFarMask[] = {
#include "raster_far_mask.comp.inc"
};
constexpr std::uint32_t kRasterClipMask[] = {
#include "raster_clip_mask.comp.inc"
};
constexpr std::uint32_t kHardwareMaskFrag[] = {
#include "hardware_mask.frag.inc"
};
constexpr std::uint32_t kHardwareMeshMaskFrag[] = {
#include "hardware_mesh_mask.frag.inc"
};

}  // namespace

std::span<const std::uint32_t> instances() {
  return kInstances;
}
std::span<const std::uint32_t> traverse() {
  return kTraverse;
}
std::span<const std::uint32_t> clusters() {
  return kClusters;
}
std::span<const std::uint32_t> raster() {
  return kRaster;
}
std::span<const std::uint32_t> raster_clip() {
  return kRasterClip;
}
std::span<const std::uint32_t> pyramid() {
  return kPyramid;
}
std::span<const std::uint32_t> decode() {
  return kDecode;
}
std::span<const std::uint32_t> roots() {
  return kRoots;
}
std::span<const std::uint32_t> raster_far() {
  return kRasterFar;
}
std::span<const std::uint32_t> resolve() {
  return kResolve;
}
std::span<const std::uint32_t> sort() {
  return kSort;
}
std::span<const std::uint32_t> flat() {
  return kFlat;
}
std::span<const std::uint32_t> persistent() {
  return kPersistent;
}
std::span<const std::uint32_t> hardware_vert() {
  return kHardwareVert;
}
std::span<const std::uint32_t> hardware_mesh() {
  return kHardwareMesh;
}
std::span<const std::uint32_t> hardware_frag() {
  return kHardwareFrag;
}
std::span<const std::uint32_t> hardware_mesh_frag() {
  return kHardwareMeshFrag;
}
std::span<const std::uint32_t> resolve_textures() {
  return kResolveTextures;
}
std::span<const std::uint32_t> raster_mask() {
  return kRasterMask;
}
std::span<const std::uint32_t> raster_far_mask() {
  return kRasterFarMask;
}
std::span<const std::uint32_t> raster_clip_mask() {
  return kRasterClipMask;
}
std::span<const std::uint32_t> hardware_mask_frag() {
  return kHardwareMaskFrag;
}
std::span<const std::uint32_t> hardware_mesh_mask_frag() {
  return kHardwareMeshMaskFrag;
}

}  // namespace meshlode::draw::shaders
