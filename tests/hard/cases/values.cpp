// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that are none, or hardly any: NaN and infinity in a file, denormals, negative zeros, one point for all.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <unistd.h>

#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/samples.h"
#include "scene/import/import.h"

namespace meshlode::test::hard {

namespace {

/// A PLY in text, of doubles, in which every `period`-th vertex has `value` for its x. Read back by the importer.
Result<Sample> read_with(const char* value, double share, bool repair) {
  const scene::Primitive shape = make_lump(8);
  const std::size_t bad = share > 0.0 ? std::max<std::size_t>(1, static_cast<std::size_t>(share * 386.0)) : 0;
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(shape.positions.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(shape.indices.size() / 3) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  char line[128];
  for (std::size_t v = 0; v < shape.positions.size(); ++v) {
    const Vec3d& p = shape.positions[v];
    if (v < bad) {
      std::snprintf(line, sizeof line, "%s %.17g %.17g\n", value, p.y, p.z);
    } else {
      std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", p.x, p.y, p.z);
    }
    text += line;
  }
  for (std::size_t i = 0; i + 2 < shape.indices.size(); i += 3) {
    std::snprintf(line, sizeof line, "3 %u %u %u\n", shape.indices[i], shape.indices[i + 1], shape.indices[i + 2]);
    text += line;
  }
  const auto path = std::filesystem::temp_directory_path() / ("hard-" + std::to_string(getpid()) + ".ply");
  std::ofstream(path, std::ios::binary) << text;
  scene::ImportOptions options;
  options.repair = repair;
  Result<scene::Scene> scene = scene::import_scene(path, options);
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  if (!scene) {
    // Without the folder, which is another one each time.
    return Error{scene.error().code, "scene.ply", scene.error().detail};
  }
  scene->source_name = "scene.ply";
  for (scene::SourceMesh& mesh : scene->meshes) mesh.name = "sample";
  Sample sample;
  sample.scene = std::move(*scene);
  sample.options.repair = repair;
  return sample;
}

Result<Sample> not_a_number(double share) {
  return read_with("nan", share, false);
}
Result<Sample> not_a_number_repaired(double share) {
  return read_with("nan", share, true);
}
Result<Sample> infinite(double share) {
  return read_with("inf", share, false);
}
Result<Sample> overflowing(double exponent) {
  const std::string value = "1e" + std::to_string(static_cast<int>(exponent));
  return read_with(value.c_str(), 0.001, false);
}

/// A lump whose coordinates below 0.5 in magnitude become denormals, or zeros of either sign.
Result<Sample> denormals(double share) {
  std::uint32_t at = 0;
  const auto every = static_cast<std::uint32_t>(1.0 / share + 0.5);
  return sample_of(mapped(make_lump(10), [&](const Vec3d& p) {
    Vec3d q = p;
    if (at++ % every == 0) q[static_cast<int>(at / every % 3)] = (at & 1U) != 0 ? 4.9e-324 : -2.2e-310;
    return q;
  }));
}

Result<Sample> one_point(double triangles) {
  scene::Primitive shape;
  shape.material = MaterialId(0U);
  for (std::uint32_t i = 0; i < 3 * static_cast<std::uint32_t>(triangles); ++i) {
    shape.positions.emplace_back(0.25, -7.0, 3.0);
    shape.indices.push_back(i);
  }
  return sample_of(std::move(shape));
}

}  // namespace

std::vector<HardCase> value_cases() {
  return {
      {.room = "values",
       .name = "nan",
       .parameter = "share of positions that are NaN, in a PLY",
       .sweep = {0.0, 0.01, 0.5, 1.0},
       .is_quick = true,
       .make = not_a_number},
      {.room = "values",
       .name = "nan-repaired",
       .parameter = "the same with --repair",
       .sweep = {0.0, 0.01, 0.5, 1.0},
       .is_quick = false,
       .make = not_a_number_repaired},
      {.room = "values",
       .name = "infinity",
       .parameter = "share of positions that are infinite, in a PLY",
       .sweep = {0.0, 0.01, 1.0},
       .is_quick = false,
       .make = infinite},
      {.room = "values",
       .name = "overflow",
       .parameter = "power of ten of one coordinate, in a PLY",
       .sweep = {3, 30, 150, 160, 300, 400},
       .is_whole = true,
       .is_quick = false,
       .make = overflowing},
      {.room = "values",
       .name = "denormals",
       .parameter = "share of vertices with a denormal coordinate",
       .sweep = {0.01, 0.1, 1.0},
       .is_quick = true,
       .make = denormals},
      {.room = "values",
       .name = "one-point",
       .parameter = "triangles, all corners in one point",
       .sweep = {1, 1000},
       .is_whole = true,
       .is_quick = true,
       .make = one_point},
  };
}

}  // namespace meshlode::test::hard
