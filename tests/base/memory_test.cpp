// SPDX-License-Identifier: GPL-3.0-or-later
// What is available is read from files as Linux has them, laid out in a folder of the test's own.
#include "base/memory.h"

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode {
namespace {

namespace fs = std::filesystem;

class FakeRoot {
 public:
  FakeRoot() {
    std::string name = fs::temp_directory_path() / "meshlode-memory-XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~FakeRoot() { fs::remove_all(folder_); }
  FakeRoot(const FakeRoot&) = delete;
  FakeRoot& operator=(const FakeRoot&) = delete;
  void put(const std::string& path, const std::string& text) const {
    fs::create_directories((folder_ / path).parent_path());
    std::ofstream(folder_ / path) << text;
  }
  [[nodiscard]] std::optional<std::uint64_t> available() const { return available_memory(folder_); }

 private:
  fs::path folder_;
};

constexpr const char* kMemInfo = "MemTotal:        8000 kB\nMemFree:          100 kB\nMemAvailable:    5000 kB\n";

TEST(Memory, WhatTheMachineHas) {
  FakeRoot root;
  EXPECT_FALSE(root.available()) << "nothing is known";
  root.put("proc/meminfo", kMemInfo);
  EXPECT_EQ(root.available(), 5000u * 1024);
}

TEST(Memory, AGroupOfVersion2LeavesLessAndSoDoesTheOneAbove) {
  FakeRoot root;
  root.put("proc/meminfo", kMemInfo);
  root.put("proc/self/cgroup", "0::/outer/inner\n");
  root.put("sys/fs/cgroup/outer/inner/memory.max", "max\n");
  root.put("sys/fs/cgroup/outer/inner/memory.current", "1000\n");
  EXPECT_EQ(root.available(), 5000u * 1024) << "max is no limit";
  root.put("sys/fs/cgroup/outer/memory.max", "3000000\n");
  root.put("sys/fs/cgroup/outer/memory.current", "1000000\n");
  EXPECT_EQ(root.available(), 2000000u);
  root.put("sys/fs/cgroup/outer/memory.stat", "anon 500000\nfile 500000\ninactive_file 400000\n");
  EXPECT_EQ(root.available(), 2400000u) << "cache is dropped before anything is killed";
  root.put("sys/fs/cgroup/outer/inner/memory.max", "900\n");
  EXPECT_EQ(root.available(), 0u) << "it has more than it may have already";
}

TEST(Memory, AGroupOfVersion1AndOneWhoseNameIsThatOutside) {
  FakeRoot root;
  root.put("proc/self/cgroup", "5:cpu,cpuacct:/x\n4:memory:/docker/0123\n0::/\n");
  root.put("sys/fs/cgroup/memory/memory.limit_in_bytes", "700000\n");
  root.put("sys/fs/cgroup/memory/memory.usage_in_bytes", "300000\n");
  root.put("sys/fs/cgroup/memory/memory.stat", "inactive_file 1\ntotal_inactive_file 100000\n");
  EXPECT_EQ(root.available(), 500000u);
  root.put("sys/fs/cgroup/memory/docker/0123/memory.limit_in_bytes", "9223372036854771712\n");
  root.put("sys/fs/cgroup/memory/docker/0123/memory.usage_in_bytes", "300000\n");
  EXPECT_EQ(root.available(), 500000u);
}

TEST(Memory, LinesThatSayNothingAreNoLimit) {
  FakeRoot root;
  root.put("proc/meminfo", "MemAvailable: kB\n");
  root.put("proc/self/cgroup", "\n::\nnonsense\n7:memory\n");
  root.put("sys/fs/cgroup/memory.max", "");
  EXPECT_FALSE(root.available());
}

TEST(Memory, ThisMachineSaysSomething) {
  EXPECT_GT(resident_memory(), 100000u);
  const auto available = available_memory();
  ASSERT_TRUE(available);
  EXPECT_GT(*available, 0u);
}

// What was given back before does not count, what is there for a moment does.
TEST(Memory, ThePeakStartsAnew) {
  constexpr std::size_t kBytes = std::size_t{64} << 20U;
  const auto touch = [] { return std::vector<char>(kBytes, 1).back(); };
  EXPECT_EQ(touch(), 1);
  give_back_freed_memory();
  if (!restart_peak_memory()) GTEST_SKIP() << "this system keeps one peak";
  EXPECT_LT(peak_memory(), resident_memory() + kBytes / 2);
  const std::uint64_t before = resident_memory();
  EXPECT_EQ(touch(), 1);
  EXPECT_GE(peak_memory(), before + kBytes - kBytes / 8);
}

}  // namespace
}  // namespace meshlode
