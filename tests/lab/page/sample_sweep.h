// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep that never was: its numbers are made up by formulas, to see the page before there is a sweep and to test it
// with.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace meshlode::lab::page {

/// sweep.json with made-up numbers. `scene` is the name of its scene.
[[nodiscard]] std::string made_up_sweep(const std::string& scene = "made-up.glb");

/// The pictures that it names, PNG: discs, and where they differ.
[[nodiscard]] std::map<std::string, std::vector<std::uint8_t>> made_up_pictures();

}  // namespace meshlode::lab::page
