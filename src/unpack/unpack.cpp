// SPDX-License-Identifier: MIT
#include "unpack/unpack.h"

#include <string>
#include <utility>

#include "base/hash.h"
#include "unpack/check_page.h"
#include "unpack/codecs.h"

namespace meshlode {

namespace {

Error page_error(PageId page, const char* field, std::string detail, ErrorCode code = ErrorCode::kInvalid) {
  return {code, "page " + std::to_string(page.value) + ", field " + field, std::move(detail)};
}

}  // namespace

Result<PageBytes> load_page(const Asset& asset, PageId page) {
  if (page.value >= asset.pages().size()) return page_error(page, "id", "is out of range", ErrorCode::kUsage);
  const format::PageRecord& record = asset.pages()[page.value];
  const std::span<const std::uint8_t> stored = asset.stored_page(page);
  if (hash64(stored) != record.checksum) return page_error(page, "checksum", "does not match the stored bytes");

  if (record.codec == format::Codec::kNone) {
    if (record.decoded_checksum != record.checksum) {
      return page_error(page, "decoded_checksum", "does not match the decoded bytes");
    }
    if (Status status = check_page(asset, page, stored); !status) return status.error();
    return PageBytes(stored);
  }

  std::vector<std::uint8_t> decoded(record.bytes);  // at most 128 KiB, which Asset has checked
  UnpackOutcome outcome = UnpackOutcome::kNotBuiltIn;
  if (record.codec == format::Codec::kLz4) outcome = unpack_lz4(stored, decoded);
  if (record.codec == format::Codec::kZstd) outcome = unpack_zstd(stored, decoded);
  if (outcome == UnpackOutcome::kNotBuiltIn) {
    return page_error(page, "codec", "this reader was built without the page's codec", ErrorCode::kUnsupported);
  }
  if (outcome == UnpackOutcome::kBroken) return page_error(page, "codec", "the stored bytes do not unpack");
  if (hash64(decoded) != record.decoded_checksum) {
    return page_error(page, "decoded_checksum", "does not match the decoded bytes");
  }
  if (Status status = check_page(asset, page, decoded); !status) return status.error();
  return PageBytes(std::move(decoded));
}

}  // namespace meshlode
