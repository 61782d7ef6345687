// SPDX-License-Identifier: GPL-3.0-or-later
// The program's operator new asks for huge pages, by what the system says of the mappings, and delete gives them back.
#include "meshlode/large_arrays.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::cli {
namespace {

enum class Pages { kNone, kSmall, kHuge };

/// Which pages the address asked for: /proc/self/smaps, where "hg" among the flags is MADV_HUGEPAGE.
Pages pages_of(const void* address) {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/smaps");
  bool is_inside = false;
  for (std::string line; std::getline(maps, line);) {
    unsigned long long first = 0, end = 0;
    if (std::sscanf(line.c_str(), "%llx-%llx ", &first, &end) == 2) is_inside = first <= at && at < end;
    if (!is_inside || !line.starts_with("VmFlags:")) continue;
    return (line + " ").find(" hg ") != std::string::npos ? Pages::kHuge : Pages::kSmall;
  }
  return Pages::kNone;
}

TEST(LargeArrays, LieInHugePagesAndAreGivenBack) {
#ifdef MESHLODE_SANITIZED
  GTEST_SKIP() << "operator new is the sanitizer's";
#endif
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage")) GTEST_SKIP() << "no huge pages";
  give_back_large_arrays();
  const std::vector<std::uint8_t> small(1 << 20, 1);
  EXPECT_EQ(pages_of(&small[small.size() / 2]), Pages::kSmall);
  std::vector<std::uint8_t> large(8 << 20, 1);
  const std::uint8_t* const middle = &large[large.size() / 2];
  ASSERT_NE(pages_of(middle), Pages::kNone) << "/proc/self/smaps does not say it";
  EXPECT_EQ(pages_of(middle), Pages::kHuge);
  std::vector<std::uint8_t>().swap(large);
  EXPECT_NE(pages_of(middle), Pages::kHuge) << "it is freed";
}

}  // namespace
}  // namespace meshlode::cli
