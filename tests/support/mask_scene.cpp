// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/mask_scene.h"

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "lab/samples/write_png.h"

namespace meshlode::test {

namespace {

scene::Primitive make_card(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, std::uint32_t cells) {
  scene::Primitive out;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double u = static_cast<double>(i) / cells, v = static_cast<double>(j) / cells;
      out.positions.push_back((a * (1.0 - u) + b * u) * (1.0 - v) + (d * (1.0 - u) + c * u) * v);
      out.uvs[0].emplace_back(static_cast<float>(-1.7 + 4.3 * u), static_cast<float>(-1.7 + 4.3 * v));
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t q = j * (cells + 1) + i;
      for (const std::uint32_t corner : {q, q + 1, q + cells + 2, q, q + cells + 2, q + cells + 1}) {
        out.indices.push_back(corner);
      }
    }
  }
  return out;
}

}  // namespace

std::uint8_t mask_texture_alpha(std::uint32_t x, std::uint32_t y) {
  return static_cast<std::uint8_t>((x * 97 + y * 61 + x * y * 7) % 256);
}

scene::Scene mask_scene(const MaskSceneOptions& options) {
  scene::Scene scene;
  scene.source_name = "masks.glb";
  scene.source_hash = "00000000000000000000000000000000";
  scene.materials.resize(10);
  std::string materials = R"({"name":"wall"})", textures, samplers;
  const std::string transform =
      options.transform.empty() ? "" : R"(,"extensions":{"KHR_texture_transform":)" + options.transform + "}";
  scene::SourceMesh wall, cards;
  wall.name = "wall";
  cards.name = "cards";
  wall.primitives.push_back(make_card({-4.0, -4.0, -2.0}, {4.0, -4.0, -2.0}, {4.0, 4.0, -2.0}, {-4.0, 4.0, -2.0}, 8));
  wall.primitives[0].material = MaterialId(0u);
  scene.materials[0].source_index = 0;
  for (std::uint32_t k = 0; k < 9; ++k) {
    const std::uint32_t column = k % 3, row = k / 3;
    const double x = 2.2 * column - 2.2, y = 2.2 * row - 2.2, lean = 0.25 * (k % 4);
    scene::Primitive card = make_card({x - 1.0, y - 1.0, lean}, {x + 1.0, y - 1.0, -lean}, {x + 1.0, y + 1.0, lean},
                                      {x - 1.0, y + 1.0, 0.1}, options.cells);
    card.material = MaterialId(1 + k);
    if (options.has_vertex_alpha) {
      for (const Vec2f& uv : card.uvs[0]) card.colors.emplace_back(1.0F, 1.0F, 1.0F, (2.6F - uv.x) / 4.3F);
    }
    cards.primitives.push_back(std::move(card));
    scene::SceneMaterial& m = scene.materials[1 + k];
    m.source_index = 1 + k;
    m.alpha_mode = scene::AlphaMode::kMask;
    m.alpha_cutoff = options.cutoff;
    m.base_color.w = options.factor;
    m.double_sided = true;
    if (options.has_texture) {
      m.base_color_texture = k;
      m.base_color_uv_set = 0;
      m.uv_sets_used = 1;
    }
    const std::string number = std::to_string(k);
    materials += options.has_texture
                     ? R"(,{"pbrMetallicRoughness":{"baseColorTexture":{"index":)" + number + transform + "}}}"
                     : ",{}";
    textures += std::string(k > 0 ? "," : "") + R"({"source":0,"sampler":)" + number + "}";
    samplers += std::string(k > 0 ? "," : "") + R"({"wrapS":)" + std::to_string(kWrapNames[k % 3]) + R"(,"wrapT":)" +
                std::to_string(kWrapNames[k / 3]) + "}";
  }
  scene.document = R"({"asset":{"version":"2.0"},"materials":[)" + materials + R"(],"textures":[)" + textures +
                   R"(],"samplers":[)" + samplers + R"(],"images":[{"blob":0}]})";
  scene.meshes = {wall, cards};
  for (std::uint32_t i = 0; i < 2; ++i) {
    scene::SceneInstance instance;
    instance.name = scene.meshes[i].name;
    instance.node = i;
    instance.mesh = MeshId(i);
    scene.instances.push_back(instance);
  }
  scene::SceneBlob blob;
  blob.name = "mask.png";
  blob.mime_type = "image/png";
  blob.bytes = options.image;
  if (blob.bytes.empty()) {
    lab::Texture texture{kMaskTextureWidth, kMaskTextureHeight, {}};
    for (std::uint32_t y = 0; y < texture.height; ++y) {
      for (std::uint32_t x = 0; x < texture.width; ++x) {
        const std::uint8_t c = static_cast<std::uint8_t>(10 * x), d = static_cast<std::uint8_t>(15 * y);
        texture.rgba.insert(texture.rgba.end(), {c, d, 90, mask_texture_alpha(x, y)});
      }
    }
    blob.bytes = lab::encode_png(texture);
  }
  scene.blobs.push_back(std::move(blob));
  return scene;
}

std::vector<std::uint8_t> built(const scene::Scene& scene) {
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, {}, {}, report);
  if (bytes) return std::move(*bytes);
  ADD_FAILURE() << bytes.error().message();
  return {};
}

}  // namespace meshlode::test
