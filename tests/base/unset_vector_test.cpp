// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/unset_vector.h"

#include <cstdint>
#include <cstring>
#include <new>

#include <gtest/gtest.h>

#include "base/parallel.h"

namespace meshlode {
namespace {

struct WithDefaults {
  std::uint32_t a = 7, b = 8;
};

// Through the allocator, since what an element that is not set holds may not be read.
TEST(UnsetVector, AnElementWithoutAValueIsNotTouched) {
  alignas(WithDefaults) unsigned char bytes[sizeof(WithDefaults)];
  std::memset(bytes, 0x5A, sizeof(bytes));
  auto* const at = reinterpret_cast<WithDefaults*>(bytes);
  UnsetAllocator<WithDefaults>().construct(at);
  for (const unsigned char byte : bytes) EXPECT_EQ(byte, 0x5A);
  UnsetAllocator<WithDefaults>().construct(at, WithDefaults{1, 2});
  EXPECT_EQ(std::launder(at)->b, 2U);
}

TEST(UnsetVector, KeepsWhatItIsGiven) {
  UnsetVector<std::uint32_t> numbers(3, 5U);
  EXPECT_EQ(numbers, UnsetVector<std::uint32_t>({5, 5, 5}));
  numbers.push_back(6);
  numbers.resize(10000);
  parallel_for_each_index(numbers.size() - 4, 100,
                          [&](std::size_t i) { numbers[i + 4] = static_cast<std::uint32_t>(i); });
  EXPECT_EQ(numbers[2], 5U);
  EXPECT_EQ(numbers[3], 6U);
  EXPECT_EQ(numbers.back(), 9995U);
  const UnsetVector<std::uint32_t> copy = numbers;
  EXPECT_EQ(copy, numbers);
}

}  // namespace
}  // namespace meshlode
