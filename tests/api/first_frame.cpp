// SPDX-License-Identifier: MIT
// The program of docs/tutorials/first-frame.md: an asset becomes a picture, with the runtime alone.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include <meshlode/runtime.h>

namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr double kFovy = 0.7853981633974483;  // full vertical angle, radians

struct Point {
  double x, y, z;  // pixels, and the distance along the view
};

/// Mesh space relative to the mesh's origin, to pixels. The camera is at `eye` and looks along -z.
Point project(const meshlode::format::InstanceRecord& instance, const meshlode::format::MeshRecord& mesh,
              const std::array<float, 3>& p, const std::array<double, 3>& eye) {
  double world[3];
  for (int row = 0; row < 3; ++row) {
    const double* m = instance.transform + 4 * row;  // row-major 3x4
    world[row] = m[3];
    for (int k = 0; k < 3; ++k)
      world[row] += m[k] * (mesh.origin[k] + static_cast<double>(p[static_cast<std::size_t>(k)]));
  }
  const double distance = eye[2] - world[2];
  const double scale = kHeight / (2.0 * std::tan(kFovy / 2.0)) / distance;
  return {kWidth / 2.0 + (world[0] - eye[0]) * scale, kHeight / 2.0 - (world[1] - eye[1]) * scale, distance};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 1;

  // 1. Open the asset and look at its tables.
  const auto asset = meshlode::AssetFile::open(argv[1]);
  if (!asset) {
    std::fprintf(stderr, "%s\n", asset.error().message().c_str());
    return static_cast<int>(asset.error().code);
  }
  const auto meshes = asset->meshes();
  if (meshes.empty() || asset->instances().empty()) return 1;

  // 2. Choose what to draw: at most one pixel of error.
  meshlode::View view;
  view.eye = {0.0, 0.0, 2.0 * meshes[0].diagonal};
  view.fovy_radians = kFovy;
  view.height_px = kHeight;
  const auto items = asset->select_view(view, 1.0);
  if (!items) return 1;

  // 3. Load the pages that hold the chosen clusters, each once.
  std::map<std::uint32_t, meshlode::PageBytes> resident;
  for (const meshlode::DrawItem& item : *items) {
    const std::uint32_t page = asset->page_of(item.cluster);
    if (resident.contains(page)) continue;
    auto loaded = asset->load_page(page);
    if (!loaded) return 1;
    resident.emplace(page, *std::move(loaded));
  }

  // 4. Draw each cluster with the transform of its instance.
  std::vector<double> depth(kWidth * kHeight, 1e300);
  std::vector<unsigned char> picture(3 * depth.size(), 32);
  std::size_t triangles = 0;
  meshlode::ClusterFloats cluster;
  for (const meshlode::DrawItem& item : *items) {
    const auto& instance = asset->instances()[item.instance];
    if (!asset->decode(resident.at(asset->page_of(item.cluster)), item.cluster, cluster)) return 1;
    for (const auto& corners : cluster.triangles) {
      ++triangles;
      const Point a = project(instance, meshes[instance.mesh], cluster.positions[corners[0]], view.eye);
      const Point b = project(instance, meshes[instance.mesh], cluster.positions[corners[1]], view.eye);
      const Point c = project(instance, meshes[instance.mesh], cluster.positions[corners[2]], view.eye);
      const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      if (area == 0.0 || std::min({a.z, b.z, c.z}) <= 0.0) continue;
      const int x1 = std::min(kWidth - 1, static_cast<int>(std::max({a.x, b.x, c.x})));
      const int y1 = std::min(kHeight - 1, static_cast<int>(std::max({a.y, b.y, c.y})));
      for (int y = std::max(0, static_cast<int>(std::min({a.y, b.y, c.y}))); y <= y1; ++y) {
        for (int x = std::max(0, static_cast<int>(std::min({a.x, b.x, c.x}))); x <= x1; ++x) {
          const double u = ((b.x - x) * (c.y - y) - (b.y - y) * (c.x - x)) / area;
          const double v = ((c.x - x) * (a.y - y) - (c.y - y) * (a.x - x)) / area;
          const double z = u * a.z + v * b.z + (1.0 - u - v) * c.z;
          const std::size_t pixel = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
          if (u < 0.0 || v < 0.0 || u + v > 1.0 || z >= depth[pixel]) continue;
          depth[pixel] = z;
          for (std::size_t k = 0; k < 3; ++k)  // a colour per cluster
            picture[3 * pixel + k] = static_cast<unsigned char>(96 + (item.cluster * (37 + 24 * k)) % 160);
        }
      }
    }
  }

  // 5. Write the picture as PPM.
  std::FILE* out = std::fopen(argv[2], "wb");
  if (!out) return 2;
  std::fprintf(out, "P6 %d %d 255\n", kWidth, kHeight);
  std::fwrite(picture.data(), 1, picture.size(), out);
  std::fclose(out);
  std::printf("%zu clusters, %zu triangles, %zu of %zu pages\n", items->size(), triangles, resident.size(),
              asset->pages().size());
  return 0;
}
