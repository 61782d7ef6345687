// SPDX-License-Identifier: GPL-3.0-or-later
// MTL as its users write it: opacity of every spelling, masks, normal, emissive and metallic-roughness textures.
#include <gtest/gtest.h>

#include "polygon_support.h"
#include "scene/import/json.h"

namespace meshlode::testing {
namespace {

/// The head of a PNG: of colour type 2 without alpha, of 6 with.
std::string png(char type) {
  std::string bytes("\x89PNG\r\n\x1A\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08", 25);
  return bytes + type + std::string(7, '\0') + std::string("\0\0\0\0IDAT\0\0\0\0", 12);
}

class MtlAsWritten : public PolygonFiles {
 protected:
  /// One triangle of each material.
  Result<scene::Scene> read_mtl(const std::string& mtl, const std::vector<std::string>& names = {"a"}) {
    folder_.write("rgb.png", png(2));
    folder_.write("rgba.png", png(6));
    folder_.write("other.png", png(2) + " ");
    folder_.write("a.mtl", mtl);
    std::string obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    for (const std::string& name : names) obj += "usemtl " + name + "\nf 1/1 2/2 3/3\n";
    return read("a.obj", obj);
  }
  static std::string material(const Result<scene::Scene>& scene, std::size_t i = 0) {
    return scene::dump_json(scene::parse_json(scene->document)->items("materials")[i]);
  }
};

TEST_F(MtlAsWritten, LineEndsMarksAndCaseAreAnyones) {
  for (const std::string text :
       {"newmtl a\nkd 1 0 0\nMAP_KD rgb.png\n", "\xEF\xBB\xBFnewmtl a\rKd 1 0 0\rmap_Kd rgb.png \f\r",
        "newmtl\ta\r\nKd\t1 0 0\r\nmap_kd \"rgb.png\"\r\n"}) {
    const auto scene = read_mtl(text);
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(scene->materials[0].base_color, Vec4f(1, 0, 0, 1));
    EXPECT_EQ(scene->materials[0].base_color_texture, 0U);
    EXPECT_EQ(all_left_out(*scene), "");
  }
}

TEST_F(MtlAsWritten, DCountsBeforeTrAndTrOneAloneIsOpaque) {
  const auto scene = read_mtl(
      "newmtl a\nd 1\nTr 1\nnewmtl b\nTr 1.000\nd 0.25\nnewmtl c\nTr 1.000\nnewmtl e\nTr 0.25\nnewmtl "
      "f\nd 0\nTr 0\n",
      {"a", "b", "c", "e", "f"});
  ASSERT_TRUE(scene) << describe(scene);
  const float alphas[] = {1, 0.25F, 1, 0.75F, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(scene->materials[i].base_color.w, alphas[i]) << i;
    EXPECT_EQ(scene->materials[i].alpha_mode == scene::AlphaMode::kBlend, alphas[i] < 1) << i;
  }
  EXPECT_EQ(all_left_out(*scene), "MTL Tr 1 of 1 material: nobody would see them, so that they are opaque: c; ");
}

TEST_F(MtlAsWritten, AMaskInTheColourTextureIsItsAlpha) {
  const auto scene = read_mtl(
      "newmtl a\nmap_Kd rgba.png\nmap_d ./rgba.png\nnewmtl b\nd 0.5\nmap_Kd rgba.png\nmap_d rgba.png\n", {"a", "b"});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->materials[0].alpha_mode, scene::AlphaMode::kMask);
  EXPECT_EQ(scene->materials[1].alpha_mode, scene::AlphaMode::kBlend);
  EXPECT_NE(material(scene).find("\"alphaMode\":\"MASK\""), std::string::npos) << material(scene);
  EXPECT_EQ(scene->blobs.size(), 1U);
  EXPECT_EQ(all_left_out(*scene), "");
  const auto lost = read_mtl(
      "newmtl a\nmap_Kd rgb.png\nmap_d rgb.png\nnewmtl b\nmap_Kd rgb.png\nmap_d other.png\n"
      "newmtl c\nmap_d rgba.png\n",
      {"a", "b", "c"});
  ASSERT_TRUE(lost) << describe(lost);
  EXPECT_EQ(lost->materials[1].alpha_mode, scene::AlphaMode::kOpaque);
  EXPECT_EQ(
      all_left_out(*lost),
      "map_d other.png: glTF has the alpha in the base colour texture, and this is another file; map_d rgb.png: the "
      "image has no alpha channel; map_d rgba.png: glTF has the alpha in the base colour texture, and this is another "
      "file; ");
}

TEST_F(MtlAsWritten, NormalEmissiveRoughAndMetalAreMetallicRoughness) {
  const auto scene = read_mtl(
      "newmtl a\nmap_Kd rgb.png\nnorm other.png\nKe 0.5 0.25 0\nmap_Ke rgba.png\nPr 0.5\nPm 0.25\nmap_Pr "
      "rgb.png\nmap_Pm "
      "rgb.png\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(material(scene),
            "{\"name\":\"a\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1.0,1.0,1.0,1.0],\"baseColorTexture\":{"
            "\"index\":0},\"metallicFactor\":0.25,\"roughnessFactor\":0.5,\"metallicRoughnessTexture\":{\"index\":0}},"
            "\"normalTexture\":{\"index\":1},\"emissiveTexture\":{\"index\":2},\"emissiveFactor\":[0.5,0.25,0.0]}");
  const scene::SceneMaterial& m = scene->materials[0];
  EXPECT_TRUE(m.needs_tangents);
  EXPECT_EQ(m.uv_sets_used, 1U);
  std::vector<scene::TextureRole> roles;
  for (const scene::TextureUse& use : m.textures) roles.push_back(use.role);
  EXPECT_EQ(roles, (std::vector{scene::TextureRole::kBaseColor, scene::TextureRole::kMetallicRoughness,
                                scene::TextureRole::kNormal, scene::TextureRole::kEmissive}));
  EXPECT_EQ(m.textures[2].blob, 1U);
  EXPECT_EQ(all_left_out(*scene), "");
  const auto references = scene::list_references(folder_.path() / "a.obj");
  ASSERT_TRUE(references);
  EXPECT_EQ(references->size(), 4U);  // the library and three images
}

TEST_F(MtlAsWritten, EmissionAboveOneIsAStrength) {
  const auto scene =
      read_mtl("newmtl a\nKe 2 1 0\nnewmtl b\nKe 0 0 0\nnewmtl c\nKe 0 0 0\nmap_Ke rgb.png\n", {"a", "b", "c"});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_NE(material(scene, 0).find("\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":2.0}},"
                                    "\"emissiveFactor\":[1.0,0.5,0.0]"),
            std::string::npos)
      << material(scene, 0);
  EXPECT_EQ(material(scene, 1).find("emissive"), std::string::npos);
  EXPECT_NE(material(scene, 2).find("\"emissiveFactor\":[1.0,1.0,1.0]"), std::string::npos);
  EXPECT_NE(scene->document.find("\"extensionsUsed\":[\"KHR_materials_emissive_strength\"]"), std::string::npos);
}

TEST_F(MtlAsWritten, RoughnessTexturesStandWhereNothingOfMetalIsLost) {
  const auto scene = read_mtl(
      "newmtl a\nmap_Pr rgb.png\nnewmtl b\nPm 1\nmap_Pr rgb.png\nnewmtl c\nmap_Pr rgb.png\nmap_Pm "
      "other.png\nnewmtl e\nmap_Pm rgba.png\n",
      {"a", "b", "c", "e"});
  ASSERT_TRUE(scene) << describe(scene);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scene->materials[i].textures.size(), i == 0 ? 1U : 0U) << i;
  EXPECT_EQ(all_left_out(*scene),
            "map_Pm other.png: glTF has roughness and metalness in one image; map_Pm rgba.png: glTF has roughness and "
            "metalness in one image; map_Pr rgb.png: glTF has roughness and metalness in one image; ");
}

TEST_F(MtlAsWritten, WhatIsNotReadIsNamedOnceWithACount) {
  const auto scene = read_mtl(
      "newmtl a\nKa 1 1 1\nKs 0 0 0\nNs 10\nillum 2\nmap_Bump -bm 2 rgb.png\nbump rgb.png\nrefl x\nnewmtl "
      "b\nKs 1 1 1\nNs 3\nmap_Kd -s 1 1 1 rgb.png\nKd red\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(
      all_left_out(*scene),
      "MTL Kd without a value that makes sense: 1 line passed over; MTL bump: 1 line passed over; MTL map_Bump: 1 line "
      "passed over; MTL option -s of map_Kd: 1 line passed over; MTL refl: 1 line passed over; MTL Ka Ks Ns illum: 6 "
      "lines of another shading than glTF's; ");
}

TEST_F(MtlAsWritten, HostileBytesEnd) {
  for (const std::string& mtl :
       {std::string(), std::string("newmtl"), std::string("newmtl a\nmap_Kd\nmap_d -s\nKe -1 nan\nKe 1e999\n"),
        std::string(5000, '\\'), std::string("newmtl a\nd 1e999\nTr -1.#IND\nPr -5\nPm 9\n")}) {
    EXPECT_TRUE(read_mtl(mtl)) << mtl.substr(0, 40);
  }
  std::string many = "newmtl a\n";
  for (int i = 0; i < 100000; ++i) many += "k" + std::to_string(i) + " 1\n";
  const auto scene = read_mtl(many);
  ASSERT_TRUE(scene);
  EXPECT_LT(scene->left_out.size(), 300U);
}

TEST_F(MtlAsWritten, ZerosThatWritersAlwaysWriteDoNotSwitchAMapOff) {
  const auto scene =
      read_mtl("newmtl a\nPr 0\nPm 0\nmap_Pr rgb.png\nmap_Pm rgb.png\nnewmtl b\nPr 0\nPm 0\n", {"a", "b"});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_NE(material(scene).find("\"metallicFactor\":1.0,\"metallicRoughnessTexture\""), std::string::npos)
      << material(scene);
  EXPECT_NE(material(scene, 1).find("\"metallicFactor\":0.0,\"roughnessFactor\":0.0"), std::string::npos)
      << material(scene, 1);
}

TEST_F(MtlAsWritten, ValuesThatAreClampedAreCounted) {
  const auto scene = read_mtl("newmtl a\nKd 2 0 0\nPr 7\nnewmtl b\nKd 0 -1 0\nd 1\n", {"a", "b"});
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(all_left_out(*scene),
            "MTL Kd: 2 lines with a value out of range, which is clamped; MTL Pr: 1 line with a value out of range, "
            "which is clamped; ");
}

}  // namespace
}  // namespace meshlode::testing
