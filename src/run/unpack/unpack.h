// SPDX-License-Identifier: MIT
// Unpack: the disk bytes of a page become its GPU-ready bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "run/read/asset.h"

namespace meshlode::run {

/// A page in its decoded form: a view of the file where it is stored uncompressed, else bytes of its own. They are
/// whole u32 words, aligned as such.
class PageBytes {
 public:
  explicit PageBytes(std::span<const std::uint8_t> view) : view_(view) {}
  explicit PageBytes(std::vector<std::uint8_t> owned) : owned_(std::move(owned)), view_(owned_) {}
  PageBytes(PageBytes&&) = default;  // moving a vector keeps its buffer, so the view stays valid
  PageBytes& operator=(PageBytes&&) = default;
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return view_; }
  [[nodiscard]] std::span<const std::uint32_t> words() const {
    return {reinterpret_cast<const std::uint32_t*>(view_.data()), view_.size() / 4};
  }

 private:
  std::vector<std::uint8_t> owned_;
  std::span<const std::uint8_t> view_;
};

/// Checks both checksums, then every offset and count inside the page against the cluster records, so that decode may
/// trust it. Errors: kInvalid with the place; kUnsupported for a codec that was not built in.
[[nodiscard]] Result<PageBytes> load_page(const Asset& asset, PageId page);

/// The same from bytes that the caller read, at any address, into memory of the caller; of a head too. What lies
/// between the pages is not looked at. Errors: as above; kUsage where `stored` is not as long as the page is stored, or
/// `out` shorter than the page. After an error the content of `out` is undefined.
[[nodiscard]] Status unpack_stored_page(const Asset& asset, PageId page, std::span<const std::uint8_t> stored,
                                        std::span<std::uint32_t> out);

/// The bytes of an image or buffer against the checksum of its record, which opening does not look at.
[[nodiscard]] Status check_blob(const Asset& asset, std::uint32_t blob, std::span<const std::uint8_t> bytes);

}  // namespace meshlode::run
