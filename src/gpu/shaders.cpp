// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu/shaders.h"

namespace meshlode::gpu::shaders {

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
constexpr std::uint32_t kPyramidTop[] = {
#include "pyramid_top.comp.inc"
};
constexpr std::uint32_t kDecode[] = {
#include "decode.comp.inc"
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
std::span<const std::uint32_t> pyramid_top() {
  return kPyramidTop;
}
std::span<const std::uint32_t> decode() {
  return kDecode;
}

}  // namespace meshlode::gpu::shaders
