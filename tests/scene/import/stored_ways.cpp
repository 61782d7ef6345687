// SPDX-License-Identifier: GPL-3.0-or-later
#include "stored_ways.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "gltf_builder.h"
#include "meshopt_samples.h"

namespace meshlode::testing {

namespace {

/// Per vertex, as the smallest types that hold it; four numbers where three would not fill words of 4 bytes.
struct Field {
  std::vector<std::array<std::int16_t, 4>> positions;
  std::vector<std::array<std::int8_t, 4>> normals;
  std::vector<std::array<std::uint16_t, 2>> uvs;
  std::vector<std::uint32_t> indices;
};

Field make_field(int n) {
  Field out;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const int hill = (x - n / 2) * (x - n / 2) + (y - n / 3) * (y - n / 3);
      const int height = hill * 40 / (n * n) + (x * 7 + y * 13) % 5;
      out.positions.push_back(
          {static_cast<std::int16_t>(8 * x), static_cast<std::int16_t>(8 * y), static_cast<std::int16_t>(height), 0});
      out.normals.push_back(
          {static_cast<std::int8_t>((x * 11) % 41 - 20), static_cast<std::int8_t>((y * 5) % 31 - 15), 120, 0});
      out.uvs.push_back({static_cast<std::uint16_t>(x * 65535 / n), static_cast<std::uint16_t>(y * 65535 / n)});
    }
  }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      out.indices.insert(out.indices.end(), {at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      out.indices.insert(out.indices.end(), {at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return out;
}

/// `width` of each row's numbers, divided by `largest` as normalized ones are.
template <class Rows>
std::vector<float> floats_of(const Rows& rows, std::size_t width, double largest) {
  std::vector<float> out;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < width; ++c) out.push_back(static_cast<float>(row[c] / largest));
  }
  return out;
}

template <class Row>
std::span<const std::uint8_t> bytes_of(const std::vector<Row>& rows) {
  return {reinterpret_cast<const std::uint8_t*>(rows.data()), rows.size() * sizeof(Row)};
}

const std::string kNormalized = ",\"normalized\":true";

std::string finish(const GltfBuilder& b, const std::string& extension = "") {
  return b.glb(mesh_text("\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2", ",\"indices\":3,\"material\":0" + extension) +
               ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],\"textures\":[{}]");
}

std::string store_plain(const Field& field) {
  GltfBuilder b;
  b.floats(floats_of(field.positions, 3, 1.0), "VEC3", 3);
  b.floats(floats_of(field.normals, 3, 127.0), "VEC3", 3);
  b.floats(floats_of(field.uvs, 2, 65535.0), "VEC2", 2);
  b.array(field.indices, 5125, "SCALAR", 1);
  return finish(b);
}

std::string store_quantized(const Field& field) {
  const std::size_t count = field.positions.size();
  GltfBuilder b;
  b.accessor(b.view(field.positions, 8), 5122, count, "VEC3");
  b.accessor(b.view(field.normals, 4), 5120, count, "VEC3", kNormalized);
  b.accessor(b.view(field.uvs), 5123, count, "VEC2", kNormalized);
  b.array(std::vector<std::uint16_t>(field.indices.begin(), field.indices.end()), 5123, "SCALAR", 1);
  return finish(b);
}

/// \param is_quantized the small types, with indices as a sequence of 16 bits; else floats and triangles
std::string store_meshopt(const Field& field, bool is_quantized) {
  const std::size_t count = field.positions.size();
  GltfBuilder b;
  const auto attribute = [&](std::span<const std::uint8_t> bytes) {
    return b.meshopt_view(encode_meshopt_attributes(bytes, bytes.size() / count), count, bytes.size() / count,
                          "ATTRIBUTES");
  };
  if (is_quantized) {
    b.accessor(attribute(bytes_of(field.positions)), 5122, count, "VEC3");
    b.accessor(attribute(bytes_of(field.normals)), 5120, count, "VEC3", kNormalized);
    b.accessor(attribute(bytes_of(field.uvs)), 5123, count, "VEC2", kNormalized);
    b.accessor(b.meshopt_view(encode_meshopt_indices(field.indices), field.indices.size(), 2, "INDICES"), 5123,
               field.indices.size(), "SCALAR");
    return finish(b);
  }
  b.accessor(attribute(bytes_of(floats_of(field.positions, 3, 1.0))), 5126, count, "VEC3");
  b.accessor(attribute(bytes_of(floats_of(field.normals, 3, 127.0))), 5126, count, "VEC3");
  b.accessor(attribute(bytes_of(floats_of(field.uvs, 2, 65535.0))), 5126, count, "VEC2");
  b.accessor(b.meshopt_view(encode_meshopt_triangles(field.indices), field.indices.size(), 4, "TRIANGLES"), 5125,
             field.indices.size(), "SCALAR");
  return finish(b);
}

/// With every filter: `bits` of the largest coordinate of each vertex, normals in two bytes.
std::string store_filtered(const Field& field, int bits) {
  const std::size_t count = field.positions.size();
  GltfBuilder b;
  const auto attribute = [&](const Stream& elements, std::size_t stride, const std::string& filter) {
    return b.meshopt_view(encode_meshopt_attributes(elements, stride), count, stride, "ATTRIBUTES", filter);
  };
  b.accessor(attribute(filter_exponential(floats_of(field.positions, 3, 1.0), 12, bits), 12, "EXPONENTIAL"), 5126,
             count, "VEC3");
  b.accessor(attribute(filter_octahedral(floats_of(field.normals, 4, 127.0), 4, 8), 4, "OCTAHEDRAL"), 5120, count,
             "VEC3", kNormalized);
  b.accessor(attribute(filter_exponential(floats_of(field.uvs, 2, 65535.0), 8, 16), 8, "EXPONENTIAL"), 5126, count,
             "VEC2");
  b.accessor(b.meshopt_view(encode_meshopt_triangles(field.indices), field.indices.size(), 2, "TRIANGLES"), 5123,
             field.indices.size(), "SCALAR");
  return finish(b);
}

/// \param bits of positions; 0: floats stay as they are
std::string store_draco(const Field& field, bool is_edgebreaker, int bits) {
  using draco::GeometryAttribute;
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(field.indices.size() / 3));
  const std::array<int, 3> ids{builder.AddAttribute(GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
                               builder.AddAttribute(GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32),
                               builder.AddAttribute(GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32)};
  const std::array<std::vector<float>, 3> values{floats_of(field.positions, 3, 1.0), floats_of(field.normals, 3, 127.0),
                                                 floats_of(field.uvs, 2, 65535.0)};
  const std::array<std::size_t, 3> widths{3, 3, 2};
  for (std::uint32_t f = 0; f < field.indices.size() / 3; ++f) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto corner = [&](std::size_t c) { return &values[a][widths[a] * field.indices[3 * std::size_t{f} + c]]; };
      builder.SetAttributeValuesForFace(ids[a], draco::FaceIndex(f), corner(0), corner(1), corner(2));
    }
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(is_edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(5, 5);
  if (bits > 0) {
    encoder.SetAttributeQuantization(GeometryAttribute::POSITION, bits);
    encoder.SetAttributeQuantization(GeometryAttribute::NORMAL, 10);
    encoder.SetAttributeQuantization(GeometryAttribute::TEX_COORD, 14);
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("draco could not encode");
  draco::DecoderBuffer in;
  in.Init(buffer.data(), buffer.size());
  const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&in);
  if (!decoded.ok()) throw std::runtime_error("draco could not decode");
  const std::size_t points = decoded.value()->num_points();  // the accessors have to say how many
  GltfBuilder b;
  const int view = b.view(std::vector<char>(buffer.data(), buffer.data() + buffer.size()));
  for (const char* type : {"VEC3", "VEC3", "VEC2"}) b.accessor(-1, 5126, points, type);
  b.accessor(-1, 5125, field.indices.size(), "SCALAR");
  const auto id = [&](std::size_t a) { return std::to_string(mesh->attribute(ids[a])->unique_id()); };
  return finish(b, ",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":" + std::to_string(view) +
                       ",\"attributes\":{\"POSITION\":" + id(0) + ",\"NORMAL\":" + id(1) + ",\"TEXCOORD_0\":" + id(2) +
                       "}}}");
}

}  // namespace

std::vector<StoredWay> store_in_all_ways(int n) {
  const Field field = make_field(n);
  const double size = 8.0 * n;
  constexpr int kDracoBits = 12, kFilterBits = 15;
  return {{"plain", store_plain(field)},
          {"quantized", store_quantized(field)},
          {"Draco, edgebreaker", store_draco(field, true, 0)},
          {"Draco, sequential", store_draco(field, false, 0)},
          {"meshopt", store_meshopt(field, false)},
          {"meshopt, quantized", store_meshopt(field, true)},
          {"Draco, 12 bits", store_draco(field, true, kDracoBits), size / ((1 << kDracoBits) - 1)},
          {"meshopt, filtered", store_filtered(field, kFilterBits), 2.0 * size / (1 << (kFilterBits - 1))}};
}

}  // namespace meshlode::testing
