// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb_reader.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

namespace meshlode::test {
namespace {

std::uint32_t u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, &bytes[at], 4);
  return value;
}

std::size_t component_bytes(int type) {
  return type == 5126 || type == 5125 ? 4 : type == 5123 ? 2 : 1;
}

std::size_t component_count(const std::string& type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
}

double read_component(const std::uint8_t* at, int type, bool normalized) {
  if (type == 5126) {
    float value = 0.0F;
    std::memcpy(&value, at, 4);
    return static_cast<double>(value);
  }
  if (type == 5125) {
    std::uint32_t value = 0;
    std::memcpy(&value, at, 4);
    return value;
  }
  if (type == 5123) {
    std::uint16_t value = 0;
    std::memcpy(&value, at, 2);
    return normalized ? value / 65535.0 : value;
  }
  return normalized ? *at / 255.0 : *at;
}

}  // namespace

Glb Glb::parse(std::span<const std::uint8_t> bytes) {
  Glb glb;
  if (bytes.size() < 20 || std::memcmp(bytes.data(), "glTF", 4) != 0) {
    ADD_FAILURE() << "no GLB header";
    return glb;
  }
  EXPECT_EQ(u32(bytes, 4), 2U);
  EXPECT_EQ(u32(bytes, 8), bytes.size());
  std::size_t at = 12;
  for (int chunk = 0; at + 8 <= bytes.size(); ++chunk) {
    const std::size_t size = u32(bytes, at);
    const std::uint32_t type = u32(bytes, at + 4);
    EXPECT_EQ(size % 4, 0U);
    if (at + 8 + size > bytes.size()) {
      ADD_FAILURE() << "a chunk leaves the file";
      return glb;
    }
    const auto body = bytes.subspan(at + 8, size);
    if (chunk == 0) {
      EXPECT_EQ(type, 0x4E4F534AU);
      glb.json = nlohmann::json::parse(body.begin(), body.end());
    } else {
      EXPECT_EQ(type, 0x004E4942U);
      glb.bin.assign(body.begin(), body.end());
    }
    at += 8 + size;
  }
  EXPECT_EQ(at, bytes.size());
  return glb;
}

std::vector<std::uint8_t> Glb::view_bytes(std::size_t view) const {
  const auto& v = json.at("bufferViews").at(view);
  const std::size_t offset = v.value("byteOffset", std::size_t{0});
  const std::size_t size = v.at("byteLength");
  EXPECT_EQ(v.at("buffer"), 0);
  if (offset + size > bin.size()) {
    ADD_FAILURE() << "view " << view << " leaves the buffer";
    return {};
  }
  return {bin.begin() + static_cast<std::ptrdiff_t>(offset), bin.begin() + static_cast<std::ptrdiff_t>(offset + size)};
}

std::vector<std::vector<double>> Glb::rows(std::size_t accessor) const {
  const auto& a = json.at("accessors").at(accessor);
  const std::size_t count = a.at("count");
  const std::size_t width = component_count(a.at("type"));
  const int type = a.at("componentType");
  const bool normalized = a.value("normalized", false);
  std::vector<std::vector<double>> rows(count, std::vector<double>(width, 0.0));
  if (!a.contains("bufferView")) return rows;  // zeros, says the specification
  const std::vector<std::uint8_t> bytes = view_bytes(a.at("bufferView"));
  const std::size_t stride = json.at("bufferViews")
                                 .at(a.at("bufferView").get<std::size_t>())
                                 .value("byteStride", width * component_bytes(type));
  const std::size_t offset = a.value("byteOffset", std::size_t{0});
  if (count > 0 && offset + (count - 1) * stride + width * component_bytes(type) > bytes.size()) {
    ADD_FAILURE() << "accessor " << accessor << " leaves its view";
    return rows;
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < width; ++c) {
      rows[i][c] = read_component(&bytes[offset + i * stride + c * component_bytes(type)], type, normalized);
    }
  }
  return rows;
}

void Glb::expect_sound() const {
  EXPECT_EQ(json.at("asset").at("version"), "2.0");
  if (json.contains("buffers")) {
    ASSERT_EQ(json.at("buffers").size(), 1U);
    EXPECT_LE(json.at("buffers")[0].at("byteLength").get<std::size_t>(), bin.size());
    EXPECT_LT(bin.size() - json.at("buffers")[0].at("byteLength").get<std::size_t>(), 4U);
  }
  for (const auto& view : json.value("bufferViews", nlohmann::json::array())) {
    EXPECT_EQ(view.value("byteOffset", std::size_t{0}) % 4, 0U);
    EXPECT_GT(view.at("byteLength").get<std::size_t>(), 0U);
  }
  const std::size_t mesh_count = json.contains("meshes") ? json.at("meshes").size() : 0;
  for (std::size_t m = 0; m < mesh_count; ++m) {
    EXPECT_FALSE(json.at("meshes")[m].at("primitives").empty());
    for (const auto& primitive : json.at("meshes")[m].at("primitives")) {
      const auto& attributes = primitive.at("attributes");
      const auto positions = rows(attributes.at("POSITION"));
      for (const auto& [name, accessor] : attributes.items()) {
        EXPECT_EQ(rows(accessor).size(), positions.size()) << name;
        const auto& a = json.at("accessors").at(accessor.get<std::size_t>());
        if (a.contains("bufferView")) {
          EXPECT_EQ(json.at("bufferViews").at(a.at("bufferView").get<std::size_t>()).at("target"), 34962);
        }
      }
      const auto& position = json.at("accessors").at(attributes.at("POSITION").get<std::size_t>());
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [low, high] = std::minmax_element(positions.begin(), positions.end(),
                                                     [c](const auto& a, const auto& b) { return a[c] < b[c]; });
        EXPECT_EQ(position.at("min")[c].get<double>(), (*low)[c]);
        EXPECT_EQ(position.at("max")[c].get<double>(), (*high)[c]);
      }
      const auto indices = rows(primitive.at("indices"));
      EXPECT_EQ(indices.size() % 3, 0U);
      std::vector<bool> is_used(positions.size(), false);
      for (const auto& index : indices) {
        ASSERT_LT(index[0], static_cast<double>(positions.size()));
        is_used[static_cast<std::size_t>(index[0])] = true;
      }
      EXPECT_EQ(std::count(is_used.begin(), is_used.end(), false), 0) << "vertices that no triangle uses";
      if (primitive.contains("material")) {
        EXPECT_LT(primitive.at("material").get<std::size_t>(), json.at("materials").size());
      }
    }
  }
  for (const auto& node : json.value("nodes", nlohmann::json::array())) {
    if (node.contains("mesh")) {
      EXPECT_LT(node.at("mesh").get<std::size_t>(), mesh_count);
    }
  }
}

Glb read_sound(const Result<std::vector<std::uint8_t>>& bytes) {
  if (!bytes) {
    ADD_FAILURE() << bytes.error().message();
    return {};
  }
  Glb glb = Glb::parse(*bytes);
  glb.expect_sound();
  return glb;
}

std::vector<PlacedTriangle> triangles_of(const Glb& glb, std::size_t mesh, Point translation) {
  std::vector<PlacedTriangle> triangles;
  for (const auto& primitive : glb.json.at("meshes").at(mesh).at("primitives")) {
    const auto positions = glb.rows(primitive.at("attributes").at("POSITION"));
    const auto indices = glb.rows(primitive.at("indices"));
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      PlacedTriangle t{primitive.value("material", -1), {}};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& p = positions.at(static_cast<std::size_t>(indices[i + k][0]));
        t.corners[k] = {p[0] + translation[0], p[1] + translation[1], p[2] + translation[2]};
      }
      std::rotate(t.corners.begin(), std::min_element(t.corners.begin(), t.corners.end()), t.corners.end());
      triangles.push_back(t);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

}  // namespace meshlode::test
