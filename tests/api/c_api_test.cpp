// SPDX-License-Identifier: GPL-3.0-or-later
// <meshlode/meshlode.h>: what C sees is what C++ sees, errors are codes with text, and nothing is written beyond what
// the caller gave.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <meshlode/build.h>
#include <meshlode/meshlode.h>
#include <meshlode/runtime.h>

#include "arrays.h"

namespace meshlode {
namespace {

using test::Arrays;

const std::vector<std::uint8_t>& sphere_bytes(format::Codec codec) {
  static std::map<format::Codec, std::vector<std::uint8_t>> made;
  std::vector<std::uint8_t>& bytes = made[codec];
  if (bytes.empty()) {
    const Arrays arrays(lab::with_smooth_normals(lab::make_sphere(48)));
    std::vector<float> colors;
    for (const float c : arrays.positions) {
      colors.push_back(0.5F + 0.25F * c);
      if (colors.size() % 4 == 3) colors.push_back(1.0F);
    }
    PrimitiveInput primitive = arrays.primitive();
    primitive.colors = colors;
    BuildOptions options;
    options.codec = format::is_written(codec) ? codec : format::Codec::kNone;
    auto built = test::build_one(primitive, options);
    if (built) bytes = test::stored_as(std::move(*built), codec);
  }
  return bytes;
}

class CApi : public testing::TestWithParam<format::Codec> {
 protected:
  void SetUp() override {
    bytes_ = sphere_bytes(GetParam());
    ASSERT_FALSE(bytes_.empty());
    ASSERT_EQ(meshlode_open_buffer(bytes_.data(), bytes_.size(), &asset_, &error_), MESHLODE_OK) << error_.text;
  }
  void TearDown() override { meshlode_close(asset_); }
  std::uint32_t page_count() const {
    std::uint32_t count = 0;
    (void)meshlode_pages(asset_, &count);
    return count;
  }
  /// A page in memory of exactly its size, so that the address sanitizer sees the end.
  std::vector<std::uint32_t> load(std::uint32_t page) {
    std::uint32_t count = 0;
    const std::uint32_t size = meshlode_pages(asset_, &count)[page].bytes;
    std::vector<std::uint32_t> words((size + 3) / 4);
    EXPECT_EQ(meshlode_load_page(asset_, page, words.data(), size, &error_), MESHLODE_OK) << error_.text;
    return words;
  }

  std::vector<std::uint8_t> bytes_;
  meshlode_asset* asset_ = nullptr;
  meshlode_error error_{};
};

TEST_P(CApi, TablesAreThoseOfTheFile) {
  const auto expected = AssetFile::view(bytes_);
  ASSERT_TRUE(expected.ok());
  const auto same = [&](const auto* records, std::uint32_t count, auto view) {
    ASSERT_EQ(count, view.size());
    if (GetParam() == format::Codec::kNone) {
      EXPECT_EQ(static_cast<const void*>(records), static_cast<const void*>(view.data())) << "no copy";
    }
    if (!view.empty()) {
      EXPECT_EQ(std::memcmp(records, view.data(), view.size_bytes()), 0);
    }
  };
  std::uint32_t count = 0;
  const meshlode_mesh* meshes = meshlode_meshes(asset_, &count);
  same(meshes, count, expected->meshes());
  const meshlode_group* groups = meshlode_groups(asset_, &count);
  same(groups, count, expected->groups());
  const meshlode_cluster* clusters = meshlode_clusters(asset_, &count);
  same(clusters, count, expected->clusters());
  const meshlode_node* nodes = meshlode_nodes(asset_, &count);
  same(nodes, count, expected->nodes());
  const meshlode_page* pages = meshlode_pages(asset_, &count);
  same(pages, count, expected->pages());
  const meshlode_instance* instances = meshlode_instances(asset_, &count);
  same(instances, count, expected->instances());
  const meshlode_material* materials = meshlode_materials(asset_, &count);
  same(materials, count, expected->materials());
  (void)meshlode_blobs(asset_, &count);
  EXPECT_EQ(count, 0U);

  EXPECT_EQ(meshes[0].has_color, 1U);
  EXPECT_EQ(meshes[0].normal_mode, static_cast<std::uint32_t>(MESHLODE_NORMALS_STORED));
  EXPECT_EQ(meshes[0].source_triangles, expected->meshes()[0].source_triangles);
  EXPECT_EQ(groups[0].error, MESHLODE_INFINITE_ERROR) << "the first group of a mesh is terminal";
  EXPECT_EQ(groups[0].flags & MESHLODE_GROUP_TERMINAL, MESHLODE_GROUP_TERMINAL);
  std::size_t size = 0;
  const char* meta = meshlode_meta_json(asset_, &size);
  EXPECT_EQ(std::string_view(meta, size), expected->meta_json());
  const char* scene = meshlode_scene_json(asset_, &size);
  EXPECT_EQ(std::string_view(scene, size), expected->scene_json());
  const char* name = meshlode_text(asset_, meshes[0].name, &size);
  EXPECT_EQ(std::string_view(name, size), expected->text(expected->meshes()[0].name));
  EXPECT_EQ(meshlode_text(asset_, {0xFFFFFFFFU, 1}, &size), nullptr);
  EXPECT_EQ(meshlode_text(asset_, {0, 0xFFFFFFFFU}, &size), nullptr);
  EXPECT_EQ(size, 0U);
  EXPECT_EQ(meshlode_blob_bytes(asset_, 0, &size), nullptr);
  EXPECT_EQ(meshlode_format_version(), format::kVersion);
  EXPECT_EQ(meshlode_version(), static_cast<std::uint32_t>(MESHLODE_VERSION));
}

TEST_P(CApi, CutsAreThoseOfTheRule) {
  const auto expected = AssetFile::view(bytes_);
  ASSERT_TRUE(expected.ok());
  for (const double distance : {1.2, 3.0, 30.0}) {
    View point;
    point.eye = {0.0, 0.0, distance};
    const auto drawn = expected->select_view(point, 1.0);
    ASSERT_TRUE(drawn.ok());
    const meshlode_view view = {{0.0, 0.0, distance}, 0, point.fovy_radians, 1.0, point.near_distance,
                                point.height_px,      0};
    std::size_t count = 0;
    EXPECT_EQ(meshlode_select_view(asset_, &view, 1.0, nullptr, 0, &count, &error_), MESHLODE_TOO_SMALL);
    EXPECT_NE(error_.text[0], '\0');
    ASSERT_EQ(count, drawn->size());
    std::vector<meshlode_draw_item> items(count + 1, {7, 7});
    EXPECT_EQ(meshlode_select_view(asset_, &view, 1.0, items.data(), count, &count, &error_), MESHLODE_OK);
    EXPECT_EQ(error_.text[0], '\0');
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(items[i].instance, (*drawn)[i].instance);
      EXPECT_EQ(items[i].cluster, (*drawn)[i].cluster);
    }
    EXPECT_EQ(items[count].cluster, 7U) << "nothing behind the capacity";
  }
  for (const double error : {0.0, 0.01, 1e9}) {
    const auto cut = expected->select_uniform(0, error);
    ASSERT_TRUE(cut.ok());
    std::vector<std::uint32_t> clusters(cut->clusters.size());
    std::size_t count = 0;
    double stored = -1.0;
    ASSERT_EQ(meshlode_select_uniform(asset_, 0, 0, error, clusters.data(), clusters.size(), &count, &stored, nullptr),
              MESHLODE_OK);
    EXPECT_EQ(clusters, cut->clusters);
    EXPECT_EQ(stored, cut->stored_error);
    if (count < 2) continue;
    EXPECT_EQ(meshlode_select_uniform(asset_, 0, 0, error, clusters.data(), 1, &count, nullptr, nullptr),
              MESHLODE_TOO_SMALL);
    EXPECT_EQ(count, clusters.size());
  }
}

TEST_P(CApi, ClustersDecodeAsInCpp) {
  const auto expected = AssetFile::view(bytes_);
  ASSERT_TRUE(expected.ok());
  for (std::uint32_t p = 0; p < page_count(); ++p) {
    const std::vector<std::uint32_t> words = load(p);
    const auto page = expected->load_page(p);
    ASSERT_TRUE(page.ok());
    EXPECT_EQ(std::memcmp(words.data(), page->bytes().data(), page->bytes().size()), 0);
    const format::PageRecord& record = expected->pages()[p];
    for (std::uint32_t c = record.first_cluster; c < record.first_cluster + record.cluster_count; ++c) {
      EXPECT_EQ(meshlode_page_of(asset_, c), p);
      ClusterIntegers integers;
      ClusterFloats floats;
      ASSERT_TRUE(expected->decode(*page, c, integers).ok() && expected->decode(*page, c, floats).ok());
      const std::uint32_t n = integers.vertex_count, m = integers.triangle_count;

      std::vector<std::int32_t> values(integers.values.size());
      std::vector<std::uint8_t> corners(3U * m);
      std::vector<std::uint32_t> materials(m);
      meshlode_cluster_integers out = {
          static_cast<std::uint32_t>(values.size()), m, values.data(), corners.data(), materials.data(), 0, 0, 0};
      ASSERT_EQ(meshlode_decode_integers(asset_, {p, words.data()}, c, &out, &error_), MESHLODE_OK) << error_.text;
      EXPECT_EQ(out.vertex_count, n);
      EXPECT_EQ(out.triangle_count, m);
      EXPECT_EQ(out.channel_count, integers.channel_count);
      EXPECT_EQ(values, integers.values);
      EXPECT_EQ(std::memcmp(corners.data(), integers.triangles.data(), corners.size()), 0);
      EXPECT_EQ(materials, integers.triangle_materials);

      std::vector<float> positions(3U * n), normals(3U * n), colors(4U * n);
      meshlode_cluster_floats f{};
      f.vertex_capacity = n;
      f.triangle_capacity = m;
      f.positions = positions.data();
      f.normals = normals.data();
      f.colors = colors.data();
      ASSERT_EQ(meshlode_decode_floats(asset_, {p, words.data()}, c, &f, &error_), MESHLODE_OK) << error_.text;
      const auto same = [](const std::vector<float>& a, const auto& b) {
        return b.size() * sizeof(b[0]) == a.size() * sizeof(float) &&
               std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
      };
      EXPECT_TRUE(same(positions, floats.positions));
      EXPECT_TRUE(same(normals, floats.normals));
      EXPECT_TRUE(same(colors, floats.colors));
      f.vertex_capacity = n - 1;
      EXPECT_EQ(meshlode_decode_floats(asset_, {p, words.data()}, c, &f, nullptr), MESHLODE_TOO_SMALL);
      EXPECT_EQ(f.vertex_count, n) << "what is needed";
    }
  }
}

TEST_P(CApi, StreamingOrderLoadsWhatAPageNeedsBeforeIt) {
  std::vector<std::uint32_t> order(page_count());
  ASSERT_EQ(meshlode_streaming_order(asset_, 0, order.data(), &error_), MESHLODE_OK);
  std::set<std::uint32_t> loaded;
  for (const std::uint32_t page : order) {
    ASSERT_LT(page, order.size());
    std::uint32_t count = 0;
    const std::uint32_t* needed = meshlode_page_dependencies(asset_, page, &count);
    for (std::uint32_t i = 0; i < count; ++i) EXPECT_TRUE(loaded.contains(needed[i])) << page << " needs " << needed[i];
    EXPECT_TRUE(loaded.insert(page).second);
  }
  EXPECT_EQ(loaded.size(), order.size());
  EXPECT_GT(order.size(), 1U) << "the test would see nothing";
  // The first page draws something alone: the coarsest cut of a mesh lies in it.
  std::size_t count = 0;
  std::vector<std::uint32_t> roots(1000);
  ASSERT_EQ(meshlode_select_uniform(asset_, 0, 0, 1e30, roots.data(), roots.size(), &count, nullptr, &error_),
            MESHLODE_OK);
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(meshlode_page_of(asset_, roots[i]), order[0]);
}

TEST_P(CApi, ViewsOfPagesAreForUncompressedOnes) {
  std::uint32_t count = 0;
  const meshlode_page* pages = meshlode_pages(asset_, &count);
  for (std::uint32_t p = 0; p < count; ++p) {  // a page that did not shrink is stored as it is, whatever the codec
    const void* bytes = nullptr;
    const auto status = meshlode_view_page(asset_, p, &bytes, &error_);
    EXPECT_EQ(status, pages[p].codec == 0 ? MESHLODE_OK : MESHLODE_UNSUPPORTED);
    EXPECT_EQ(bytes, pages[p].codec == 0 ? bytes_.data() + pages[p].offset : nullptr);
    if (GetParam() == format::Codec::kNone) {
      EXPECT_EQ(pages[p].codec, 0U);
    }
  }
  const void* bytes = nullptr;
  EXPECT_EQ(meshlode_view_page(asset_, count, &bytes, &error_), MESHLODE_USAGE);
}

TEST_P(CApi, ArgumentsThatMakeNoSenseAreUsageErrors) {
  std::vector<std::uint32_t> words = load(0);
  EXPECT_EQ(meshlode_load_page(asset_, page_count(), words.data(), 4 * words.size(), &error_), MESHLODE_USAGE);
  EXPECT_NE(std::string(error_.text), "");
  EXPECT_EQ(meshlode_load_page(asset_, 0, words.data(), 1, nullptr), MESHLODE_TOO_SMALL);
  EXPECT_EQ(meshlode_load_page(asset_, 0, reinterpret_cast<char*>(words.data()) + 1, 4 * words.size(), nullptr),
            MESHLODE_USAGE);
  std::uint32_t clusters = 0;
  (void)meshlode_clusters(asset_, &clusters);
  meshlode_cluster_floats f{};
  EXPECT_EQ(meshlode_decode_floats(asset_, {0, words.data()}, clusters, &f, nullptr), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_decode_floats(asset_, {0, nullptr}, 0, &f, nullptr), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_decode_floats(asset_, {page_count(), words.data()}, 0, &f, nullptr), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_page_of(asset_, clusters), MESHLODE_NONE);
  std::size_t count = 0;
  EXPECT_EQ(meshlode_select_uniform(asset_, 1, 0, 0.0, nullptr, 0, &count, nullptr, nullptr), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_select_uniform(asset_, 0, 0, std::nan(""), nullptr, 0, &count, nullptr, nullptr), MESHLODE_USAGE);
  const auto refuses = [&](auto change) {
    meshlode_view view = {{0.0, 0.0, 3.0}, 0, 0.8, 1.0, 0.01, 720, 0};
    change(view);
    return meshlode_select_view(asset_, &view, 1.0, nullptr, 0, &count, nullptr) == MESHLODE_USAGE;
  };
  EXPECT_FALSE(refuses([](meshlode_view&) {}));
  EXPECT_TRUE(refuses([](meshlode_view& v) { v.eye[2] = std::nan(""); }));
  EXPECT_TRUE(refuses([](meshlode_view& v) { v.fovy_radians = 4.0; }));
  EXPECT_TRUE(refuses([](meshlode_view& v) { v.near_distance = 0.0; }));
  EXPECT_TRUE(refuses([](meshlode_view& v) { v.height_px = 0; }));
  EXPECT_TRUE(refuses([](meshlode_view& v) { v.is_orthographic = 1, v.ortho_height = 0.0; }));
}

TEST_P(CApi, APromiseThatWasNotBuiltIsRefusedEverywhere) {
  meshlode_promise_tables tables{};
  EXPECT_EQ(meshlode_tables_of(asset_, MESHLODE_PROMISE_POSITION, &tables, &error_), MESHLODE_OK);
  std::uint32_t group_count = 0;
  EXPECT_EQ(tables.groups, meshlode_groups(asset_, &group_count));
  meshlode_selector* selector = nullptr;
  ASSERT_EQ(meshlode_create_selector(asset_, &selector, nullptr), MESHLODE_OK);
  std::vector<std::uint32_t> words(4096);
  std::size_t count = 0;
  for (const std::uint32_t promise : {1U, 2U, 3U, 0xFFFFFFFFU}) {
    const meshlode_status expected = promise <= MESHLODE_PROMISE_APPEARANCE ? MESHLODE_UNSUPPORTED : MESHLODE_USAGE;
    const meshlode_view view = {{0.0, 0.0, 3.0}, 0, 0.8, 1.0, 0.01, 720, promise};
    meshlode_draw_item item{};
    EXPECT_EQ(meshlode_tables_of(asset_, promise, &tables, &error_), expected);
    EXPECT_EQ(meshlode_select_view(asset_, &view, 1.0, &item, 1, &count, &error_), expected);
    EXPECT_EQ(meshlode_select_resident(selector, &view, nullptr, 1.0, nullptr, &item, 1, &count, &error_), expected);
    EXPECT_EQ(meshlode_select_uniform(asset_, 0, promise, 0.0, words.data(), words.size(), &count, nullptr, &error_),
              expected);
    EXPECT_EQ(meshlode_streaming_order(asset_, promise, words.data(), &error_), expected);
    const std::string remedy = promise == 1 ? "--promise texels" : promise == 2 ? "--promise appearance" : "promise";
    EXPECT_NE(std::string(error_.text).find(remedy), std::string::npos) << error_.text;
  }
  meshlode_destroy_selector(selector);
}

INSTANTIATE_TEST_SUITE_P(Codecs, CApi,
                         testing::Values(format::Codec::kNone, format::Codec::kStrips, format::Codec::kZstd),
                         [](const auto& codec) { return std::string(format::name_of(codec.param)); });

TEST(CApiOpen, RefusalsHaveACodeAndAText) {
  meshlode_asset* asset = nullptr;
  meshlode_error error{};
  EXPECT_EQ(meshlode_open_file("/no/such/file.lode", &asset, &error), MESHLODE_IO);
  EXPECT_NE(std::string(error.text).find("/no/such/file.lode"), std::string::npos);
  EXPECT_EQ(meshlode_open_file(nullptr, &asset, &error), MESHLODE_USAGE);
  alignas(8) std::array<unsigned char, 128> noise{};
  EXPECT_EQ(meshlode_open_buffer(noise.data(), noise.size(), &asset, &error), MESHLODE_INVALID);
  EXPECT_EQ(error.status, MESHLODE_INVALID);
  EXPECT_EQ(meshlode_open_buffer(noise.data() + 1, 64, &asset, &error), MESHLODE_USAGE);
  EXPECT_EQ(meshlode_open_buffer(nullptr, 0, &asset, &error), MESHLODE_INVALID);
  EXPECT_EQ(asset, nullptr);
  meshlode_close(nullptr);
  // Texts are cut to fit, never in the middle of a character.
  std::string path = "/";
  while (path.size() < 600) path += "\xC3\xA4";
  EXPECT_EQ(meshlode_open_file(path.c_str(), &asset, &error), MESHLODE_IO);
  const std::size_t length = std::strlen(error.text);
  EXPECT_GE(length, sizeof error.text - 3);
  EXPECT_LT(length, sizeof error.text);
  EXPECT_EQ(static_cast<unsigned char>(error.text[length - 1]), 0xA4U);
}

TEST(CApiOpen, FilesAreMapped) {
  const auto& bytes = sphere_bytes(format::Codec::kZstd);
  const std::string path = testing::TempDir() + "meshlode_c_api.lode";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  meshlode_asset* asset = nullptr;
  ASSERT_EQ(meshlode_open_file(path.c_str(), &asset, nullptr), MESHLODE_OK);
  std::uint32_t count = 0;
  EXPECT_NE(meshlode_clusters(asset, &count), nullptr);
  EXPECT_GT(count, 0U);
  meshlode_close(asset);
}

}  // namespace
}  // namespace meshlode
