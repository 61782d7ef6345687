// SPDX-License-Identifier: GPL-3.0-or-later
// Each rule of the tables, broken alone, is refused at its place (I11).
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "base/hash.h"
#include "break_asset.h"
#include "run/read/asset.h"

namespace meshlode::run {
namespace {

using format::SectionId;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

const std::vector<std::uint8_t>& sound() {
  static const std::vector<std::uint8_t> bytes = test::sample_asset_bytes();
  return bytes;
}

const Asset& sound_asset() {
  static const Asset asset = *Asset::from_bytes(sound());
  return asset;
}

void expect_refused(std::vector<std::uint8_t> bytes, const std::string& where, ErrorCode code = ErrorCode::kInvalid) {
  const auto asset = Asset::from_vector(std::move(bytes));
  ASSERT_FALSE(asset.ok()) << "accepted: " << where;
  EXPECT_EQ(asset.error().where, where) << asset.error().message();
  EXPECT_EQ(asset.error().code, code) << where;
  EXPECT_FALSE(asset.error().detail.empty());
}

template <class Record>
struct Rule {
  const char* field;
  std::size_t record;
  std::function<void(Record&)> change;
};

template <class Record>
void expect_all_refused(SectionId id, const char* name, const std::vector<Rule<Record>>& rules) {
  for (const Rule<Record>& rule : rules) {
    expect_refused(
        test::with_changed_record<Record>(sound(), id, rule.record, rule.change),
        std::string("section ") + name + ", record " + std::to_string(rule.record) + ", field " + rule.field);
  }
}

// Names may share their bytes: seven hundred of them made 600 MB of one of 900 KB.
TEST(Read, NamesThatShareBytesAreRefusedBeyondWhatTheFileJustifies) {
  for (const std::size_t count : {2u, 700u}) {
    scene::Scene scene = test::sample_scene();
    scene.instances.resize(count, scene.instances[0]);
    scene.instances[0].name = std::string(900000, 'x');
    auto bytes = test::sample_asset_bytes(scene, format::Codec::kNone);
    EXPECT_LT(bytes.size(), 1500000u);
    auto* records =
        reinterpret_cast<format::InstanceRecord*>(bytes.data() + test::section_offset(bytes, SectionId::kInstances));
    for (std::size_t i = 1; i < count; ++i) records[i].name = records[0].name;
    test::reseal(bytes);
    const auto asset = Asset::from_vector(std::move(bytes));
    EXPECT_EQ(asset.ok(), count == 2);
    if (!asset) {
      EXPECT_EQ(asset.error().where, "section STRS");
    }
  }
}

TEST(Read, OpensASoundAsset) {
  for (const format::Codec codec : {format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                    format::Codec::kStrips, format::Codec::kDraco}) {
    const auto asset = Asset::from_vector(test::sample_asset_bytes(codec));
    EXPECT_TRUE(asset.ok()) << asset.error().message();
  }
}

TEST(Read, TheAssetStaysValidWhenItIsMoved) {
  auto first = Asset::from_vector(sound());
  ASSERT_TRUE(first.ok());
  const Asset second = std::move(*first);
  EXPECT_EQ(second.meshes().size(), 4U);
  EXPECT_EQ(second.string(second.meshes()[1].name), "sphere");
}

TEST(Read, ResealingASoundAssetChangesNothing) {
  auto bytes = sound();
  test::reseal(bytes);
  EXPECT_EQ(bytes, sound());
}

TEST(Read, RefusesABrokenHeader) {
  const auto broken = [](const std::function<void(format::FileHeader&)>& change) {
    auto bytes = sound();
    format::FileHeader header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    change(header);
    std::memcpy(bytes.data(), &header, sizeof(header));
    test::reseal(bytes);
    return bytes;
  };
  expect_refused({}, "header, field magic");
  expect_refused(std::vector<std::uint8_t>(63, 0), "header, field magic");
  expect_refused(broken([](auto& h) { h.magic ^= 1U; }), "header, field magic");
  expect_refused(broken([](auto& h) { h.version = 0; }), "header, field version", ErrorCode::kUnsupported);
  expect_refused(broken([](auto& h) { h.header_bytes = 128; }), "header, field header_bytes");
  expect_refused(broken([](auto& h) { h.section_count = 1U << 30U; }), "header, field section_count");
  expect_refused(broken([](auto& h) { h.file_bytes += 1; }), "header, field file_bytes");
  expect_refused(broken([](auto& h) { h.section_table_offset = 72; }), "header, field section_table_offset");
  expect_refused(broken([](auto& h) { h.section_entry_bytes = 32; }), "header, field section_entry_bytes");
  expect_refused(broken([](auto& h) { h.flags = 1; }), "header, field flags");
  auto bytes = sound();
  bytes[32] ^= 1U;  // the content hash: the reader does not compute it, but the header's checksum covers it
  expect_refused(bytes, "header, field header_checksum");
}

TEST(Read, RefusesAMisalignedView) {
  alignas(16) static std::uint8_t storage[64 + 8] = {};
  const auto asset = Asset::from_bytes({storage + 1, 64});
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().code, ErrorCode::kUsage);
}

TEST(Read, RefusesABrokenSectionTable) {
  const auto broken = [](std::size_t index, const std::function<void(format::SectionEntry&)>& change) {
    auto bytes = sound();
    const std::size_t at = 64 + 64 * index;
    format::SectionEntry entry;
    std::memcpy(&entry, bytes.data() + at, sizeof(entry));
    change(entry);
    std::memcpy(bytes.data() + at, &entry, sizeof(entry));
    test::reseal(bytes);
    return bytes;
  };
  constexpr std::size_t kMesh = 3;
  constexpr std::size_t kLast = 13;
  expect_refused(broken(kMesh, [](auto& e) { e.offset += 8; }), "section MESH, field offset");
  expect_refused(broken(kMesh, [](auto& e) { e.offset += 16; }), "section MESH, field offset");
  expect_refused(broken(kMesh, [](auto& e) { e.offset -= 16; }), "section MESH, field offset");
  expect_refused(broken(kMesh, [](auto& e) { e.offset = ~std::uint64_t{15}; }), "section MESH, field offset");
  expect_refused(broken(kLast, [](auto& e) { e.bytes += 1; }), "section BLOB, field bytes");
  expect_refused(broken(kLast, [](auto& e) { e.bytes = ~std::uint64_t{0}; }), "section BLOB, field bytes");
  expect_refused(broken(kMesh, [](auto& e) { e.flags |= 2U; }), "section MESH, field flags");
  expect_refused(broken(kMesh, [](auto& e) { e.codec = 2; }), "section MESH, field codec", ErrorCode::kUnsupported);
  expect_refused(broken(kLast, [](auto& e) { e.codec = 1; }), "section BLOB, field codec", ErrorCode::kUnsupported);
  expect_refused(broken(kMesh, [](auto& e) { e.codec = 1; }), "section MESH, field codec");
  expect_refused(broken(kMesh, [](auto& e) { e.decoded_bytes += 1; }), "section MESH, field decoded_bytes");
  expect_refused(broken(kMesh,
                        [](auto& e) {
                          e.codec = 1;
                          e.decoded_bytes = 256 * (e.bytes + 1);
                        }),
                 "section MESH, field decoded_bytes");
  expect_refused(broken(kMesh, [](auto& e) { e.record_bytes = 208; }), "section MESH, field record_bytes");
  expect_refused(broken(kMesh, [](auto& e) { e.record_count = 5; }), "section MESH, field record_count");
  expect_refused(broken(0, [](auto& e) { e.record_count = 1; }), "section META, field record_count");
  expect_refused(broken(kMesh, [](auto& e) { e.version = 1; }), "section MESH, field version", ErrorCode::kUnsupported);
  expect_refused(broken(12, [](auto& e) { e.checksum = 1; }), "section PAGE, field checksum");
  const std::uint32_t unknown = format::four_cc('N', 'E', 'W', '!');
  expect_refused(broken(kMesh, [=](auto& e) { e.id = unknown; }), "section NEW!", ErrorCode::kUnsupported);
  expect_refused(broken(kMesh, [=](auto& e) { e.id = unknown, e.flags = 0; }), "section MESH");  // missing now
  expect_refused(broken(1, [](auto& e) { e.id = static_cast<std::uint32_t>(SectionId::kMeta); }),
                 "section META, field id");
  auto bytes = sound();
  const format::SectionEntry& meta = sound_asset().sections()[0];
  ASSERT_NE(meta.bytes % 16, 0U);
  bytes[meta.offset + meta.bytes] = 1;
  expect_refused(bytes, "section SCNE, field offset");  // something hides in the padding
  bytes = sound();
  bytes[meta.offset] ^= 1U;
  expect_refused(bytes, "section META, field checksum");
}

TEST(Read, SkipsAnUnknownSectionThatIsNotRequired) {
  // Rebuilt with one more entry: everything moves by the entry's 64 bytes.
  auto bytes = sound();
  const std::uint32_t count = sound_asset().header().section_count;
  format::SectionEntry extra{};
  extra.id = format::four_cc('x', 't', 'r', 'a');
  std::vector<std::uint8_t> moved(bytes.begin(), bytes.begin() + 64 + 64 * count);
  moved.resize(moved.size() + 64);
  moved.insert(moved.end(), bytes.begin() + 64 + 64 * count, bytes.end());
  moved.resize((moved.size() + 15) / 16 * 16);
  extra.offset = moved.size();
  moved.insert(moved.end(), {1, 2, 3});
  extra.bytes = extra.decoded_bytes = 3;
  extra.checksum = hash64({moved.data() + extra.offset, 3});
  const auto shift = [&](std::uint64_t at) {
    std::uint64_t offset = 0;
    std::memcpy(&offset, moved.data() + at, 8);
    offset += 64;
    std::memcpy(moved.data() + at, &offset, 8);
  };
  for (std::uint32_t s = 0; s < count; ++s) shift(64 + 64 * s + offsetof(format::SectionEntry, offset));
  std::memcpy(moved.data() + 64 + 64 * count, &extra, sizeof(extra));
  format::FileHeader header = sound_asset().header();
  header.section_count = count + 1;
  header.file_bytes = moved.size();
  std::memcpy(moved.data(), &header, sizeof(header));
  const std::uint64_t pages = test::section_offset(moved, SectionId::kPages);
  for (std::size_t p = 0; p < sound_asset().pages().size(); ++p) shift(pages + p * sizeof(format::PageRecord));
  const std::uint64_t blobs = test::section_offset(moved, SectionId::kBlobs);
  for (std::size_t b = 0; b < sound_asset().blobs().size(); ++b) {
    shift(blobs + b * sizeof(format::BlobRecord) + offsetof(format::BlobRecord, offset));
  }
  test::reseal(moved);
  const auto asset = Asset::from_vector(moved);
  ASSERT_TRUE(asset.ok()) << asset.error().message();
  EXPECT_EQ(asset->sections().size(), count + 1);
  EXPECT_EQ(asset->string(asset->meshes()[0].name), "patch");
}

TEST(Read, RefusesBrokenMeshes) {
  using M = format::MeshRecord;
  expect_all_refused<M>(SectionId::kMeshes, "MESH",
                        {{"name", 0, [](M& m) { m.name.offset = 1U << 20U; }},
                         {"name", 0,
                          [](M& m) {
                            m.name = {0xFFFFFFFFU, 0xFFFFFFFFU};
                          }},
                         {"origin", 0, [](M& m) { m.origin[1] = std::numeric_limits<double>::quiet_NaN(); }},
                         {"grid.log2", 0, [](M& m) { m.grid.log2 = -127; }},
                         {"grid.log2", 0, [](M& m) { m.grid.log2 = 105; }},
                         {"grid.mantissa", 0, [](M& m) { m.grid.mantissa = 0; }},
                         {"grid.mantissa", 0, [](M& m) { m.grid.mantissa = 1U << 24U; }},
                         {"bounds_min", 0, [](M& m) { m.bounds_min[0] = -(1 << 23); }},
                         {"bounds_max", 0, [](M& m) { m.bounds_max[2] = 1 << 23; }},
                         {"bounds_min", 0, [](M& m) { m.bounds_min[0] = m.bounds_max[0] + 1; }},
                         {"diagonal", 1, [](M& m) { m.diagonal = std::numeric_limits<double>::infinity(); }},
                         {"diagonal", 1, [](M& m) { m.diagonal = -1.0; }},
                         {"level0_deviation", 1, [](M& m) { m.level0_deviation = kNan; }},
                         {"error_tier", 1, [](M& m) { m.error_tier = static_cast<format::ErrorTier>(3); }},
                         {"normal_mode", 1, [](M& m) { m.normal_mode = static_cast<format::NormalMode>(3); }},
                         {"normal_scale", 1, [](M& m) { m.normal_scale = 8192; }},
                         {"normal_scale", 1, [](M& m) { m.normal_scale = 0; }},
                         {"normal_scale", 2, [](M& m) { m.normal_scale = 811; }},
                         {"uv_set_count", 0, [](M& m) { m.uv_set_count = 5; }},
                         {"has_color", 0, [](M& m) { m.has_color = 2; }},
                         {"uv_log2", 0, [](M& m) { m.uv_log2[0] = 105; }},
                         {"uv_log2", 0, [](M& m) { m.uv_log2[3] = 1; }},
                         {"sphere_log2", 0, [](M& m) { m.sphere_log2 = -127; }},
                         {"sphere_log2", 2, [](M& m) { m.sphere_log2 = 105; }},
                         {"material", 1, [](M& m) { m.material = 2; }},
                         {"first_group", 1, [](M& m) { m.first_group += 1; }},
                         {"first_group", 3, [](M& m) { m.group_count = 1; }},
                         {"first_group", 1, [](M& m) { m.group_count = 0xFFFFFFFFU; }},
                         {"cluster_count", 2, [](M& m) { m.group_count = 0; }},
                         {"first_cluster", 1, [](M& m) { m.first_cluster = 0; }},
                         {"first_cluster", 1, [](M& m) { m.cluster_count = 0xFFFFFFFFU; }},
                         {"first_node", 1, [](M& m) { m.first_node = 0; }},
                         {"first_node", 1, [](M& m) { m.node_count = 0xFFFFFFF0U; }},
                         {"level_count", 0, [](M& m) { m.level_count = 0; }},
                         {"level_count", 0, [](M& m) { m.level_count = 0xFFFFFFFFU; }},
                         {"level_count", 3, [](M& m) { m.level_count = 1; }}});
}

TEST(Read, RefusesBrokenMaterialsInstancesAndBlobs) {
  using T = format::MaterialRecord;
  expect_all_refused<T>(SectionId::kMaterials, "MATL",
                        {{"name", 1, [](T& m) { m.name.bytes = 0xFFFFFFFFU; }},
                         {"alpha_mode", 0, [](T& m) { m.alpha_mode = static_cast<format::AlphaMode>(3); }},
                         {"base_color", 0, [](T& m) { m.base_color[3] = kInf; }},
                         {"alpha_cutoff", 0, [](T& m) { m.alpha_cutoff = kNan; }},
                         {"double_sided", 0, [](T& m) { m.double_sided = 2; }}});
  using I = format::InstanceRecord;
  expect_all_refused<I>(SectionId::kInstances, "INST",
                        {{"name", 0, [](I& i) { i.name.offset = 0x7FFFFFFFU; }},
                         {"transform", 1, [](I& i) { i.transform[11] = std::numeric_limits<double>::infinity(); }},
                         {"flags", 1, [](I& i) { i.flags = 4; }},
                         {"flags", 1, [](I& i) { i.flags = format::kInstanceMirrored | format::kInstanceSingular; }},
                         {"scale", 1, [](I& i) { i.scale = 0.0; }},
                         {"scale", 1, [](I& i) { i.scale = -1.0; }},
                         {"scale", 1, [](I& i) { i.scale = std::numeric_limits<double>::quiet_NaN(); }},
                         {"mesh", 1, [](I& i) { i.mesh = 4; }}});
  using B = format::BlobRecord;
  expect_all_refused<B>(SectionId::kBlobs, "BLBT",
                        {{"name", 0, [](B& b) { b.name.bytes = 1U << 30U; }},
                         {"mime_type", 1, [](B& b) { b.mime_type.offset = 1U << 30U; }},
                         {"kind", 1, [](B& b) { b.kind = static_cast<format::BlobKind>(0); }},
                         {"offset", 1, [](B& b) { b.offset += 1; }},
                         {"offset", 1, [](B& b) { b.offset += 16; }},
                         {"offset", 0, [](B& b) { b.offset = 0; }},
                         {"bytes", 1, [](B& b) { b.bytes += 1; }},
                         {"bytes", 1, [](B& b) { b.bytes = ~std::uint64_t{0}; }}});
}

TEST(Read, RefusesBrokenGroups) {
  using G = format::GroupRecord;
  expect_all_refused<G>(SectionId::kGroups, "GRUP",
                        {{"mesh", 0, [](G& g) { g.mesh = 1; }},
                         {"mesh", 3, [](G& g) { g.mesh = 0xFFFFFFFFU; }},
                         {"radius", 1, [](G& g) { g.center[0] = kNan; }},
                         {"radius", 1, [](G& g) { g.radius = kInf; }},
                         {"radius", 1, [](G& g) { g.radius = -1.0F; }},
                         {"error", 1, [](G& g) { g.error = kNan; }},
                         {"error", 1, [](G& g) { g.error = -0.5F; }},
                         {"error", 0, [](G& g) { g.error = 1.0F; }},
                         {"error", 1, [](G& g) { g.error = format::kInfiniteError; }},
                         {"quadric_error", 1, [](G& g) { g.quadric_error = kInf; }},
                         {"deviation", 1, [](G& g) { g.deviation = kNan; }},
                         {"normal_deviation", 1, [](G& g) { g.normal_deviation = kNan; }},
                         {"normal_deviation", 0, [](G& g) { g.normal_deviation = -1.0F; }},
                         {"uv_deviation", 1, [](G& g) { g.uv_deviation = kInf; }},
                         {"page", 1, [](G& g) { g.page = 0xFFFFFFFFU; }},
                         {"page", 1, [](G& g) { g.page = 1; }},
                         {"flags", 1, [](G& g) { g.flags = 8; }},
                         {"flags", 1, [](G& g) { g.flags = format::kGroupAggregate; }},
                         {"flags", 1, [](G& g) { g.flags = format::kGroupStuck; }},
                         {"stuck_reason", 1, [](G& g) { g.stuck_reason = static_cast<format::StuckReason>(8); }},
                         {"stuck_reason", 1, [](G& g) { g.stuck_reason = format::StuckReason::kFlips; }},
                         {"first_cluster", 1, [](G& g) { g.first_cluster += 1; }},
                         {"first_cluster", 1, [](G& g) { g.cluster_count = 0; }},
                         {"first_cluster", 1, [](G& g) { g.cluster_count = 0xFFFFU; }},
                         {"first_cluster", 2, [](G& g) { g.first_cluster -= 1; }},
                         {"level", 2, [](G& g) { g.level = 2; }},
                         {"level", 0, [](G& g) { g.level = 3; }}});
  // A level that no member has: the mesh must have room for it first.
  auto bytes = test::with_changed_record<format::MeshRecord>(sound(), SectionId::kMeshes, 0,
                                                             [](format::MeshRecord& m) { m.level_count = 4; });
  bytes = test::with_changed_record<G>(bytes, SectionId::kGroups, 0, [](G& g) { g.level = 3; });
  expect_refused(bytes, "section GRUP, record 0, field level");
}

TEST(Read, AnAssetByAPromiseOutlivesTheOneThatItIsMadeOf) {
  auto asset = Asset::from_vector(test::promised_asset_bytes());
  ASSERT_TRUE(asset) << asset.error().message();
  ASSERT_EQ(asset->promises().size(), asset->meshes().size());
  ASSERT_EQ(asset->promise_errors().size(), asset->groups().size());
  auto promised = asset->with_promise(format::Promise::kAppearance);
  asset = Error{};
  ASSERT_TRUE(promised);
  const Asset moved = std::move(*promised);
  EXPECT_EQ(moved.promise(), format::Promise::kAppearance);
  for (std::size_t g = 0; g < moved.groups().size(); ++g) {
    EXPECT_EQ(moved.groups()[g].error, moved.promise_errors()[g].appearance_error);
  }
  const auto back = moved.with_promise(format::Promise::kPosition);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->groups().size(), sound_asset().groups().size());
  for (std::size_t g = 0; g < back->groups().size(); ++g) {
    EXPECT_EQ(back->groups()[g].error, sound_asset().groups()[g].error);
  }
}

TEST(Read, RefusesBrokenPromises) {
  using P = format::PromiseMeshRecord;
  using E = format::PromiseGroupRecord;
  const std::vector<std::uint8_t> promised = test::promised_asset_bytes();
  const std::vector<Rule<P>> of_meshes{{"promises", 0, [](P& p) { p.promises = 0; }},
                                       {"promises", 1, [](P& p) { p.promises = 2; }},
                                       {"promises", 1, [](P& p) { p.promises = 1; }},
                                       {"promises", 0, [](P& p) { p.promises |= 8; }},
                                       {"normal_object", 0, [](P& p) { p.normal_object = kNan; }},
                                       {"normal_object", 0, [](P& p) { p.normal_object = -0.0F; }},
                                       {"uv_object", 0, [](P& p) { p.uv_object[0][0] = kInf; }},
                                       {"uv_object", 0, [](P& p) { p.uv_object[0][1] = 0.0F; }},
                                       {"uv_object", 0, [](P& p) { p.uv_object[3][0] = p.uv_object[3][1] = 1.0F; }},
                                       {"level0_texels", 0, [](P& p) { p.level0_texels = kNan; }},
                                       {"level0_appearance", 0, [](P& p) { p.level0_appearance = -1.0F; }}};
  for (const Rule<P>& rule : of_meshes) {
    expect_refused(test::with_changed_record<P>(promised, SectionId::kPromises, rule.record, rule.change),
                   "section PRMS, record " + std::to_string(rule.record) + ", field " + rule.field);
  }
  // Group 0 is terminal.
  const std::vector<Rule<E>> of_groups{
      {"texel_error", 0, [](E& e) { e.texel_error = 1.0F; }},
      {"texel_error", 1, [](E& e) { e.texel_error = kNan; }},
      {"texel_error", 1, [](E& e) { e.texel_error = 0.5F * e.texel_error - 1.0F; }},
      {"texel_error", 1, [](E& e) { e.texel_error = format::kInfiniteError; }},
      {"appearance_error", 1, [](E& e) { e.appearance_error = kInf; }},
      {"appearance_error", 1, [](E& e) { e.texel_error = 2.0F * e.appearance_error + 1.0F; }},
      {"appearance_error", 0, [](E& e) { e.appearance_error = 0.0F; }}};
  for (const Rule<E>& rule : of_groups) {
    expect_refused(test::with_changed_record<E>(promised, SectionId::kPromiseErrors, rule.record, rule.change),
                   "section PRMG, record " + std::to_string(rule.record) + ", field " + rule.field);
  }
}

TEST(Read, RefusesBrokenClusters) {
  using C = format::ClusterRecord;
  const std::size_t level1 = sound_asset().groups()[1].first_cluster;
  const std::size_t level0 = sound_asset().groups()[2].first_cluster;
  expect_all_refused<C>(SectionId::kClusters, "CLUS",
                        {{"vertices_less_1", 0, [](C& c) { c.vertices_less_1 = 255; }},  // 40 triangles use at most 120
                         {"coarser_group", 0, [](C& c) { c.coarser_group = 1; }},
                         {"coarser_group", 0, [](C& c) { c.coarser_group = format::kNone; }},
                         {"level", level0, [](C& c) { c.level = 1; }},
                         {"own_group", level1, [](C& c) { c.own_group = format::kNone; }},
                         {"own_group", level1, [](C& c) { c.own_group = 1; }},  // a circle of one
                         {"own_group", level1, [](C& c) { c.own_group = 0; }},
                         {"own_group", level1, [](C& c) { c.own_group = 7; }},  // of the next mesh
                         {"own_group", level1, [](C& c) { c.own_group = 0xFFFFFFFEU; }},
                         {"level", level1, [](C& c) { c.level = 0; }}});
}

TEST(Read, RefusesNodesThatAreNoTree) {
  using N = format::NodeRecord;
  const std::size_t sphere = sound_asset().meshes()[1].first_node;
  expect_all_refused<N>(SectionId::kNodes, "NODE",
                        {{"radius", 0, [](N& n) { n.radius = kNan; }},
                         {"radius", 0, [](N& n) { n.center[0] = kInf; }},
                         {"error", 0, [](N& n) { n.error = kNan; }},
                         {"child_count", 0, [](N& n) { n.child_count = 9; }},
                         {"child_count", 0, [](N& n) { n.child_count = 0xFFFFFFFFU; }},
                         {"first", 0, [](N& n) { n.first = 0; }},
                         {"first", 0, [](N& n) { n.first = 0xFFFFFFFFU; }},
                         {"first", 1, [](N& n) { n.first = 100; }},
                         {"first", 3, [](N& n) { n.first = 1; }},  // itself and its siblings
                         {"first", 3, [](N& n) { n.child_count = 8; }},
                         {"first", 4, [](N& n) { n.first = 6; }},  // a group of the next mesh
                         {"first", sphere, [](N& n) { n.first = 1; }},
                         {"first", sphere + 1, [](N& n) { n.first = 0; }}});
  // A node that was a leaf's parent becomes a leaf: the nodes below it are left without a parent.
  expect_refused(test::with_changed_record<N>(sound(), SectionId::kNodes, 0, [](N& n) { n.first += 1; }),
                 "section NODE, record 1, field first");
  expect_refused(
      test::with_changed_record<N>(sound(), SectionId::kNodes, 3, [](N& n) { n.child_count = 0, n.first = 0; }),
      "section NODE, record 4, field first");
}

TEST(Read, RefusesBrokenPages) {
  using P = format::PageRecord;
  expect_all_refused<P>(SectionId::kPages, "PAGT",
                        {{"offset", 0, [](P& p) { p.offset += 8; }},
                         {"offset", 1, [](P& p) { p.offset += 16; }},
                         {"offset", 1, [](P& p) { p.offset = 0; }},
                         {"offset", 1, [](P& p) { p.offset = ~std::uint64_t{15}; }},
                         {"stored_bytes", 2, [](P& p) { p.stored_bytes = 0xFFFFFFFFU; }},
                         {"stored_bytes", 2, [](P& p) { p.codec = format::Codec::kZstd; }},
                         {"codec", 1, [](P& p) { p.codec = static_cast<format::Codec>(5); }},
                         {"bytes", 1, [](P& p) { p.bytes = 8; }},
                         {"bytes", 1, [](P& p) { p.bytes = 1U << 30U; }},
                         {"bytes", 1, [](P& p) { p.bytes += 2; }},
                         {"stored_bytes", 1, [](P& p) { p.bytes += 4; }},
                         {"first_group", 1, [](P& p) { p.first_group += 1; }},
                         {"first_group", 1, [](P& p) { p.group_count = 0; }},
                         {"first_group", 1, [](P& p) { p.group_count = 0xFFFFFFFFU; }},
                         {"first_cluster", 1, [](P& p) { p.first_cluster += 1; }},
                         {"first_cluster", 1, [](P& p) { p.cluster_count += 1; }},
                         {"first_dependency", 1, [](P& p) { p.first_dependency = 1; }},
                         {"first_dependency", 1, [](P& p) { p.dependency_count = 0xFFFFFFFFU; }}});
}

TEST(Read, NamesTheFileThatItRefuses) {
  const auto missing = Asset::open("no_such_file.lode");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  const auto folder = Asset::open(".");
  ASSERT_FALSE(folder.ok());
  EXPECT_EQ(folder.error().code, ErrorCode::kIo);
}

TEST(Read, OpensAFileAndRefusesATruncatedOne) {
  const auto path = std::filesystem::path(testing::TempDir()) / "read_test.lode";
  ASSERT_TRUE(write_file_atomically(path, sound()).ok());
  {
    const auto asset = Asset::open(path);
    ASSERT_TRUE(asset.ok()) << asset.error().message();
    EXPECT_EQ(asset->bytes().size(), sound().size());
  }
  ASSERT_TRUE(write_file_atomically(path, std::span(sound()).first(1000)).ok());
  const auto asset = Asset::open(path);
  ASSERT_FALSE(asset.ok());
  EXPECT_EQ(asset.error().where, path.string() + ": header, field file_bytes");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace meshlode::run
