// SPDX-License-Identifier: GPL-3.0-or-later
#include "draco_samples.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "gltf_builder.h"

namespace meshlode::testing {

DracoSample make_draco_sample(int n, bool edgebreaker, int speed, int quantization_bits) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2 * n * n);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  struct Corner {
    float p[3], n[3], t[2];
  };
  const auto corner = [&](int x, int y) {
    const float h = static_cast<float>((x * 7 + y * 13) % 5) * 0.1F;
    const float s = 1.0F / static_cast<float>(n);
    return Corner{{static_cast<float>(x), static_cast<float>(y), h},
                  {0.0F, 0.0F, 1.0F},
                  {static_cast<float>(x) * s, static_cast<float>(y) * s}};
  };
  int face = 0;
  const auto add = [&](const Corner& a, const Corner& b, const Corner& c) {
    const draco::FaceIndex f(static_cast<std::uint32_t>(face++));
    builder.SetAttributeValuesForFace(position, f, a.p, b.p, c.p);
    builder.SetAttributeValuesForFace(normal, f, a.n, b.n, c.n);
    builder.SetAttributeValuesForFace(uv, f, a.t, b.t, c.t);
  };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      add(corner(x, y), corner(x + 1, y), corner(x + 1, y + 1));
      add(corner(x, y), corner(x + 1, y + 1), corner(x, y + 1));
    }
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(speed, speed);
  if (quantization_bits > 0) {
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, quantization_bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 8);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 10);
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("draco could not encode");
  DracoSample out;
  out.bytes.assign(buffer.data(), buffer.data() + buffer.size());
  draco::DecoderBuffer in;
  in.Init(buffer.data(), buffer.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&in);
  if (!decoded.ok()) throw std::runtime_error("draco could not decode");
  const draco::Mesh& m = *decoded.value();
  out.point_count = m.num_points();
  out.face_count = m.num_faces();
  const draco::PointAttribute* p = m.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  out.position_id = p->unique_id();
  out.normal_id = m.GetNamedAttribute(draco::GeometryAttribute::NORMAL)->unique_id();
  out.uv_id = m.GetNamedAttribute(draco::GeometryAttribute::TEX_COORD)->unique_id();
  for (draco::PointIndex i(0); i < m.num_points(); ++i) {
    float xyz[3];
    p->GetMappedValue(i, xyz);
    out.positions.insert(out.positions.end(), xyz, xyz + 3);
  }
  return out;
}

namespace {

struct SeamedCorner {
  std::array<float, 3> position, normal;
  std::array<float, 2> uv, uv1;
  std::array<std::uint8_t, 4> color;
};

/// The corner at (x, y) of the quad (qx, qy): on seams it is another one in each quad beside them.
SeamedCorner seamed_corner(int n, int x, int y, int qx, int qy, float shift) {
  const float s = 1.0F / static_cast<float>(n);
  const auto fx = static_cast<float>(x);
  const auto fy = static_cast<float>(y);
  SeamedCorner c;
  c.position = {fx + shift, fy, static_cast<float>((x * 7 + y * 13) % 5) * 0.1F};
  c.normal = qx < n / 3 ? std::array{0.0F, 0.0F, 1.0F} : std::array{0.6F, 0.0F, 0.8F};
  c.uv = {fx * s * 0.5F + (qx >= n / 2 ? 0.5F : 0.0F), fy * s};
  c.uv1 = {fy * s, fx * s + (qy >= n / 2 ? 1.0F : 0.0F)};
  c.color = {static_cast<std::uint8_t>(9 * x), static_cast<std::uint8_t>(9 * y),
             static_cast<std::uint8_t>((qx + qy) % 2 == 0 ? 40 : 200), 255};
  return c;
}

std::vector<SeamedCorner> seamed_corners(int n) {
  std::vector<SeamedCorner> out;
  for (int patch = 0; patch < 2; ++patch) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        if (patch == 1 && x == n / 2 && y == n / 2) continue;
        const auto at = [&](int dx, int dy) {
          return seamed_corner(n, x + dx, y + dy, x, y, static_cast<float>(patch * (n + 2)));
        };
        for (const SeamedCorner& c : {at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)}) out.push_back(c);
      }
    }
  }
  return out;
}

std::string plain_glb(const std::vector<SeamedCorner>& corners) {
  std::vector<float> positions, normals, uvs, more_uvs;
  std::vector<std::uint8_t> colors;
  const auto add = [](auto& to, const auto& values) { to.insert(to.end(), values.begin(), values.end()); };
  for (const SeamedCorner& c : corners) {
    add(positions, c.position);
    add(normals, c.normal);
    add(uvs, c.uv);
    add(more_uvs, c.uv1);
    add(colors, c.color);
  }
  GltfBuilder b;
  b.floats(positions, "VEC3", 3);
  b.floats(normals, "VEC3", 3);
  b.floats(uvs, "VEC2", 2);
  b.floats(more_uvs, "VEC2", 2);
  b.array(colors, 5121, "VEC4", 4, ",\"normalized\":true");
  return b.glb(mesh_text("\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2,\"TEXCOORD_1\":3,\"COLOR_0\":4"));
}

}  // namespace

DracoPair make_draco_pair(int n, bool edgebreaker, int speed, int quantization_bits) {
  const std::vector<SeamedCorner> corners = seamed_corners(n);
  DracoPair out;
  out.face_count = static_cast<std::uint32_t>(corners.size() / 3);
  out.plain_glb = plain_glb(corners);
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(out.face_count));
  using draco::GeometryAttribute;
  const std::array<int, 5> ids{builder.AddAttribute(GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
                               builder.AddAttribute(GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32),
                               builder.AddAttribute(GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32),
                               builder.AddAttribute(GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32),
                               builder.AddAttribute(GeometryAttribute::COLOR, 4, draco::DT_UINT8)};
  for (std::uint32_t f = 0; f < out.face_count; ++f) {
    const SeamedCorner* c = &corners[3 * std::size_t{f}];
    const draco::FaceIndex face(f);
    builder.SetAttributeValuesForFace(ids[0], face, c[0].position.data(), c[1].position.data(), c[2].position.data());
    builder.SetAttributeValuesForFace(ids[1], face, c[0].normal.data(), c[1].normal.data(), c[2].normal.data());
    builder.SetAttributeValuesForFace(ids[2], face, c[0].uv.data(), c[1].uv.data(), c[2].uv.data());
    builder.SetAttributeValuesForFace(ids[3], face, c[0].uv1.data(), c[1].uv1.data(), c[2].uv1.data());
    builder.SetAttributeValuesForFace(ids[4], face, c[0].color.data(), c[1].color.data(), c[2].color.data());
  }
  const auto mesh = builder.Finalize();
  mesh->attribute(ids[4])->set_normalized(true);
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(speed, speed);
  if (quantization_bits > 0) {
    encoder.SetAttributeQuantization(GeometryAttribute::POSITION, quantization_bits);
    encoder.SetAttributeQuantization(GeometryAttribute::NORMAL, quantization_bits);
    encoder.SetAttributeQuantization(GeometryAttribute::TEX_COORD, quantization_bits);
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("draco could not encode");
  draco::DecoderBuffer in;
  in.Init(buffer.data(), buffer.size());
  const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&in);
  if (!decoded.ok()) throw std::runtime_error("draco could not decode");
  const std::size_t points = decoded.value()->num_points();  // the glTF's accessors have to say how many

  GltfBuilder b;
  const int view = b.view(std::vector<char>(buffer.data(), buffer.data() + buffer.size()));
  for (const char* type : {"VEC3", "VEC3", "VEC2", "VEC2"}) b.accessor(-1, 5126, points, type);
  b.accessor(-1, 5121, points, "VEC4", ",\"normalized\":true");
  b.accessor(-1, 5125, std::size_t{3} * out.face_count, "SCALAR");
  std::string attributes, draco_ids;
  const char* const names[] = {"POSITION", "NORMAL", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::string comma = i == 0 ? "\"" : ",\"";
    attributes += comma + names[i] + "\":" + std::to_string(i);
    draco_ids += comma + names[i] + "\":" + std::to_string(mesh->attribute(ids[i])->unique_id());
  }
  out.draco_glb = b.glb(mesh_text(attributes,
                                  ",\"indices\":5,\"extensions\":{\"KHR_draco_mesh_compression\":{"
                                  "\"bufferView\":" +
                                      std::to_string(view) + ",\"attributes\":{" + draco_ids + "}}}") +
                        ",\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],"
                        "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]");
  return out;
}

std::string make_draco_glb(const DracoSample& sample) {
  GltfBuilder b;
  const int view = b.view(sample.bytes);
  b.accessor(-1, 5126, sample.point_count, "VEC3");
  b.accessor(-1, 5126, sample.point_count, "VEC3");
  b.accessor(-1, 5126, sample.point_count, "VEC2");
  b.accessor(-1, 5125, sample.face_count * 3, "SCALAR");
  const std::string extension =
      ",\"indices\":3,\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":" + std::to_string(view) +
      ",\"attributes\":{\"POSITION\":" + std::to_string(sample.position_id) +
      ",\"NORMAL\":" + std::to_string(sample.normal_id) + ",\"TEXCOORD_0\":" + std::to_string(sample.uv_id) + "}}}";
  return b.glb(mesh_text("\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2", extension) +
               ",\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],"
               "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]");
}

}  // namespace meshlode::testing
