// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshlode/spill_area.h"

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/memory.h"

namespace meshlode::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMiB = std::size_t{1} << 20U;

/// A folder on a disk; skipped where there is none.
fs::path disk_folder() {
  for (const char* const folder : {".", "/var/tmp", "/tmp"}) {
    if (SpillArea::open(folder)) return folder;
  }
  return {};
}

#define SKIP_WITHOUT_DISK(folder) \
  if ((folder).empty()) GTEST_SKIP() << "no folder on a disk that can reserve room"

std::uint64_t word_at(std::size_t i, std::uint64_t seed) {
  return (i + 1) * 0x9E3779B97F4A7C15ULL ^ seed;
}
void fill(void* array, std::size_t bytes, std::uint64_t seed) {
  auto* const words = static_cast<std::uint64_t*>(array);
  for (std::size_t i = 0; i < bytes / 8; ++i) words[i] = word_at(i, seed);
}
bool holds(const void* array, std::size_t bytes, std::uint64_t seed) {
  const auto* const words = static_cast<const std::uint64_t*>(array);
  for (std::size_t i = 0; i < bytes / 8; ++i) {
    if (words[i] != word_at(i, seed)) return false;
  }
  return true;
}
/// One round and a bit.
void drop_all(SpillArea& area) {
  for (int round = 0; round < 2; ++round) {
    while (area.drop(3 * kMiB)) {
    }
  }
}

TEST(SpillArea, WhatIsDroppedComesBack) {
  const fs::path folder = disk_folder();
  SKIP_WITHOUT_DISK(folder);
  const auto area = std::move(*SpillArea::open(folder));
  EXPECT_FALSE(area->drop(kMiB)) << "nothing lies there";
  std::vector<void*> arrays;
  const std::size_t bytes = 8 * kMiB + 8;
  for (std::uint64_t i = 0; i < 6; ++i) {
    arrays.push_back(area->allocate(bytes));
    ASSERT_NE(arrays.back(), nullptr);
    EXPECT_TRUE(area->owns(arrays.back()));
    fill(arrays.back(), bytes, i);
  }
  const std::uint64_t before = resident_memory();
  drop_all(*area);
  const std::uint64_t after = resident_memory();
  EXPECT_LT(after + 40 * kMiB, before) << "of 48 MiB";
  for (std::uint64_t i = 0; i < 6; ++i) EXPECT_TRUE(holds(arrays[i], bytes, i)) << i;
  int local = 0;
  EXPECT_FALSE(area->owns(&local));
  EXPECT_FALSE(area->owns(nullptr));
  EXPECT_GE(area->used(), 6 * bytes);
  for (void* const array : arrays) area->free(array);
  EXPECT_EQ(area->used(), 0u);
}

TEST(SpillArea, RoomIsUsedAgainAndIsZero) {
  const fs::path folder = disk_folder();
  SKIP_WITHOUT_DISK(folder);
  const auto area = std::move(*SpillArea::open(folder, 16 * kMiB));
  void* const first = area->allocate(4 * kMiB);
  void* const second = area->allocate(4 * kMiB);
  void* const third = area->allocate(8 * kMiB);
  ASSERT_TRUE(first && second && third);
  EXPECT_EQ(area->allocate(1), nullptr) << "no addresses are left";
  fill(first, 4 * kMiB, 1);
  fill(second, 4 * kMiB, 2);
  fill(third, 8 * kMiB, 3);
  area->free(first);
  EXPECT_EQ(area->allocate(5 * kMiB), nullptr);
  area->free(second);  // joins what was before it
  auto* const both = static_cast<std::byte*>(area->allocate(8 * kMiB));
  ASSERT_EQ(both, first);
  for (std::size_t i = 0; i < 8 * kMiB; i += 4096) ASSERT_EQ(both[i], std::byte{0}) << i;
  drop_all(*area);
  EXPECT_TRUE(holds(third, 8 * kMiB, 3));
  EXPECT_EQ(area->allocate(0), nullptr);
  EXPECT_EQ(area->allocate(SIZE_MAX), nullptr);
  EXPECT_EQ(area->allocate(17 * kMiB), nullptr);
}

TEST(SpillArea, ThreadsDropWhatOthersWrite) {
  const fs::path folder = disk_folder();
  SKIP_WITHOUT_DISK(folder);
  const auto area = std::move(*SpillArea::open(folder));
  std::vector<std::thread> threads;
  std::vector<int> wrong(3, 0);
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < 20; ++i) {
        void* const array = area->allocate((1 + i % 3) * kMiB);
        if (array == nullptr) continue;
        fill(array, kMiB, i);
        (void)area->drop(2 * kMiB);
        wrong[t] += holds(array, kMiB, i) ? 0 : 1;
        area->free(array);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(3, 0));
  EXPECT_EQ(area->used(), 0u);
}

TEST(SpillArea, NothingIsLeftInTheFolder) {
  const fs::path folder = disk_folder();
  SKIP_WITHOUT_DISK(folder);
  const fs::path own = folder / ("spill-" + std::to_string(getpid()));
  fs::create_directory(own);
  {
    const auto area = SpillArea::open(own);
    ASSERT_TRUE(area);
    EXPECT_NE((*area)->allocate(kMiB), nullptr);
    EXPECT_TRUE(fs::is_empty(own)) << "it has no name";
  }
  EXPECT_TRUE(fs::is_empty(own));
  fs::remove(own);
}

TEST(SpillArea, PlacesThatWillNotDoAreRefused) {
  const auto missing = SpillArea::open("/no/such/folder");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  EXPECT_EQ(missing.error().where, "/no/such/folder");
  if (!fs::is_directory("/dev/shm")) return;
  const auto memory = SpillArea::open("/dev/shm");
  ASSERT_FALSE(memory);
  EXPECT_EQ(memory.error().detail, "what is written here stays in memory");
}

}  // namespace
}  // namespace meshlode::cli
