// SPDX-License-Identifier: GPL-3.0-or-later
// What a cache promises: whole entries or none, whatever its files hold and whoever writes them.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "app/batch/cache/cache.h"
#include "app/batch/cache/ingredients.h"
#include "app/batch/cache/program_id.h"
#include "app/batch/cache/record.h"
#include "app/batch/cache/store.h"
#include "batch_folder.h"
#include "support/random.h"

namespace meshlode::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}
Hash128 key_of_number(std::uint64_t number) {
  return key_of(std::to_string(number));
}
std::string text_in(const Store& store, EntryKind kind, const Hash128& key) {
  const auto entry = store.find(kind, key);
  return entry ? std::string(entry->bytes.begin(), entry->bytes.end()) : "(none)";
}
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  return files;
}

TEST(Store, GivesBackWhatWasKept) {
  const BatchFolder folder;
  const Store store = Store::open(folder.path("c"), {}).value();
  const Hash128 key = key_of_number(1);
  EXPECT_EQ(text_in(store, EntryKind::kRecord, key), "(none)");
  store.keep(EntryKind::kRecord, key, bytes_of("a record"));
  store.keep(EntryKind::kMesh, key, bytes_of(""));
  EXPECT_EQ(text_in(store, EntryKind::kRecord, key), "a record");
  EXPECT_EQ(text_in(store, EntryKind::kMesh, key), "");
  EXPECT_EQ(text_in(store, EntryKind::kLast, key), "(none)");
  const auto asset = bytes_of("an asset");
  store.keep_asset(hash128(asset), asset);
  EXPECT_EQ(text_in(store, EntryKind::kAsset, hash128(asset)), "an asset");
  EXPECT_FALSE(store.first_error());
}

TEST(Store, TakesNoFolderThatHoldsOtherThings) {
  const BatchFolder folder;
  folder.write("home/thesis.txt", "years");
  const auto store = Store::open(folder.path("home"), {});
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kUsage);
  folder.write("new/.meshlode-0123456789abcdef.tmp", "half a tag");
  EXPECT_TRUE(Store::open(folder.path("new"), {}));
}

// Every byte that can be wrong is: none is handed out, and what was found broken is gone.
TEST(Store, EveryTruncationAndEveryChangedByteCountsAsNotThere) {
  const BatchFolder folder;
  const Store store = Store::open(folder.path("c"), {}).value();
  const Hash128 key = key_of_number(2);
  store.keep(EntryKind::kMesh, key, bytes_of("sixteen bytes ok"));
  const auto files = files_below(folder.path("c/mesh"));
  ASSERT_EQ(files.size(), 1U);
  const std::string sound = BatchFolder::text_of(files[0]);
  const std::string name = files[0].lexically_relative(folder.path()).string();
  for (std::size_t i = 0; i < sound.size(); ++i) {
    folder.write(name, sound.substr(0, i));
    EXPECT_EQ(text_in(store, EntryKind::kMesh, key), "(none)") << "cut at " << i;
    std::string changed = sound;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    folder.write(name, changed);
    EXPECT_EQ(text_in(store, EntryKind::kMesh, key), "(none)") << "changed at " << i;
    EXPECT_FALSE(fs::exists(files[0]));
  }
  folder.write(name, sound);
  EXPECT_EQ(text_in(store, EntryKind::kMesh, key), "sixteen bytes ok");
  EXPECT_EQ(text_in(store, EntryKind::kRecord, key), "(none)");
}

TEST(Store, AnEntryOfAnotherKeyOrKindIsNone) {
  const BatchFolder folder;
  const Store store = Store::open(folder.path("c"), {}).value();
  store.keep(EntryKind::kRecord, key_of_number(1), bytes_of("of 1"));
  const auto from = files_below(folder.path("c/record")).at(0);
  for (const char* kind : {"record", "mesh"}) {
    const Hash128 key = key_of_number(kind == std::string("mesh") ? 1 : 3);
    const std::string hex = to_hex(key);
    folder.write(std::string("c/") + kind + "/" + hex.substr(0, 2) + "/" + hex.substr(2), BatchFolder::text_of(from));
    EXPECT_EQ(text_in(store, kind == std::string("mesh") ? EntryKind::kMesh : EntryKind::kRecord, key), "(none)");
  }
}

TEST(Store, TrimsWhatWasUsedLongestAgo) {
  const BatchFolder folder;
  const std::string kilobyte(1000, 'x');
  {
    const Store store = Store::open(folder.path("c"), {}).value();
    for (std::uint64_t i = 0; i < 10; ++i) store.keep(EntryKind::kMesh, key_of_number(i), bytes_of(kilobyte));
  }
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(100);
  for (const fs::path& file : files_below(folder.path("c/mesh"))) fs::last_write_time(file, long_ago);
  const Store store = Store::open(folder.path("c"), {.limit = 3 * 1064}).value();
  for (const std::uint64_t i : {2, 5, 7}) EXPECT_EQ(text_in(store, EntryKind::kMesh, key_of_number(i)), kilobyte);
  folder.write("c/mesh/not an entry.txt", kilobyte);
  folder.write("c/mesh/00/.meshlode-0123456789abcdef.tmp", "left by a killed writer");
  folder.write("c/.meshlode-0123456789abcdef.tmp", "half a tag, left by another");
  store.trim();
  for (std::uint64_t i = 0; i < 10; ++i) {
    EXPECT_EQ(store.has(EntryKind::kMesh, key_of_number(i)), i == 2 || i == 5 || i == 7) << i;
  }
  EXPECT_TRUE(fs::exists(folder.path("c/mesh/not an entry.txt")));
  EXPECT_FALSE(fs::exists(folder.path("c/mesh/00/.meshlode-0123456789abcdef.tmp")));
  EXPECT_FALSE(fs::exists(folder.path("c/.meshlode-0123456789abcdef.tmp")));
}

// Writers, readers and trimmers side by side: whatever is found is whole.
TEST(Store, HoldsUnderConcurrentUse) {
  const BatchFolder folder;
  std::atomic<int> broken = 0, found = 0;
  const auto use = [&](std::uint64_t seed) {
    const Store store = Store::open(folder.path("c"), {.limit = 40000}).value();
    test::Random random(seed);
    for (int i = 0; i < 60; ++i) {
      const std::uint64_t number = random.below(20);
      const std::string text(500 * (number + 1), static_cast<char>('a' + number));
      if (random.below(2) == 0) store.keep(EntryKind::kMesh, key_of_number(number), bytes_of(text));
      if (const auto entry = store.find(EntryKind::kMesh, key_of_number(number))) {
        ++found;
        if (!std::equal(entry->bytes.begin(), entry->bytes.end(), text.begin(), text.end())) ++broken;
      }
    }
    EXPECT_FALSE(store.first_error());
  };
  std::vector<std::thread> threads;
  for (std::uint64_t i = 0; i < 6; ++i) threads.emplace_back(use, i);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(broken, 0);
  EXPECT_GT(found, 100);
  const Store store = Store::open(folder.path("c"), {.limit = 40000}).value();
  store.trim();
  std::uintmax_t bytes = 0;
  for (const fs::path& file : files_below(folder.path("c/mesh"))) bytes += fs::file_size(file);
  EXPECT_LE(bytes, 40000U);
}

TEST(Store, ReadOnlyWritesNothing) {
  const BatchFolder folder;
  const Store store = Store::open(folder.path("none"), {.is_read_only = true}).value();
  store.keep(EntryKind::kMesh, key_of_number(1), bytes_of("x"));
  EXPECT_FALSE(fs::exists(folder.path("none")));
}

TEST(Store, WhatCannotBeWrittenIsSaidOnce) {
  const BatchFolder folder;
  const Store store = Store::open(folder.path("c"), {}).value();
  folder.write("c/mesh", "a file in the way");
  store.keep(EntryKind::kMesh, key_of_number(1), bytes_of("x"));
  ASSERT_TRUE(store.first_error());
  EXPECT_EQ(store.first_error()->code, ErrorCode::kIo);
}

AssetRecord sample_record() {
  AssetRecord record;
  record.ingredients = "made of\nthis\n";
  record.asset[3] = 7;
  record.facts.triangles = 1, record.facts.meshes = 2, record.facts.instances = 3, record.facts.bytes = 4;
  record.facts.dropped = 5, record.facts.repairs = {6, 7, 8, 9, 10, 11};
  record.facts.left_out = {{"skin 0", "why not"}};
  record.facts.planned_out = {{"uv", ""}, {"", "b"}};
  return record;
}

TEST(Record, ComesBackWhole) {
  const AssetRecord record = sample_record();
  const auto again = read_record(record_bytes(record));
  ASSERT_TRUE(again);
  EXPECT_EQ(record_bytes(*again), record_bytes(record));
  EXPECT_EQ(again->ingredients, record.ingredients);
  EXPECT_EQ(again->facts.repairs.split, 11U);
  EXPECT_EQ(again->facts.planned_out.at(1).why, "b");
}

TEST(Record, NoBytesMakeItsReaderCrashOrAllocate) {
  const std::vector<std::uint8_t> sound = record_bytes(sample_record());
  for (std::size_t i = 0; i < sound.size(); ++i) {
    EXPECT_FALSE(read_record(std::span(sound).first(i)));
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      auto changed = sound;
      changed[i] = static_cast<std::uint8_t>(value);
      const auto read = read_record(changed);
      EXPECT_TRUE(!read || record_bytes(*read) == changed) << i << ": " << value;
    }
  }
}

std::vector<Dependency> sample_files() {
  std::vector<Dependency> files(3);
  files[0] = {FileKind::kScene, "a.gltf", "in/a.gltf", FileStamp{}, {1}};
  files[1] = {FileKind::kBuffer, "a.bin", "in/a.bin", FileStamp{}, {2}};
  files[2] = {FileKind::kImage, "my pic\n.png", "in/my pic\n.png", std::nullopt, {}};
  return files;
}

// One line of ingredients for whatever changes a byte of the asset, none for what does not.
TEST(Ingredients, AreOtherOnesForEverySettingThatChangesBytes) {
  const builder::PipelineOptions plain;
  std::vector<builder::PipelineOptions> changed(13, plain);
  changed[0].preset = Preset::kBest;
  changed[1].error_tier = format::ErrorTier::kQem;
  changed[2].attributes = AttributeChoice::kAll;
  changed[3].grid_step = 0.1;
  changed[4].codec = format::Codec::kNone;
  changed[5].partition_seed = 2;
  changed[6].repair = true;
  changed[7].max_cluster_triangles = 64;
  changed[8].max_cluster_vertices = 64;
  changed[9].position_error = 1e-300;
  changed[10].normal_error = 0.1 + 1e-17 + 1e-16;
  changed[11].uv_error = 0.25;
  changed[12].uv_error_is_texels = false;
  changed.push_back(plain);
  changed.back().uv_error_is_default = false;
  changed.push_back(plain);
  changed.back().keep_topology = true;
  changed.push_back(plain);
  changed.back().lock_borders = true;
  changed.push_back(plain);
  changed.back().linear_colors = true;
  changed.push_back(plain);
  changed.back().aggregate = AggregateChoice::kAuto;
  changed.push_back(plain);
  changed.back().promise = format::Promise::kTexels;
  std::vector<std::string> texts{settings_text(plain, {}), settings_text(plain, {.repair = true}),
                                 settings_text(plain, {.linear_colors = true})};
  for (const builder::PipelineOptions& options : changed) texts.push_back(settings_text(options, {}));
  std::sort(texts.begin(), texts.end());
  EXPECT_EQ(std::unique(texts.begin(), texts.end()), texts.end());
  builder::PipelineOptions roomy;
  roomy.max_memory = 1U << 30U;
  EXPECT_EQ(settings_text(roomy, {.max_decoded = 5, .may_lack_images = true}), settings_text(plain, {}));
}

TEST(Ingredients, TellOfEveryFileAndOfNoFolder) {
  auto files = sample_files();
  const std::string text = ingredients_text({}, "codec none\n", files);
  for (Dependency& file : files) file.path = "elsewhere" / file.path;
  EXPECT_EQ(ingredients_text({}, "codec none\n", files), text);
  for (std::size_t i = 0; i < 2; ++i) {
    auto changed = files;
    changed[i].hash[15] ^= 1;
    EXPECT_NE(ingredients_text({}, "codec none\n", changed), text);
  }
  EXPECT_NE(ingredients_text({9}, "codec none\n", files), text);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);  // no name makes a line of its own
}

TEST(Ingredients, SayWhatChanged) {
  auto files = sample_files();
  const std::string before = ingredients_text({}, "codec none\n", files);
  EXPECT_EQ(explain_change(before, before), "");
  EXPECT_EQ(explain_change(before, ingredients_text({}, "codec lz4\n", files)), "codec is lz4, was none");
  EXPECT_EQ(explain_change(before, ingredients_text({1}, "codec none\n", files)), "the program is another");
  files[1].hash[0] = 9;
  files[2].stamp = FileStamp{};
  EXPECT_EQ(explain_change(before, ingredients_text({}, "codec none\n", files)),
            "buffer a.bin changed; image my%20pic%0A.png is there");
  files.pop_back();
  files[1].stamp.reset();
  EXPECT_EQ(explain_change(before, ingredients_text({}, "codec none\n", files)),
            "buffer a.bin is missing; image my%20pic%0A.png is no longer used");
}

TEST(ProgramId, IsTheSameEveryTime) {
  const auto id = find_program_id();
  ASSERT_TRUE(id) << id.error().message();
  EXPECT_EQ(*id, find_program_id().value());
  EXPECT_NE(*id, Hash128{});
}

}  // namespace
}  // namespace meshlode::app
