// SPDX-License-Identifier: GPL-3.0-or-later
#include "table/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "laws/law.h"
#include "run/select/select.h"

namespace meshlode::test::hard {

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 72;
constexpr std::uint8_t kGrey = 200;

/// Digits of 3 by 5 pixels, a row in three bits, from the top.
constexpr std::array<std::array<std::uint8_t, 5>, 10> kDigits{{{7, 5, 5, 5, 7},
                                                               {2, 6, 2, 2, 7},
                                                               {7, 1, 7, 4, 7},
                                                               {7, 1, 7, 1, 7},
                                                               {5, 5, 7, 1, 1},
                                                               {7, 4, 7, 1, 7},
                                                               {7, 4, 7, 5, 7},
                                                               {7, 1, 1, 1, 1},
                                                               {7, 5, 7, 5, 7},
                                                               {7, 5, 7, 1, 7}}};

/// Around everything that the first instance draws.
run::Camera camera_for(const run::Asset& asset) {
  const format::InstanceRecord& instance = asset.instances()[0];
  const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
  const double step = std::ldexp(mesh.grid.mantissa, mesh.grid.log2);
  Vec3d low(HUGE_VAL), high(-HUGE_VAL);
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3d p, world;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_high = (corner >> static_cast<unsigned>(axis) & 1U) != 0;
      p[axis] = mesh.origin[axis] + step * (is_high ? mesh.bounds_max[axis] : mesh.bounds_min[axis]);
    }
    for (int row = 0; row < 3; ++row) {
      const double* m = instance.transform + 4 * row;
      world[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
    }
    low = glm::min(low, world);
    high = glm::max(high, world);
  }
  const Vec3d middle = low + (high - low) * 0.5;
  const double radius = std::max(0.5 * glm::length(high - low), 1e-90);
  run::Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.target = middle;
  camera.eye = middle + glm::normalize(Vec3d(0.45, 0.75, 1.0)) * (2.4 * radius);
  camera.near_distance = 0.1 * radius;
  return camera;
}

Result<draw::Image> draw_at(const HardCase& hard_case, double parameter) {
  Result<Sample> sample = hard_case.make(parameter);
  if (!sample) return sample.error();
  for (scene::SceneMaterial& material : sample->scene.materials) material.double_sided = true;
  const Result<Built> built = build_sample(std::move(*sample));
  if (!built) return built.error();
  const run::Asset& asset = *built->asset;
  if (asset.instances().empty()) return Error{ErrorCode::kUnsupported, hard_case.name, "nothing is drawn"};
  const run::Camera camera = camera_for(asset);
  const auto cut = run::select_flat(asset, camera, 0.0);  // no error is allowed: level 0, or what equals it
  return draw::render_cut(asset, cut, camera, draw::View::kShaded);
}

void put_pixel(draw::Image& sheet, std::uint32_t x, std::uint32_t y, const std::array<std::uint8_t, 4>& colour) {
  std::copy(colour.begin(), colour.end(),
            sheet.rgba.begin() + static_cast<std::ptrdiff_t>(4 * (std::size_t{y} * sheet.width + x)));
}

void put_number(draw::Image& sheet, std::uint32_t left, std::uint32_t top, std::size_t number) {
  const std::string text = std::to_string(number);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto& digit = kDigits[static_cast<std::size_t>(text[i] - '0')];
    for (std::uint32_t y = 0; y < 10; ++y) {
      for (std::uint32_t x = 0; x < 6; ++x) {
        if ((digit[y / 2] >> (2 - x / 2) & 1U) == 0) continue;
        put_pixel(sheet, left + 4 + static_cast<std::uint32_t>(8 * i) + x, top + 4 + y, {0, 0, 0, 255});
      }
    }
  }
}

}  // namespace

Result<draw::Image> draw_thumbnail(const HardCase& hard_case) {
  if (hard_case.sweep.size() > 1) {
    Result<draw::Image> image = draw_at(hard_case, hard_case.sweep[1]);
    if (image) return image;
  }
  return draw_at(hard_case, hard_case.sweep.front());
}

std::vector<std::uint8_t> contact_sheet(std::span<const HardCase* const> cases, std::uint32_t columns) {
  draw::Image sheet;
  const auto rows = static_cast<std::uint32_t>((cases.size() + columns - 1) / columns);
  sheet.width = columns * kWidth;
  sheet.height = rows * kHeight;
  sheet.rgba.assign(std::size_t{4} * sheet.width * sheet.height, 255);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::uint32_t left = static_cast<std::uint32_t>(i % columns) * kWidth;
    const std::uint32_t top = static_cast<std::uint32_t>(i / columns) * kHeight;
    const Result<draw::Image> tile = draw_thumbnail(*cases[i]);
    for (std::uint32_t y = 0; y + 1 < kHeight; ++y) {
      for (std::uint32_t x = 0; x + 1 < kWidth; ++x) {
        std::array<std::uint8_t, 4> colour{kGrey, kGrey, kGrey, 255};
        if (tile) {
          const std::uint8_t* from = &tile->rgba[4 * (std::size_t{y} * kWidth + x)];
          // Fewer shades: the sheet is a part of a page.
          for (std::size_t k = 0; k < 3; ++k) colour[k] = static_cast<std::uint8_t>(from[k] / 12 * 12 + 3);
        }
        put_pixel(sheet, left + x, top + y, colour);
      }
    }
    put_number(sheet, left, top, i + 1);
  }
  return draw::encode_png(sheet);
}

}  // namespace meshlode::test::hard
