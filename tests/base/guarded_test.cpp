// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/guarded.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace meshlode {
namespace {

TEST(Guarded, WhatTheBodyReturnsComesBack) {
  EXPECT_EQ(*guarded("a.glb", []() -> Result<int> { return 7; }), 7);
  const auto refused = guarded("a.glb", []() -> Result<int> {
    return Error{ErrorCode::kInvalid, "/accessors/3", "too short"};
  });
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().message(), "/accessors/3: too short");
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalid);
}

TEST(Guarded, MemoryThatCannotBeHadIsNoFaultOfTheFile) {
  const auto refused = guarded("a.glb", []() -> Result<int> { throw std::bad_alloc(); });
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kBuildFailed);
  EXPECT_EQ(refused.error().message(), "a.glb: out of memory");
}

TEST(Guarded, OurOwnMistakesAreInternalErrors) {
  const auto of_library = guarded("a.glb", []() -> Result<int> { return std::map<int, int>().at(3); });
  ASSERT_FALSE(of_library.ok());
  EXPECT_EQ(of_library.error().code, ErrorCode::kBuildFailed);
  EXPECT_TRUE(of_library.error().detail.starts_with("internal error (map::at")) << of_library.error().detail;
  EXPECT_NE(of_library.error().detail.find("please report it"), std::string::npos);
  const auto too_long = guarded("a.glb", []() -> Status {
    std::vector<int>().reserve(static_cast<std::size_t>(-1));  // length_error, which is no bad_alloc
    return Ok{};
  });
  ASSERT_FALSE(too_long.ok());
  EXPECT_TRUE(too_long.error().detail.starts_with("internal error")) << too_long.error().detail;
  const auto unknown = guarded("a.glb", []() -> Status { throw 7; });  // NOLINT: what no library throws
  ASSERT_FALSE(unknown.ok());
  EXPECT_TRUE(unknown.error().detail.starts_with("internal error")) << unknown.error().detail;
}

}  // namespace
}  // namespace meshlode
