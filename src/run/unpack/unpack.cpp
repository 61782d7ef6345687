// SPDX-License-Identifier: MIT
#include "run/unpack/unpack.h"

#include <algorithm>
#include <cstring>
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

/// The stored bytes against their checksum; of uncompressed ones the decoded checksum is the same.
Status check_stored(PageId page, const format::PageRecord& record, std::span<const std::uint8_t> stored) {
  if (hash64(stored) != record.checksum) return page_error(page, "checksum", "does not match the stored bytes");
  if (record.codec == format::Codec::kNone && record.decoded_checksum != record.checksum) {
    return page_error(page, "decoded_checksum", "does not match the decoded bytes");
  }
  return Ok{};
}

/// \pre check_stored(); the page is compressed, and `words` are those of the decoded page, all zero
Status unpack_words(const Asset& asset, PageId page, std::span<const std::uint8_t> stored,
                    std::span<std::uint32_t> words) {
  const format::PageRecord& record = asset.pages()[page.value];
  const format::MeshRecord& mesh = asset.meshes()[asset.groups()[record.first_group].mesh];
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
  if (hash64({reinterpret_cast<const std::uint8_t*>(words.data()), words.size_bytes()}) != record.decoded_checksum) {
    return page_error(page, "decoded_checksum", "does not match the decoded bytes");
  }
  return Ok{};
}

}  // namespace

Result<PageBytes> load_page(const Asset& asset, PageId page) {
  if (page.value >= asset.pages().size()) return page_error(page, "id", "is out of range", ErrorCode::kUsage);
  if (!asset.has_body()) {
    return Error{ErrorCode::kUsage, "page " + std::to_string(page.value),
                 "is not there: the asset was opened from its head, and unpack_page takes the bytes of its pages"};
  }
  const format::PageRecord& record = asset.pages()[page.value];
  const std::span<const std::uint8_t> stored = asset.stored_page(page);
  TRY(check_stored(page, record, stored));
  if (!is_padding_zero(asset, page)) return page_error(page, "offset", "the padding before it is not zero");

  if (record.codec == format::Codec::kNone) {
    PageBytes view(stored);  // offsets are multiples of 16 in bytes that lie at multiples of 8
    TRY(check_page(asset, page, view.words()));
    return view;
  }
  std::vector<std::uint8_t> decoded(record.bytes);  // at most 128 KiB, which Asset has checked
  TRY(unpack_words(asset, page, stored, {reinterpret_cast<std::uint32_t*>(decoded.data()), decoded.size() / 4}));
  PageBytes owned(std::move(decoded));
  TRY(check_page(asset, page, owned.words()));
  return owned;
}

Status unpack_stored_page(const Asset& asset, PageId page, std::span<const std::uint8_t> stored,
                          std::span<std::uint32_t> out) {
  if (page.value >= asset.pages().size()) return page_error(page, "id", "is out of range", ErrorCode::kUsage);
  const format::PageRecord& record = asset.pages()[page.value];
  if (stored.size() != record.stored_bytes) {
    return page_error(
        page, "stored_bytes",
        "is " + std::to_string(record.stored_bytes) + ", " + std::to_string(stored.size()) + " were given",
        ErrorCode::kUsage);
  }
  if (out.size() < record.bytes / 4) {
    return page_error(page, "bytes",
                      "is " + std::to_string(record.bytes) + ", there is room for " + std::to_string(out.size_bytes()),
                      ErrorCode::kUsage);
  }
  TRY(check_stored(page, record, stored));
  const std::span<std::uint32_t> words = out.first(record.bytes / 4);
  if (record.codec == format::Codec::kNone) {
    std::memcpy(words.data(), stored.data(), stored.size());
  } else {
    std::fill(words.begin(), words.end(), 0U);
    TRY(unpack_words(asset, page, stored, words));
  }
  return check_page(asset, page, words);
}

Status check_blob(const Asset& asset, std::uint32_t blob, std::span<const std::uint8_t> bytes) {
  const std::string where = "blob " + std::to_string(blob);
  if (blob >= asset.blobs().size()) return Error{ErrorCode::kUsage, where, "does not exist"};
  const format::BlobRecord& record = asset.blobs()[blob];
  if (bytes.size() != record.bytes) {
    return Error{ErrorCode::kUsage, where + ", field bytes",
                 "is " + std::to_string(record.bytes) + ", " + std::to_string(bytes.size()) + " were given"};
  }
  if (hash64(bytes) != record.checksum) return Error{ErrorCode::kInvalid, where + ", field checksum", "does not match"};
  return Ok{};
}

}  // namespace meshlode::run
