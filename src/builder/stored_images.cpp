// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/stored_images.h"

#include <utility>

#include "base/image_size.h"
#include "base/try.h"
#include "builder/textures/image_converter.h"

namespace meshlode::builder {

Result<StoredImages> store_images(const scene::Scene& scene, const PipelineOptions& options,
                                  std::vector<PlanDecision>& decisions) {
  StoredImages out;
  if (options.textures.is_keep()) return out;
  if (options.images == nullptr) return Error{ErrorCode::kUnsupported, "textures", "nothing here decodes images"};
  TRY_LET(converted, options.images->convert(scene, options.textures));
  out.blobs = scene.blobs;
  for (std::uint32_t i = 0; i < out.blobs.size(); ++i) {
    ConvertedImage& image = (*converted)[i];
    scene::SceneBlob& blob = out.blobs[i];
    if (!image.note.empty()) {
      std::string what = "scene: image " + std::to_string(blob.source_index);
      if (!blob.name.empty()) what += " \"" + blob.name + "\"";
      decisions.push_back({std::move(what), true, std::move(image.note)});
      decisions.back().mesh = format::kNone;
    }
    if (image.bytes.empty()) continue;
    const ImageSize size = read_image_size(blob.bytes).value_or(ImageSize{});
    out.replaced.push_back({i, blob.bytes.size(), size.width, size.height, blob.mime_type});
    blob.bytes = std::move(image.bytes);
    blob.mime_type = std::move(image.mime_type);
  }
  return out;
}

}  // namespace meshlode::builder
