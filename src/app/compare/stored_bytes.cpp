// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/stored_bytes.h"

#include <cstddef>
#include <string>

#include "base/hash.h"
#include "base/ids.h"

namespace meshlode::app {

namespace {

Error mismatch(const char* what, std::size_t index) {
  return {ErrorCode::kInvalid, std::string(what) + " " + std::to_string(index) + ", field checksum",
          "does not match the stored bytes"};
}

}  // namespace

Status check_stored_bytes(const run::Asset& asset) {
  for (std::size_t i = 0; i < asset.pages().size(); ++i) {
    if (hash64(asset.stored_page(PageId(i))) != asset.pages()[i].checksum) return mismatch("page", i);
  }
  for (std::size_t i = 0; i < asset.blobs().size(); ++i) {
    if (hash64(asset.blob_bytes(asset.blobs()[i])) != asset.blobs()[i].checksum) return mismatch("blob", i);
  }
  return Ok{};
}

}  // namespace meshlode::app
