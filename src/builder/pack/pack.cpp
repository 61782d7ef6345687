// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/pack/pack.h"

#include <cstring>
#include <optional>

#include "base/try.h"
#include "builder/pack/pack_section.h"
#include "builder/pack/page_model.h"
#include "builder/pack/prefix_streams.h"
#include "builder/pack/side_bytes.h"

namespace meshlode::builder {

namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& out, const Bytes& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

Bytes store_strips(const Bytes& side, std::size_t side_bytes, const PageModel& model,
                   const std::vector<Bytes>& streams) {
  Bytes out;
  put_u32(out, static_cast<std::uint32_t>(format::PageMethod::kStrips));
  put_u32(out, static_cast<std::uint32_t>(side.size()));
  put_u32(out, static_cast<std::uint32_t>(side_bytes));
  put_u32(out, static_cast<std::uint32_t>(model.streams[format::kTwinStream].size()));
  append(out, side);
  for (const Bytes& stream : streams) put_u32(out, static_cast<std::uint32_t>(stream.size()));
  for (const Bytes& stream : streams) append(out, stream);
  return out;
}

Bytes store_prefix_codes(const format::MeshRecord& mesh, const PageModel& model) {
  const PrefixStreams coded = write_prefix_streams(mesh, model);
  Bytes side;
  put_column(coded.code_lengths, side);
  std::size_t side_bytes = coded.code_lengths.size();
  for (const Bytes& column : make_columns(mesh, model)) {
    if (column.empty()) continue;
    put_column(column, side);
    side_bytes += column.size();
  }
  return store_strips(side, side_bytes, model, coded.streams);
}

}  // namespace

Result<std::vector<std::uint8_t>> store_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page,
                                             format::Codec codec) {
  std::vector<std::uint32_t> words(page.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), page.data(), words.size() * sizeof(std::uint32_t));
  const std::optional<PageModel> model = page.size() % 4 == 0 ? model_page(mesh, words) : std::nullopt;
  if (!model) return Error{ErrorCode::kBuildFailed, "pack", "the page is not in the form that the format prescribes"};
  if (codec == format::Codec::kStrips) return store_prefix_codes(mesh, *model);
  return Error{ErrorCode::kBuildFailed, "pack", "pages of this codec are not stored"};
}

Result<PackedPage> pack_page(const format::MeshRecord& mesh, std::span<const std::uint8_t> page, format::Codec codec) {
  PackedPage out;
  if (codec == format::Codec::kNone) return out;
  TRY_LET(stored, store_page(mesh, page, codec));
  if (stored->size() < page.size()) {
    out.codec = codec;
    out.bytes = std::move(*stored);
  }
  return out;
}

}  // namespace meshlode::builder
