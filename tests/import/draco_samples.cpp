// SPDX-License-Identifier: GPL-3.0-or-later
#include "draco_samples.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <stdexcept>

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
