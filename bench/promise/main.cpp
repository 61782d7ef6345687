// SPDX-License-Identifier: GPL-3.0-or-later
// bench_promise SCENE --position A.lode --texels B.lode --appearance C.lode: what each promise keeps and costs, over
// cameras around the scene. Of each asset the cut that its promise selects; its largest drift in pixels by the judge's
// own metric, in the units of all three promises; triangles and bytes; and the picture against that of full resolution.
// One JSON document (docs/log/quality.md, "What is painted").
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json_writer.h"
#include "command_line.h"
#include "draw/raster/raster.h"
#include "draw/textures/texture_set.h"
#include "format/names.h"
#include "judge/metrics/product_distance.h"
#include "judge/pictures/cameras.h"
#include "judge/verify/promises.h"
#include "lab/flip/flip.h"
#include "run/decode/decode.h"
#include "run/select/select.h"
#include "scene/import/import.h"

namespace {

using namespace meshlode;

constexpr std::array kPromises{format::Promise::kPosition, format::Promise::kTexels, format::Promise::kAppearance};

struct Options {
  std::string scene, pictures;
  std::array<std::string, 3> assets;  ///< by promise
  std::uint32_t orbits = 50, picture_every = 5, width = 800, height = 600, crop = 220;
  std::uint64_t samples = 20000;
  double pixel_error = 1.0, picture_error = 4.0;
  std::size_t jobs = 0;
};

std::optional<int> read_options(int argc, char** argv, Options& o) {
  CLI::App app("What promises keep and cost, over cameras around a scene", "bench_promise");
  app.option_defaults()->always_capture_default();
  app.add_option("scene", o.scene, "the source")->required();
  app.add_option("--position", o.assets[0], "built with --promise position")->required();
  app.add_option("--texels", o.assets[1], "built with --promise texels")->required();
  app.add_option("--appearance", o.assets[2], "built with --promise appearance: units are as it says")->required();
  app.add_option("--orbits", o.orbits, "cameras around the scene, from close to far")->check(CLI::PositiveNumber);
  app.add_option("--picture-every", o.picture_every, "of so many cameras one is drawn")->check(CLI::PositiveNumber);
  app.add_option("--pixel-error", o.pixel_error, "of the cuts")->check(CLI::PositiveNumber);
  app.add_option("--samples", o.samples, bench::kSamplesHelp);
  app.add_option("--pictures", o.pictures, "write a picture there: full resolution, position, texels, appearance");
  app.add_option("--picture-error", o.picture_error, "pixel error of that picture")->check(CLI::PositiveNumber);
  app.add_option("--jobs", o.jobs, bench::kJobsHelp);
  return bench::read_command_line(app, argc, argv);
}

using Cut = std::vector<run::ClusterInstance>;

/// What the judge measures cuts of one mesh against, by unit.
struct MeshTruth {
  std::array<std::optional<judge::ProductDistanceFrom>, 3> by_unit;
};

std::vector<MeshTruth> make_truth(const scene::Scene& source, const run::Asset& units, std::uint64_t samples) {
  std::vector<MeshTruth> truth(units.meshes().size());
  for (std::size_t m = 0; m < truth.size(); ++m) {
    const judge::ShadedSurface surface = judge::painted_surface_of_source(source.meshes[m]);
    for (std::size_t unit = 0; unit < kPromises.size(); ++unit) {
      const judge::ProductScales scales = kPromises[unit] == format::Promise::kPosition
                                              ? judge::ProductScales{}
                                              : judge::scales_of(units, MeshId(m), kPromises[unit]);
      truth[m].by_unit[unit].emplace(surface, scales, judge::DeviationOptions{.samples = samples});
    }
  }
  return truth;
}

/// One asset by one promise.
class Promised {
 public:
  Promised(run::Asset asset, format::Promise promise, std::vector<run::DecodedCluster> decoded)
      : asset_(std::move(asset)), promise_(promise), decoded_(std::move(decoded)) {}
  void load_pictures() {
    masks_ = draw::load_alpha_masks(asset_);
    textures_ = draw::load_textures(asset_);
  }
  [[nodiscard]] const run::Asset& asset() const { return asset_; }
  [[nodiscard]] format::Promise promise() const { return promise_; }
  [[nodiscard]] Cut select(const run::Camera& camera, double pixel_error) const {
    return run::select_bvh(asset_, camera, pixel_error);
  }
  [[nodiscard]] std::uint64_t triangles(const Cut& cut) const {
    std::uint64_t sum = 0;
    for (const run::ClusterInstance& entry : cut) sum += asset_.clusters()[entry.cluster.value].triangle_count();
    return sum;
  }
  /// Stored bytes of the pages that hold what is drawn.
  [[nodiscard]] std::uint64_t bytes(const Cut& cut) const {
    std::vector<std::uint8_t> is_used(asset_.pages().size(), 0);
    for (const run::ClusterInstance& entry : cut) {
      is_used[asset_.groups()[asset_.clusters()[entry.cluster.value].coarser_group].page] = 1;
    }
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p < is_used.size(); ++p) sum += is_used[p] != 0 ? asset_.pages()[p].stored_bytes : 0;
    return sum;
  }
  struct Picture {
    draw::Image image;
    draw::VisibilityBuffer seen;
  };
  [[nodiscard]] Picture draw(const Cut& cut, const run::Camera& camera) const {
    Picture out;
    auto seen = draw::draw_cut(asset_, cut, camera, masks_);
    if (!seen) std::exit(bench_failure(seen.error()));
    auto image = draw::shade_view(asset_, cut, camera, *seen, draw::View::kShaded, textures_);
    if (!image) std::exit(bench_failure(image.error()));
    out.image = std::move(*image);
    out.seen = std::move(*seen);
    return out;
  }
  static int bench_failure(const Error& error) {
    std::fprintf(stderr, "bench_promise: %s\n", error.message().c_str());
    return static_cast<int>(error.code);
  }

  /// The largest drift in pixels of a cut, in each of the units from `first` on up to `last`.
  void measure(const Cut& cut, const run::Camera& camera, const std::vector<MeshTruth>& truth, std::size_t first,
               std::size_t last, std::array<double, 3>& largest) const {
    const double k = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
    for (std::size_t begin = 0; begin < cut.size();) {
      std::vector<ClusterId> clusters;
      const InstanceId id = cut[begin].instance;
      for (; begin < cut.size() && cut[begin].instance == id; ++begin) clusters.push_back(cut[begin].cluster);
      const format::InstanceRecord& instance = asset_.instances()[id.value];
      const auto weight = [&](const Vec3d& p) {
        Vec3d world{0.0};
        for (int row = 0; row < 3; ++row) {
          const double* m = instance.transform + 4 * row;
          world[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
        }
        return k * instance.scale / std::max(glm::length(world - camera.eye), camera.near_distance);
      };
      const judge::ShadedSurface surface =
          judge::shaded_surface_of_clusters(asset_, decoded_, MeshId(instance.mesh), clusters);
      for (std::size_t unit = first; unit <= last; ++unit) {
        const double found = truth[instance.mesh].by_unit[unit]->find_largest(surface, weight).max;
        largest[unit] = std::max(largest[unit], found);
      }
    }
  }

 private:
  run::Asset asset_;
  format::Promise promise_;
  std::vector<run::DecodedCluster> decoded_;
  draw::AlphaMasks masks_;
  draw::TextureSet textures_;
};

/// Over the pixels where either picture shows something.
struct Difference {
  double flip = 0.0, mse = 0.0, pixels = 0.0;
};

Difference compare(const lab::FlipReference& reference, const Promised::Picture& full,
                   const Promised::Picture& picture) {
  const lab::FlipPicture flip = reference.compare(picture.image.rgba);
  Difference out;
  for (std::size_t p = 0; p < flip.difference.size(); ++p) {
    constexpr auto kNothing = draw::VisibilityBuffer::kNothing;
    if (full.seen.item[p] == kNothing && picture.seen.item[p] == kNothing) continue;
    out.pixels += 1.0;
    out.flip += flip.difference[p];
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = int{full.image.rgba[4 * p + c]} - int{picture.image.rgba[4 * p + c]};
      out.mse += d * d / 3.0;
    }
  }
  return out;
}

/// The pictures' middles side by side: of `size` pixels around the middle of what the first one shows.
draw::Image side_by_side(const std::vector<Promised::Picture>& pictures, std::uint32_t size, std::uint32_t left,
                         std::uint32_t top) {
  const auto count = static_cast<std::uint32_t>(pictures.size());
  constexpr std::uint32_t kGap = 4;
  draw::Image out{count * size + (count - 1) * kGap, size, {}};
  out.rgba.assign(std::size_t{out.width} * out.height * 4, 255);
  for (std::uint32_t i = 0; i < count; ++i) {
    const draw::Image& image = pictures[i].image;
    for (std::uint32_t y = 0; y < size; ++y) {
      const std::size_t from = (std::size_t{top + y} * image.width + left) * 4;
      const std::size_t to = (std::size_t{y} * out.width + i * (size + kGap)) * 4;
      std::copy_n(image.rgba.begin() + static_cast<std::ptrdiff_t>(from), std::size_t{size} * 4,
                  out.rgba.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  return out;
}

/// Where a square of `size` pixels has the largest sum of differences between the first two pictures; its corner.
std::array<std::uint32_t, 2> find_most_changed(const lab::FlipPicture& flip, std::uint32_t size) {
  std::array<std::uint32_t, 2> best{0, 0};
  double most = -1.0;
  for (std::uint32_t top = 0; top + size <= flip.height; top += 20) {
    for (std::uint32_t left = 0; left + size <= flip.width; left += 20) {
      double sum = 0.0;
      for (std::uint32_t y = top; y < top + size; y += 2) {
        for (std::uint32_t x = left; x < left + size; x += 2) sum += flip.difference[std::size_t{y} * flip.width + x];
      }
      if (sum > most) {
        most = sum;
        best = {left, top};
      }
    }
  }
  return best;
}

Result<Promised> open_promised(const std::string& path, format::Promise promise) {
  Result<run::Asset> asset = run::Asset::open(path);
  if (asset) asset = asset->with_promise(promise);
  if (!asset) return asset.error();
  Result<std::vector<run::DecodedCluster>> decoded = run::decode_all(*asset);
  if (!decoded) return decoded.error();
  return Promised(std::move(*asset), promise, std::move(*decoded));
}

struct Sums {
  double triangles = 0.0, bytes = 0.0;
  std::array<double, 3> drift{};  ///< largest, by unit
  Difference difference;
};

int measure(const Options& o) {
  const Result<scene::Scene> source = scene::import_scene(o.scene, {.may_lack_images = true});
  if (!source) return Promised::bench_failure(source.error());
  std::vector<Promised> promised;
  for (std::size_t i = 0; i < kPromises.size(); ++i) {
    Result<Promised> opened = open_promised(o.assets[i], kPromises[i]);
    if (!opened) return Promised::bench_failure(opened.error());
    promised.push_back(std::move(*opened));
  }
  for (Promised& one : promised) one.load_pictures();
  const std::vector<MeshTruth> truth = make_truth(*source, promised.back().asset(), o.samples);
  const std::vector<judge::NamedCamera> cameras =
      judge::orbit_cameras(promised[0].asset(), o.orbits, o.width, o.height);
  std::array<Sums, 3> sums;
  std::uint32_t drawn = 0;
  double worst_flip = -1.0;
  const run::Camera* worst_camera = nullptr;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const run::Camera& camera = cameras[c].camera;
    const bool is_drawn = c % o.picture_every == 0;
    std::optional<Promised::Picture> full;
    std::optional<lab::FlipReference> reference;
    if (is_drawn) {
      full = promised[0].draw(promised[0].select(camera, 0.0), camera);
      reference.emplace(full->image.rgba, full->image.width, full->image.height);
      ++drawn;
    }
    for (std::size_t i = 0; i < promised.size(); ++i) {
      const Cut cut = promised[i].select(camera, o.pixel_error);
      sums[i].triangles += static_cast<double>(promised[i].triangles(cut));
      sums[i].bytes += static_cast<double>(promised[i].bytes(cut));
      promised[i].measure(cut, camera, truth, i, i == 0 ? 2 : i, sums[i].drift);
      if (!is_drawn) continue;
      const Difference difference = compare(*reference, *full, promised[i].draw(cut, camera));
      sums[i].difference.flip += difference.flip;
      sums[i].difference.mse += difference.mse;
      sums[i].difference.pixels += difference.pixels;
      if (i == 0 && difference.flip / std::max(1.0, difference.pixels) > worst_flip && difference.pixels > 20000.0) {
        worst_flip = difference.flip / difference.pixels;
        worst_camera = &camera;
      }
    }
  }
  if (!o.pictures.empty() && worst_camera != nullptr) {
    std::vector<Promised::Picture> pictures{promised[0].draw(promised[0].select(*worst_camera, 0.0), *worst_camera)};
    for (const Promised& one : promised) {
      pictures.push_back(one.draw(one.select(*worst_camera, o.picture_error), *worst_camera));
    }
    const lab::FlipPicture flip = lab::flip(pictures[0].image.rgba, pictures[1].image.rgba, o.width, o.height);
    const auto [left, top] = find_most_changed(flip, o.crop);
    const std::vector<std::uint8_t> png = draw::encode_png(side_by_side(pictures, o.crop, left, top));
    std::ofstream(o.pictures, std::ios::binary)
        .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  }
  JsonWriter json;
  json.begin_object();
  json.field("scene", std::filesystem::path(o.scene).filename().string());
  json.field("pixel_error", o.pixel_error);
  json.field("orbits", o.orbits);
  json.field("drawn", drawn);
  json.field("samples", o.samples);
  json.key("promises");
  json.begin_array();
  for (std::size_t i = 0; i < promised.size(); ++i) {
    const Sums& sum = sums[i];
    json.begin_object();
    json.field("promise", format::name_of(promised[i].promise()));
    json.field("triangles", sum.triangles / static_cast<double>(cameras.size()));
    json.field("bytes", sum.bytes / static_cast<double>(cameras.size()));
    json.field("file_bytes", std::uint64_t{promised[i].asset().bytes().size()});
    json.key("drift_px");
    json.begin_object();
    for (std::size_t unit = i; unit <= (i == 0 ? 2 : i); ++unit) {
      json.field(format::name_of(kPromises[unit]), sum.drift[unit]);
    }
    json.end_object();
    json.field("flip", sum.difference.flip / std::max(1.0, sum.difference.pixels));
    const double mse = sum.difference.mse / std::max(1.0, sum.difference.pixels);
    json.field("psnr_db", mse > 0.0 ? 10.0 * std::log10(255.0 * 255.0 / mse) : HUGE_VAL);
    json.end_object();
  }
  json.end_array();
  json.end_object();
  std::printf("%s\n", json.text().c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (const auto code = read_options(argc, argv, options)) return *code;
  const bench::ThreadLimit limit(options.jobs);
  return measure(options);
}
