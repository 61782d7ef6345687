// SPDX-License-Identifier: GPL-3.0-or-later
// Each fault that V410 looks for in requests and in culled frames is found, and what is right is none.
#include "judge/gpu/stream_requests.h"

#include <vector>

#include <gtest/gtest.h>

#include <meshlode/format.h>

namespace meshlode::judge {
namespace {

run::ClusterInstance item(std::uint32_t instance, std::uint32_t cluster) {
  return {InstanceId(instance), ClusterId(cluster)};
}

TEST(StreamRequests, PrioritiesAreTheCpusUpToRounding) {
  const float terminal = format::kInfiniteError;
  const std::vector<float> device{terminal, 2.0F, 0.0F};
  // Of a frame at half a pixel.
  EXPECT_EQ(find_priority_fault(device, std::vector<float>{terminal, 1.005F, 0.0F}, 0.5), "");
  for (const std::vector<float>& host :
       {std::vector<float>{terminal, 1.02F, 0.0F}, std::vector<float>{terminal, 0.0F, 0.0F},
        std::vector<float>{terminal, 1.0F, 1e-3F}, std::vector<float>{5.0F, 1.0F, 0.0F}, std::vector<float>{}}) {
    EXPECT_NE(find_priority_fault(device, host, 0.5), "");
  }
  EXPECT_EQ(find_priority_fault(device, std::vector<float>{terminal, 77.0F, 0.0F}, 0.0), "") << "wanted is wanted";
  EXPECT_NE(find_priority_fault(device, std::vector<float>{terminal, 77.0F, 1.0F}, 0.0), "");
}

TEST(StreamRequests, CulledFramesHaveNothingElse) {
  const std::vector<run::ClusterInstance> whole{item(0, 3), item(0, 4), item(1, 3)};
  const std::vector<float> all{4.0F, 2.0F, 0.0F};
  const auto fault = [&](const std::vector<run::ClusterInstance>& cut, const std::vector<float>& priorities) {
    return find_culled_fault({cut, priorities}, {whole, all});
  };
  EXPECT_EQ(fault(whole, all), "");
  EXPECT_EQ(fault({}, {0.0F, 0.0F, 0.0F}), "");
  EXPECT_EQ(fault({item(0, 4)}, {4.0F, 1.0F, 0.0F}), "");
  EXPECT_NE(fault({item(0, 4), item(1, 4)}, all), "") << "another instance's";
  EXPECT_NE(fault({item(0, 2)}, all), "");
  EXPECT_NE(fault(whole, {4.0F, 2.5F, 0.0F}), "");
  EXPECT_NE(fault(whole, {4.0F, 2.0F, 0.1F}), "");
}

TEST(StreamRequests, WhatWouldBeSeenIsAskedFor) {
  const std::vector<float> priorities{4.0F, 0.0F, 1.0F};
  EXPECT_EQ(find_unasked_page(priorities, std::vector<std::uint32_t>{0, 2, 2}), "");
  EXPECT_NE(find_unasked_page(priorities, std::vector<std::uint32_t>{0, 2, 1}), "");
}

}  // namespace
}  // namespace meshlode::judge
