// SPDX-License-Identifier: GPL-3.0-or-later
// A device for tests: Mesa's lavapipe unless VK_DRIVER_FILES says otherwise, with validation and synchronization
// validation, and scenes to draw.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/options.h"
#include "draw/gpu/vulkan/vulkan.h"
#include "judge/pictures/cameras.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::draw::test {

/// One device for the whole program; nothing where there is no Vulkan (then `why` says why).
[[nodiscard]] std::optional<Device> shared_device(std::string& why);

/// Tests of this fixture are skipped where there is no device, unless MESHLODE_REQUIRE_GPU is 1; and they fail if the
/// validation layer says anything.
class GpuTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
  std::optional<Device> device_;
};

/// Bytes of the asset built from a scene file; empty where that failed (the test is failed too).
[[nodiscard]] std::vector<std::uint8_t> build_file(const std::string& path,
                                                   const builder::PipelineOptions& options = {});

}  // namespace meshlode::draw::test
