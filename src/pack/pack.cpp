// SPDX-License-Identifier: GPL-3.0-or-later
#include "pack/pack.h"

#include <cstring>
#include <optional>

#include "pack/codecs.h"
#include "pack/page_model.h"
#include "pack/prefix_streams.h"
#include "pack/side_bytes.h"

namespace meshlode {

namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& out, const Bytes& bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

Bytes start_stored(PageMethod method, const Bytes& side, std::size_t side_bytes, std::size_t twin_count) {
  Bytes out;
  put_u32(out, static_cast<std::uint32_t>(method));
  put_u32(out, static_cast<std::uint32_t>(side.size()));
  put_u32(out, static_cast<std::uint32_t>(side_bytes));
  put_u32(out, static_cast<std::uint32_t>(twin_count));
  append(out, side);
  return out;
}

Bytes store_strips(const Bytes& side, std::size_t side_bytes, const PageModel& model, const std::vector<Bytes>& streams) {
  Bytes out = start_stored(PageMethod::kStrips, side, side_bytes, model.streams[kTwinStream].size());
  for (const Bytes& stream : streams) put_u32(out, static_cast<std::uint32_t>(stream.size()));
  for (const Bytes& stream : streams) append(out, stream);
  return out;
}

/// Speed is what this codec is for: only what shrinks without a model of the geometry is touched.
Result<Bytes> store_lz4(const format::MeshRecord& mesh, const PageModel& model) {
  Bytes columns;
  put_columns(mesh, model, columns);
  const auto side = pack_lz4(columns);
  if (!side) return side.error();
  Bytes out = start_stored(PageMethod::kColumns, *side, columns.size(), 0);
  for (const std::uint32_t word : model.stream_words) put_u32(out, word);
  return out;
}

Result<Bytes> store_zstd(const format::MeshRecord& mesh, const PageModel& model) {
  PrefixStreams coded = write_prefix_streams(mesh, model);
  put_columns(mesh, model, coded.code_lengths);
  const auto side = pack_zstd(coded.code_lengths);
  if (!side) return side.error();
  return store_strips(*side, coded.code_lengths.size(), model, coded.streams);
}

Result<Bytes> store_draco(const format::MeshRecord& mesh, const PageModel& model) {
  Bytes columns;
  put_columns(mesh, model, columns);
  const auto side = pack_draco({columns.begin(), columns.end()});
  if (!side) return side.error();
  std::vector<Bytes> streams;
  for (std::uint32_t s = 0; s < kFieldStreams + field_count(mesh); ++s) {
    auto stream = pack_draco(model.streams[s]);
    if (!stream) return stream.error();
    streams.push_back(std::move(*stream));
  }
  return store_strips(*side, columns.size(), model, streams);
}

}  // namespace

Result<std::vector<std::uint8_t>> store_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page,
                                             format::Codec codec) {
  std::vector<std::uint32_t> words(page.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), page.data(), words.size() * sizeof(std::uint32_t));
  const std::optional<PageModel> model = page.size() % 4 == 0 ? model_page(mesh, words) : std::nullopt;
  if (!model) return Error{ErrorCode::kBuildFailed, "pack", "the page is not in the form that the format prescribes"};
  return codec == format::Codec::kLz4    ? store_lz4(mesh, *model)
         : codec == format::Codec::kZstd ? store_zstd(mesh, *model)
                                         : store_draco(mesh, *model);
}

Result<PackedPage> pack_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page, format::Codec codec) {
  PackedPage out;
  if (codec == format::Codec::kNone) return out;
  auto stored = store_page(mesh, page, codec);
  if (!stored) return stored.error();
  if (stored->size() < page.size()) {
    out.codec = codec;
    out.bytes = std::move(*stored);
  }
  return out;
}

}  // namespace meshlode
