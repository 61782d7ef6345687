// SPDX-License-Identifier: GPL-3.0-or-later
// bench_aggregate_pictures OUT.png AUTO.lode NEVER.lode [AUTO.lode NEVER.lode ...]: a row for each pair, of the same
// scene with and without --aggregate. For each of two sizes full resolution, the cut at one pixel of the first, and
// of the second the finest cut of no more triangles, or its coarsest one; pixels are box-filtered, and shown as
// squares.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "draw/raster/raster.h"
#include "draw/textures/texture_set.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace {

using namespace meshlode;

constexpr std::uint32_t kSamples = 8;  // a side of a pixel
constexpr std::uint32_t kPanel = 144;  // a side of what is shown of one
constexpr std::uint32_t kGap = 4;
constexpr double kShown = 1.6;  // of the mesh's longest side: a box fits from anywhere, but for its corners
constexpr std::array<std::uint32_t, 2> kPixels{72, 24};  // of a panel

[[noreturn]] void fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message().c_str());
  std::exit(static_cast<int>(error.code));
}

/// An asset of one mesh, and the parallel view of it that shows all.
class Shown {
 public:
  explicit Shown(const std::string& path) : asset_(open(path)) {
    masks_ = draw::load_alpha_masks(asset_);
    textures_ = draw::load_textures(asset_);
    const format::MeshRecord& mesh = asset_.meshes()[0];
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    Vec3d low{0.0}, high{0.0};
    for (int k = 0; k < 3; ++k) {
      low[k] = step * mesh.bounds_min[k] + mesh.origin[k];
      high[k] = step * mesh.bounds_max[k] + mesh.origin[k];
    }
    const Vec3d size = high - low;
    longest_ = std::max({size.x, size.y, size.z});
    const format::InstanceRecord& instance = asset_.instances()[0];
    const Vec3d center = 0.5 * (low + high);
    for (int row = 0; row < 3; ++row) {
      const double* m = instance.transform + 4 * row;
      camera_.target[row] = m[0] * center.x + m[1] * center.y + m[2] * center.z + m[3];
    }
    camera_.eye = camera_.target + 2.0 * instance.scale * glm::length(size) * glm::normalize(Vec3d(0.6, 0.45, 1.0));
    camera_.is_orthographic = true;
    camera_.ortho_height = kShown * instance.scale * longest_;
    camera_.near_distance = 1e-3 * instance.scale * longest_;
  }
  /// At one pixel of a panel of so many.
  [[nodiscard]] std::vector<ClusterId> at_pixels(double pixels) const { return at_error(kShown * longest_ / pixels); }
  [[nodiscard]] std::vector<ClusterId> all() const { return at_error(-1.0); }
  [[nodiscard]] std::vector<ClusterId> with_at_most(std::uint64_t triangles) const {
    double low = 0.0, high = 2.0 * longest_;
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (low + high);
      (count(at_error(middle)) <= triangles ? high : low) = middle;
    }
    return at_error(high);
  }
  [[nodiscard]] std::vector<ClusterId> at_error(double error) const {
    return run::select_uniform(asset_, MeshId(0U), error).clusters;
  }
  [[nodiscard]] std::uint64_t count(const std::vector<ClusterId>& clusters) const {
    std::uint64_t sum = 0;
    for (const ClusterId c : clusters) sum += asset_.clusters()[c.value].triangle_count();
    return sum;
  }

  /// A panel of so many pixels, from that column and row of `out` on.
  void draw(const std::vector<ClusterId>& clusters, std::uint32_t pixels, std::uint32_t left, std::uint32_t top,
            draw::Image& out) const {
    std::vector<run::ClusterInstance> cut;
    cut.reserve(clusters.size());
    for (const ClusterId c : clusters) cut.push_back({InstanceId(0U), c});
    run::Camera camera = camera_;
    camera.width = camera.height = pixels * kSamples;
    const auto seen = draw::draw_cut(asset_, cut, camera, masks_);
    if (!seen) fail(seen.error());
    const auto image = draw::shade_view(asset_, cut, camera, *seen, draw::View::kShaded, textures_);
    if (!image) fail(image.error());
    const std::uint32_t square = kPanel / pixels;
    for (std::uint32_t y = 0; y < pixels; ++y) {
      for (std::uint32_t x = 0; x < pixels; ++x) {
        for (std::uint32_t c = 0; c < 4; ++c) {
          std::uint32_t sum = 0;
          for (std::uint32_t s = 0; s < kSamples * kSamples; ++s) {
            const std::size_t row = std::size_t{y} * kSamples + s / kSamples, column = x * kSamples + s % kSamples;
            sum += image->rgba[4 * (row * image->width + column) + c];
          }
          const auto mean = static_cast<std::uint8_t>(sum / (kSamples * kSamples));
          for (std::uint32_t s = 0; s < square * square; ++s) {
            const std::size_t row = top + y * square + s / square, column = left + x * square + s % square;
            out.rgba[4 * (row * out.width + column) + c] = mean;
          }
        }
      }
    }
  }

 private:
  static run::Asset open(const std::string& path) {
    Result<run::Asset> asset = run::Asset::open(path);
    if (!asset) fail(asset.error());
    return std::move(*asset);
  }

  run::Asset asset_;
  draw::AlphaMasks masks_;
  draw::TextureSet textures_;
  run::Camera camera_;
  double longest_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4 || argc % 2 != 0) {
    std::fputs("usage: bench_aggregate_pictures OUT.png AUTO.lode NEVER.lode [AUTO.lode NEVER.lode ...]\n", stderr);
    return 2;
  }
  const auto rows = static_cast<std::uint32_t>(argc - 2) / 2;
  constexpr std::uint32_t kPanels = 3 * kPixels.size();
  draw::Image out{kPanels * kPanel + (kPanels - 1) * kGap, rows * kPanel + (rows - 1) * kGap, {}};
  out.rgba.assign(std::size_t{out.width} * out.height * 4, 255);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const Shown with(argv[2 + 2 * row]), without(argv[3 + 2 * row]);
    for (std::uint32_t size = 0; size < kPixels.size(); ++size) {
      const auto panel = [&](std::uint32_t i) { return (3 * size + i) * (kPanel + kGap); };
      const std::uint32_t top = row * (kPanel + kGap), pixels = kPixels[size];
      const std::vector<ClusterId> cut = with.at_pixels(pixels), other = without.with_at_most(with.count(cut));
      with.draw(with.all(), pixels, panel(0), top, out);
      with.draw(cut, pixels, panel(1), top, out);
      without.draw(other, pixels, panel(2), top, out);
      std::printf("%s, %.0f pixels across: %llu, %llu and %llu triangles\n", argv[2 + 2 * row], pixels / kShown,
                  static_cast<unsigned long long>(with.count(with.all())),
                  static_cast<unsigned long long>(with.count(cut)),
                  static_cast<unsigned long long>(without.count(other)));
    }
  }
  const std::vector<std::uint8_t> png = draw::encode_png(out);
  std::ofstream file(argv[1], std::ios::binary);
  file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  return file ? 0 : 5;
}
