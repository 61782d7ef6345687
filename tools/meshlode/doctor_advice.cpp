// SPDX-License-Identifier: GPL-3.0-or-later
#include "doctor_advice.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "app/report/read_meta.h"
#include "app/textures/shrink.h"
#include "base/append_format.h"
#include "base/byte_size.h"
#include "base/image_size.h"
#include "builder/aggregate/aggregate_choice.h"
#include "scene/detect/detect.h"
#include "scene/detect/fault.h"

namespace meshlode::cli {

namespace {

constexpr const char *kMaskedCards = "masked-cards", *kLoosePieces = "loose-pieces", *kHeavyImages = "heavy-images",
                     *kPlainPages = "plain-pages";
constexpr double kHeavyShare = 0.5;  ///< of the file: images weigh more than all the geometry

app::Diagnosis words(const char* id, const char* title, const char* remedy) {
  app::Diagnosis diagnosis;
  diagnosis.id = id;
  diagnosis.title = title;
  diagnosis.remedy = remedy;
  return diagnosis;
}

const app::Diagnosis& masked_words(bool is_built) {
  static const app::Diagnosis source =
      words(kMaskedCards, "triangles of masked cards, which a build thins out by what they cover",
            "none is needed; --aggregate never simplifies them by distance, with many more triangles far away");
  static const app::Diagnosis asset =
      words(kMaskedCards, "loose pieces that are simplified by distance in an asset with alpha masks",
            "build it without --aggregate never, or with --aggregate auto: far away they take a fraction of the "
            "triangles");
  return is_built ? asset : source;
}

/// Images together, with what a GPU holds of them: four bytes a texel, and a third more for mip levels.
class Images {
 public:
  void add(std::span<const std::uint8_t> image, std::string_view mime) {
    ++count_;
    bytes_ += image.size();
    const std::string kind = mime.empty() ? "unknown" : std::string(mime.substr(mime.find('/') + 1));
    if (std::ranges::find(formats_, kind) == formats_.end()) formats_.push_back(kind);
    const auto size = read_image_size(image);
    if (!size) return;
    if (const auto gpu_bytes = find_gpu_bytes(image)) {
      gpu_bytes_ += *gpu_bytes;
      decoded_.push_back(*size);
    }
    largest_ = std::max({largest_, size->width, size->height});
  }
  /// `other`: bytes that are no images.
  void advise(double other, const char* whole, std::vector<app::Diagnosis>& diagnoses) const {
    const double share = static_cast<double>(bytes_) / (static_cast<double>(bytes_) + other);
    if (count_ == 0 || !(share >= kHeavyShare)) return;
    app::DiagnosisPlace place;
    place.where = "scene";
    place.count = count_;
    std::string formats;
    for (const std::string& name : formats_) formats += (formats.empty() ? "" : ", ") + name;
    append_format(place.detail,
                  "images are %.0f%% of the %s: %s (%s) of %s, at most %u texels a side, about %s on a GPU",
                  100.0 * share, whole, app::counted(count_, "images").c_str(), formats.c_str(),
                  byte_size_text(bytes_).c_str(), largest_, byte_size_text(gpu_bytes_).c_str());
    const std::uint32_t half = largest_ / 2;
    std::uint64_t smaller = 0;
    for (const ImageSize& size : decoded_) {
      const auto [width, height] = app::fit_size(size.width, size.height, half);
      smaller += gpu_bytes_of({width, height});
    }
    if (half > 0 && smaller < gpu_bytes_) {
      append_format(place.detail, ", and %s with --textures resize:%u", byte_size_text(smaller).c_str(), half);
    }
    place.costs.push_back({"bytes", static_cast<double>(bytes_), "asset bytes"});
    app::add_place(diagnoses,
                   words(kHeavyImages, "images, which outweigh the geometry",
                         "build with --textures webp, which stores them in fewer bytes, or with --textures resize:N, "
                         "which a GPU holds in fewer too (KTX2 needs a tool of its own): without it an asset carries "
                         "them as they are, and a GPU holds PNG, JPEG and WebP decoded"),
                   std::move(place));
  }

 private:
  std::uint64_t count_ = 0, bytes_ = 0, gpu_bytes_ = 0;
  std::uint32_t largest_ = 0;
  std::vector<ImageSize> decoded_;  ///< of those that a GPU holds decoded
  std::vector<std::string> formats_;
};

}  // namespace

std::vector<std::string> advice_ids() {
  return {kMaskedCards, kLoosePieces, kHeavyImages, kPlainPages};
}

void add_advice(const scene::Scene& scene, std::vector<app::Diagnosis>& diagnoses) {
  const app::Diagnosis loose = words(
      kLoosePieces, "triangles of loose pieces without a mask, which are simplified by distance",
      "where they are seen together, as grass and gravel are, --aggregate auto or --aggregate NAME thins them out "
      "by what they cover");
  double triangles = 0.0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::SourceMesh& mesh = scene.meshes[m];
    triangles += static_cast<double>(scene::triangles_of(mesh));
    const auto decide = [&](AggregateChoice choice) {
      return builder::decide_aggregate(mesh, {.choice = choice, .materials = scene.materials});
    };
    const builder::AggregateDecision masked = decide(AggregateChoice::kMasked);
    const builder::AggregateDecision any = masked.is_aggregate ? masked : decide(AggregateChoice::kAuto);
    if (!any.is_aggregate) continue;
    app::DiagnosisPlace place;
    place.mesh = m;
    place.where = app::mesh_words(m, mesh.name);
    place.count = place.triangle_count = scene::triangles_of(mesh);
    place.detail = any.reason;
    app::add_place(diagnoses, masked.is_aggregate ? masked_words(false) : loose, std::move(place));
  }
  Images images;
  for (const scene::SceneBlob& blob : scene.blobs) {
    if (blob.kind == scene::SceneBlob::Kind::kImage) images.add(blob.bytes, blob.mime_type);
  }
  images.advise(scene::kBytesPerTriangle * triangles, "asset, about", diagnoses);
}

void add_advice(const run::Asset& asset, std::vector<app::Diagnosis>& diagnoses) {
  const app::MetaInfo meta = app::read_meta(asset.meta_json());
  const bool has_mask = std::ranges::any_of(asset.materials(), [](const format::MaterialRecord& material) {
    return material.alpha_mode == format::AlphaMode::kMask;
  });
  for (const app::MetaInfo::Decision& decision : meta.decisions) {
    if (!has_mask || !decision.is_kept || !decision.what.ends_with(": covered area")) continue;
    app::DiagnosisPlace place;
    place.where = decision.what.substr(0, decision.what.rfind(':'));
    place.count = 1;
    place.detail = decision.reason;
    app::add_place(diagnoses, masked_words(true), std::move(place));
  }
  std::uint64_t plain = 0;
  for (const format::PageRecord& page : asset.pages()) plain += page.codec == format::Codec::kNone ? page.bytes : 0;
  if (plain > 0 && meta.codec == "none") {
    app::DiagnosisPlace place;
    place.where = "scene";
    place.count = asset.pages().size();
    append_format(place.detail, "%s, %.0f%% of the file", byte_size_text(plain).c_str(),
                  100.0 * static_cast<double>(plain) / static_cast<double>(asset.bytes().size()));
    place.costs.push_back({"bytes", static_cast<double>(plain), "asset bytes"});
    app::add_place(
        diagnoses,
        words(kPlainPages, "pages, stored as they are",
              "`meshlode repack --codec strips` stores them in fewer bytes; for an engine that maps pages none "
              "is needed"),
        std::move(place));
  }
  Images images;
  double image_bytes = 0.0;
  for (const format::BlobRecord& blob : asset.blobs()) {
    if (blob.kind != format::BlobKind::kImage) continue;
    images.add(asset.blob_bytes(blob), asset.string(blob.mime_type));
    image_bytes += static_cast<double>(blob.bytes);
  }
  images.advise(static_cast<double>(asset.bytes().size()) - image_bytes, "file", diagnoses);
}

}  // namespace meshlode::cli
