// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutant_seeds.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "draco_samples.h"
#include "gltf_builder.h"
#include "meshopt_samples.h"

namespace meshlode::testing {

namespace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t v = static_cast<std::uint32_t>(bytes[i]) << 16U;
    if (i + 1 < bytes.size()) v |= static_cast<std::uint32_t>(bytes[i + 1]) << 8U;
    if (i + 2 < bytes.size()) v |= bytes[i + 2];
    for (unsigned c = 0; c < 4; ++c) out += i + c > bytes.size() ? '=' : alphabet[v >> (18U - 6U * c) & 63U];
  }
  return out;
}

/// Uses most of what a glTF can hold: sparse, strided and quantized accessors, strips, materials, animation.
void fill_rich(GltfBuilder& b, std::string& rest) {
  b.floats(kSquare, "VEC3", 3);                               // 0
  b.array(kSquareIndices, 5123, "SCALAR", 1);                 // 1
  b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);  // 2
  b.accessor(b.view<std::uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 65535}, 4), 5123, 4, "VEC2",
             ",\"normalized\":true");  // 3
  const int indices = b.view<std::uint8_t>({1, 3});
  const int values = b.view<float>({5, 6, 7, 8, 9, 10});
  b.accessor(0, 5126, 4, "VEC3",
             ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" + std::to_string(indices) +
                 ",\"componentType\":5121},\"values\":{\"bufferView\":" + std::to_string(values) + "}}");  // 4
  b.accessor(b.view<std::int8_t>({0, 0, 0, 0, 127, 0, 0, 0, 127, 127, 0, 0, 0, 127, 0, 0}, 4), 5120, 4, "VEC3",
             ",\"normalized\":true");       // 5
  b.floats({0, 1}, "SCALAR", 1);            // 6
  b.floats({0, 0, 0, 1, 2, 3}, "VEC3", 3);  // 7
  const int image = b.view<std::uint8_t>({0x89, 'P', 'N', 'G', 0, 1, 2, 3});
  rest =
      "\"meshes\":[{\"name\":\"a\",\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":2,\"TEXCOORD_0\":3},"
      "\"indices\":1,\"material\":0},{\"attributes\":{\"POSITION\":4},\"mode\":5,\"material\":1}]},"
      "{\"primitives\":[{\"attributes\":{\"POSITION\":5,\"COLOR_0\":2},\"mode\":6,\"targets\":[{\"POSITION\":0}]}]}],"
      "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":0},"
      "\"baseColorFactor\":[1,0.5,0.25,1]},\"alphaMode\":\"BLEND\"},{\"extensions\":{\"KHR_materials_clearcoat\":{"
      "\"clearcoatTexture\":{\"index\":1,\"extensions\":{\"KHR_texture_transform\":{\"texCoord\":1,\"scale\":[2,2]}}}}}"
      "}],"
      "\"textures\":[{\"source\":0,\"sampler\":0},{\"extensions\":{\"KHR_texture_basisu\":{\"source\":0}}}],"
      "\"samplers\":[{}],"
      "\"images\":[{\"bufferView\":" +
      std::to_string(image) +
      ",\"mimeType\":\"image/png\"}],\"nodes\":[{\"children\":[1,2],\"scale\":[2,2,2]},{\"mesh\":0,\"matrix\":[1,0,0,0,"
      "0,1,0,0,0,0,1,0,5,6,7,1]},{\"mesh\":1,\"rotation\":[0,0,0,1],\"translation\":[1,2,3],\"skin\":0}],"
      "\"skins\":[{\"joints\":[0]}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0,\"animations\":[{\"samplers\":[{\"input\":"
      "6,"
      "\"output\":7}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"translation\"}}]}]";
}

/// Two skins on one mesh, a strip with restart values, colours of whole numbers.
std::string make_skinned_seed() {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);                                                              // 0
  b.array<std::uint8_t>({0, 1, 2, 255, 2, 1, 3, 0}, 5121, "SCALAR", 1);                      // 1
  b.array<std::uint8_t>({0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1, 1, 0, 0}, 5121, "VEC4", 4);  // 2
  b.floats({1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 0, 1, 0, 0, 0.25F, 0.25F, 0.5F, 0}, "VEC4", 4);    // 3
  b.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1}, "MAT4",
           16);                                                                                     // 4
  b.array<std::uint8_t>({139, 0, 255, 0, 1, 0, 0, 0, 51, 255, 0, 0, 9, 9, 9, 9}, 5121, "VEC4", 4);  // 5
  return b.glb(
      "\"extensionsUsed\":[\"KHR_mesh_primitive_restart\"],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":"
      "0,"
      "\"NORMAL\":0,\"JOINTS_0\":2,\"WEIGHTS_0\":3,\"COLOR_0\":5},\"indices\":1,\"mode\":5}]}],\"nodes\":[{\"mesh\":0,"
      "\"skin\":0},{\"mesh\":0,\"skin\":1,\"extras\":1},{\"translation\":[1,2,3],\"children\":[3,0]},{\"scale\":[1,-2,"
      "1]}],"
      "\"skins\":[{\"joints\":[2,3],\"inverseBindMatrices\":4},{\"joints\":[3,2]}],\"scenes\":[{\"nodes\":[1,2]}],"
      "\"scene\":0");
}

void add_model(std::vector<SeedFile>& seeds, const std::string& folder, const std::string& name) {
  std::ifstream in(folder + "/" + name, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (bytes.empty()) return;
  seeds.push_back({name.substr(name.find_last_of('/') + 1), std::move(bytes)});
}

/// What programs write beyond plain triangles.
void add_polygon_seeds(std::vector<SeedFile>& seeds) {
  seeds.push_back(
      {"wedges.ply",
       "ply\rformat ascii 1.0\rcomment TextureFile a.png\relement vertex 4\rproperty float x\r"
       "property float y\rproperty float z\rproperty uchar quality\relement face 2\r"
       "property list uchar int vertex_indices\rproperty list uchar float texcoord\rproperty int texnumber\r"
       "property uchar red\rproperty uchar green\rproperty uchar blue\rend_header\r0 0 0 1\r1 0 0 2\r"
       "1 1 0 3\r0 1 0 4\r3 0 1 2 6 0 0 1 0 1 1 0 9 8 7\r3 0 2 3 0 -1 1 2 3 4 5\r"});
  seeds.push_back({"strips.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                   "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
                   "6 0 1 2 -1 2 3\n"});
  seeds.push_back({"no_faces.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\n"
                   "property float y\nproperty float z\nproperty float u\nproperty float v\nelement face 0\n"
                   "property list uchar int vertex_indices\nproperty int texnumber\nelement tristrips 1\n"
                   "property list int int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n1 1 0 1 1\n"
                   "4 0 1 2 3\n"});
  seeds.push_back(
      {"frame.obj",
       "mtllib a.mtl\nv 0 0 0\nv 4 0 0 1 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\nvt 0 0\n"
       "vn 0 0 1\no one\ng part\ns 1\nusemtl m\nf 1/1 2/1 3/1 4/1 1/1 5/1 6/1 7/1 8/1 5/1\no two\n"
       "f 5//1 8//1 \\\n 7//1\n#mtl\nnewmtl m\nKd 1 0 0\nKe 2 1 0\nTr 1\nPr 0.5\nmap_Kd -s 1 1 1 a.png\n"
       "map_d a.png\nnorm a.png\nmap_Pr a.png\nmap_Pm a.png\nnewmtl n\nd 0.5\nillum 2\n"});
  std::string stl = "COLOR=" + std::string("\xFF\x80\0\xFF", 4);
  stl.resize(84, '\0');
  stl.append(12, '\0');
  for (const float f : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F}) {
    stl.append(reinterpret_cast<const char*>(&f), 4);
  }
  seeds.push_back({"colored.stl", stl + "\x1F\x80rest"});
  seeds.push_back({"capitals.stl",
                   "\xEF\xBB\xBF SOLID A\rFACET NORMAL 0 0 -1.#IND\rOUTER LOOP\rVERTEX 0 0 0\rVERTEX 1 0 0\r"
                   "VERTEX 0 1 0\rEND LOOP\rENDFACET\rENDSOLID A\r"});
}

}  // namespace

std::vector<SeedFile> make_seed_files() {
  std::vector<SeedFile> seeds;
  GltfBuilder rich;
  std::string rest;
  fill_rich(rich, rest);
  seeds.push_back({"rich.glb", rich.glb(rest)});
  seeds.push_back(
      {"rich.gltf", rich.json(rest, ",\"uri\":\"data:application/octet-stream;base64," + base64(rich.bin) + "\"")});
  for (const bool edgebreaker : {true, false}) {
    for (const int speed : {0, 5, 10}) {
      seeds.push_back({"draco.glb", make_draco_glb(make_draco_sample(5, edgebreaker, speed, speed == 5 ? 0 : 11))});
    }
  }
  seeds.push_back({"meshopt.glb", make_meshopt_pair(5).meshopt_glb});
  seeds.push_back({"filtered.glb", make_filtered_glb(5)});
  seeds.push_back({"skinned.glb", make_skinned_seed()});
  GltfBuilder many;
  many.floats(kSquare, "VEC3", 3);
  many.floats({1, 2, 3, 4, 5, 6}, "VEC3", 3);
  many.array(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 23170, 23170}, 5122, "VEC4", 4, ",\"normalized\":true");
  seeds.push_back(
      {"instances.glb", many.glb("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                                 "\"nodes\":[{\"mesh\":0,\"children\":[1],\"name\":\"tree\",\"extensions\":{"
                                 "\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":1,"
                                 "\"ROTATION\":2,\"SCALE\":1,\"_ID\":1}}}},{}]")});
  seeds.push_back({"square.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                   "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
                   "property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n1 1 0 7 8 9\n"
                   "0 1 0 10 11 12\n3 0 1 2\n4 0 1 2 3\n"});
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const float f : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F}) {
    binary.append(reinterpret_cast<const char*>(&f), 4);
  }
  binary += '\3';
  for (const int i : {0, 1, 2}) binary.append(reinterpret_cast<const char*>(&i), 4);
  seeds.push_back({"binary.ply", binary});
  seeds.push_back({"seam.obj",
                   "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvt 0 0\nvt 1 0\nvt 1 1\n"
                   "vn 0 0 1\nusemtl b\nf 1/1/1 2/2/1 3/3/1\nf -4/3/-1 -2/1/1 -1/2/1\n"});
  add_polygon_seeds(seeds);
  seeds.push_back({"text.stl",
                   "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                   "endfacet\nendsolid a\n"});
  std::string stl(80, '\0');
  const std::uint32_t one = 1;
  stl.append(reinterpret_cast<const char*>(&one), 4);
  stl.append(12, '\0');
  for (const float f : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F}) {
    stl.append(reinterpret_cast<const char*>(&f), 4);
  }
  stl.append(2, '\0');
  seeds.push_back({"binary.stl", stl});
  if (const char* folder = std::getenv("MESHLODE_MODELS")) {
    for (const std::string name :
         {"draco/Box/glTF_Binary/Box_Draco.glb", "draco/Box/glTF_Binary/Box.glb", "GltfPrimitives/gltf_primitives.glb",
          "SimpleSkin/SimpleSkin.gltf", "khronos/SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf"}) {
      add_model(seeds, folder, name);
    }
  }
  return seeds;
}

}  // namespace meshlode::testing
