// SPDX-License-Identifier: MIT
#include "run/unpack/unpack.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/hash.h"
#include "base/try.h"
#include "format/names.h"
#include "run/unpack/check_page.h"
#include "run/unpack/decompressors.h"
#include "run/unpack/unpack_page.h"

namespace meshlode::run {

namespace {

Error page_error(PageId page, const char* field, std::string detail, ErrorCode code = ErrorCode::kInvalid) {
  return {code, "page " + std::to_string(page.value) + ", field " + field, std::move(detail)};
}

/// The bytes between the page before it and this one carry nothing: no checksum covers them, so they are looked at.
bool is_padding_zero(const Asset& asset, PageId page) {
  if (page.value == 0) return true;
  const format::PageRecord& before = asset.pages()[page.value - 1];
  const std::uint64_t end = before.offset + before.stored_bytes;
  const auto padding = asset.bytes().subspan(end, asset.pages()[page.value].offset - end);
  return std::all_of(padding.begin(), padding.end(), [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace

Result<PageBytes> load_page(const Asset& asset, PageId page) {
  if (page.value >= asset.pages().size()) return page_error(page, "id", "is out of range", ErrorCode::kUsage);
  const format::PageRecord& record = asset.pages()[page.value];
  const std::span<const std::uint8_t> stored = asset.stored_page(page);
  if (hash64(stored) != record.checksum) return page_error(page, "checksum", "does not match the stored bytes");
  if (!is_padding_zero(asset, page)) return page_error(page, "offset", "the padding before it is not zero");

  if (record.codec == format::Codec::kNone) {
    if (record.decoded_checksum != record.checksum) {
      return page_error(page, "decoded_checksum", "does not match the decoded bytes");
    }
    const PageBytes view(stored);  // offsets are multiples of 16 in bytes that lie at multiples of 8
    TRY(check_page(asset, page, view.words()));
    return PageBytes(stored);
  }

  std::vector<std::uint8_t> decoded(record.bytes);  // at most 128 KiB, which Asset has checked
  const format::MeshRecord& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
  const std::span<std::uint32_t> words{reinterpret_cast<std::uint32_t*>(decoded.data()), decoded.size() / 4};
  const UnpackOutcome outcome = unpack_page(mesh, record, stored, words);
  if (outcome == UnpackOutcome::kNotBuiltIn) {
    return page_error(
        page, "codec",
        std::string("is ") + format::name_of(record.codec) +
            ", which is no longer written and which this build does not read: build the asset again, "
            "or repack it (`meshlode repack --codec strips`) with a build that has MESHLODE_OLD_CODECS=ON",
        ErrorCode::kUnsupported);
  }
  if (outcome == UnpackOutcome::kBroken) return page_error(page, "codec", "the stored bytes do not unpack");
  if (hash64(decoded) != record.decoded_checksum) {
    return page_error(page, "decoded_checksum", "does not match the decoded bytes");
  }
  PageBytes owned(std::move(decoded));
  TRY(check_page(asset, page, owned.words()));
  return owned;
}

}  // namespace meshlode::run
