// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/image_budget.h"

#include "base/byte_size.h"
#include "base/hash.h"

namespace meshlode::draw {

std::string ImageBudget::refusal(std::string_view image, const ImageHeader& header, std::uint64_t bytes) const {
  return std::string(image) + ": " + std::to_string(header.width) + " x " + std::to_string(header.height) +
         " texels take " + byte_size_text(bytes) + " decoded, " + byte_size_text(left()) + " of --max-decoded " +
         byte_size_text(limit_) + " are left";
}

std::string image_name(const run::Asset& asset, std::uint32_t blob) {
  const std::string_view name = asset.string(asset.blobs()[blob].name);
  return name.empty() ? "image " + std::to_string(blob) : "image '" + std::string(name) + "'";
}

Status check_image(const run::Asset& asset, std::uint32_t blob) {
  const format::BlobRecord& record = asset.blobs()[blob];
  if (hash64(asset.blob_bytes(record)) == record.checksum) return Ok{};
  return Error{ErrorCode::kInvalid, "blob " + std::to_string(blob) + ", field checksum",
               "does not match the stored bytes"};
}

}  // namespace meshlode::draw
