// SPDX-License-Identifier: GPL-3.0-or-later
// What `render` does with a hostile asset: select, draw, colour, encode. Eight bytes before the asset choose the
// camera.
#include <cmath>
#include <vector>

#include "asset_mutator.h"
#include "draw/raster/raster.h"
#include "harness.h"

namespace {

using namespace meshlode;

constexpr std::size_t kPrefix = 8;
constexpr std::size_t kMostClusters = 2000;  ///< drawn: more would only take longer

double centred(std::uint8_t byte) {
  return (byte - 128) / 16.0;
}

run::Camera camera_of(const std::uint8_t* bytes) {
  run::Camera camera;
  camera.width = 1 + bytes[0] % 64;
  camera.height = 1 + bytes[1] % 48;
  camera.eye = {centred(bytes[2]), centred(bytes[3]), centred(bytes[4])};
  camera.eye *= std::exp2(bytes[5] % 32 - 12);
  camera.is_orthographic = bytes[6] % 4 == 0;
  camera.ortho_height = std::exp2(bytes[6] % 16 - 6);
  camera.near_distance = std::exp2(-(bytes[7] % 24));
  return camera;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size <= kPrefix) return 0;
  const std::vector<std::uint8_t> bytes(data + kPrefix, data + size);
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset || asset->instances().size() > 1000) return 0;
  const run::Camera camera = camera_of(data);
  const double pixel_error = std::exp2(data[7] % 12) - 1.0;
  const auto cut = run::select_bvh_within(run::tables_of(*asset), camera, pixel_error, kMostClusters);
  if (!cut) return 0;
  draw::ImageBudget budget(std::uint64_t{8} << 20U);
  const draw::AlphaMasks masks = draw::load_alpha_masks(*asset, budget);
  const auto visibility = draw::draw_cut(*asset, *cut, camera, masks);
  if (!visibility) {
    fuzz::require(!visibility.error().message().empty(), "a refusal without a reason");
    return 0;
  }
  for (std::size_t i = 0; i < visibility->pixel_count(); ++i) {
    const std::uint32_t item = visibility->item[i];
    fuzz::require(item == draw::VisibilityBuffer::kNothing || item < cut->size(),
                  "a pixel shows what is not in the cut");
  }
  const draw::TextureSet textures = draw::load_textures(*asset, budget);
  for (const draw::View view :
       {draw::View::kShaded, draw::View::kClusters, draw::View::kTriangles, draw::View::kLevels}) {
    const auto image = draw::shade_view(*asset, *cut, camera, *visibility, view, textures);
    fuzz::require(image.ok(), "what was drawn cannot be coloured");
    fuzz::require(!draw::encode_png(*image).empty(), "no picture");
  }
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, kPrefix);
}
#endif
