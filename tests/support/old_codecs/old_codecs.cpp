// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/old_codecs/old_codecs.h"

#include <cstring>
#include <optional>
#include <utility>

#include "base/try.h"
#include "builder/pack/page_model.h"
#include "builder/pack/side_bytes.h"
#include "builder/write/repack.h"
#include "format/names.h"
#include "format/page_streams.h"
#include "run/unpack/unpack.h"
#include "support/old_codecs/compressors.h"

namespace meshlode::test {

namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& out, const Bytes& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

Bytes start_stored(format::Codec codec, const Bytes& side, std::size_t side_bytes, std::size_t twin_count) {
  Bytes out;
  builder::put_u32(out, static_cast<std::uint32_t>(format::method_of(codec)));
  builder::put_u32(out, static_cast<std::uint32_t>(side.size()));
  builder::put_u32(out, static_cast<std::uint32_t>(side_bytes));
  builder::put_u32(out, static_cast<std::uint32_t>(twin_count));
  append(out, side);
  return out;
}

Result<Bytes> store_columns(const Bytes& columns, const builder::PageModel& model, format::Codec codec) {
  TRY_LET(side, codec == format::Codec::kLz4 ? compress_lz4(columns) : compress_zstd(columns));
  Bytes out = start_stored(codec, *side, columns.size(), 0);
  for (const std::uint32_t word : model.stream_words) builder::put_u32(out, word);
  return out;
}

Result<Bytes> store_draco(const format::MeshRecord& mesh, const Bytes& columns, const builder::PageModel& model) {
  TRY_LET(side, compress_draco({columns.begin(), columns.end()}));
  Bytes out = start_stored(format::Codec::kDraco, *side, columns.size(), model.streams[format::kTwinStream].size());
  Bytes streams;
  for (std::uint32_t s = 0; s < format::kFieldStreams + format::field_count(mesh); ++s) {
    TRY_LET(stream, compress_draco(model.streams[s]));
    builder::put_u32(out, static_cast<std::uint32_t>(stream->size()));
    append(streams, *stream);
  }
  append(out, streams);
  return out;
}

}  // namespace

Result<Bytes> store_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page, format::Codec codec) {
  if (format::is_written(codec)) return builder::store_page(mesh, page, codec);
  std::vector<std::uint32_t> words(page.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), page.data(), words.size() * sizeof(std::uint32_t));
  const std::optional<builder::PageModel> model =
      page.size() % 4 == 0 ? builder::model_page(mesh, words) : std::nullopt;
  if (!model) return Error{ErrorCode::kBuildFailed, "pack", "the page is not in the form that the format prescribes"};
  Bytes columns;
  for (const Bytes& column : builder::make_columns(mesh, *model)) append(columns, column);
  if (codec == format::Codec::kDraco) return store_draco(mesh, columns, *model);
  return store_columns(columns, *model, codec);
}

Result<builder::PackedPage> pack_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page,
                                      format::Codec codec) {
  if (format::is_written(codec)) return builder::pack_page(mesh, page, codec);
  TRY_LET(stored, store_page(mesh, page, codec));
  if (stored->size() >= page.size()) return builder::PackedPage{};
  return builder::PackedPage{codec, std::move(*stored)};
}

Result<Bytes> stored_by(const run::Asset& asset, format::Codec codec, std::string meta_json) {
  builder::RepackInput input;
  for (const format::SectionEntry& entry : asset.sections()) {
    input.sections.push_back({entry, asset.section_bytes(entry)});
  }
  input.version = asset.header().version;
  std::memcpy(input.content_hash.data(), asset.header().content_hash, input.content_hash.size());
  input.meta_json = std::move(meta_json);
  input.load_page = [&](std::size_t p) -> Result<Bytes> {
    TRY_LET(page, run::load_page(asset, PageId{p}));
    return Bytes(page->bytes().begin(), page->bytes().end());
  };
  input.codec = codec;
  input.pack = pack_page;
  return builder::repack_asset(input);
}

}  // namespace meshlode::test
