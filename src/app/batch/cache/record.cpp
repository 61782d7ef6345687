// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/cache/record.h"

#include <array>

#include "base/byte_stream.h"

namespace meshlode::app {

namespace {

constexpr std::size_t kNumberCount = 14;

std::array<std::uint64_t, kNumberCount> numbers_of(const JobFacts& f) {
  const scene::MeshRepairs& r = f.repairs;
  return {f.triangles, f.meshes,   f.instances, f.bytes, f.dropped,        r.degenerate, r.duplicate,
          r.turned,    r.stitched, r.cut_edges, r.split, f.file_triangles, f.missing,    f.draws_nothing ? 1U : 0U};
}

void set_numbers(JobFacts& f, const std::array<std::uint64_t, kNumberCount>& n) {
  f.triangles = n[0], f.meshes = n[1], f.instances = n[2], f.bytes = n[3], f.dropped = n[4];
  f.repairs = {n[5], n[6], n[7], n[8], n[9], n[10]};
  f.file_triangles = n[11], f.missing = n[12], f.draws_nothing = n[13] != 0;
}

void write_items(ByteWriter& out, const std::vector<scene::LeftOut>& items) {
  out.value(std::uint64_t{items.size()});
  for (const scene::LeftOut& item : items) {
    out.text(item.what);
    out.text(item.why);
  }
}

bool read_items(ByteReader& in, std::vector<scene::LeftOut>& items) {
  std::uint64_t count = 0;
  if (!in.count(count, 2 * sizeof(std::uint64_t))) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    scene::LeftOut& item = items.emplace_back();
    if (!in.text(item.what) || !in.text(item.why)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> record_bytes(const AssetRecord& record) {
  ByteWriter out;
  out.text(record.ingredients);
  out.value(record.asset);
  out.value(numbers_of(record.facts));
  for (const auto* items : {&record.facts.left_out, &record.facts.planned_out, &record.facts.losses}) {
    write_items(out, *items);
  }
  return out.take();
}

std::optional<AssetRecord> read_record(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  AssetRecord record;
  std::array<std::uint64_t, kNumberCount> numbers{};
  if (!in.text(record.ingredients) || !in.value(record.asset) || !in.value(numbers)) return std::nullopt;
  if (numbers.back() > 1) return std::nullopt;  // draws_nothing: one record has one spelling
  set_numbers(record.facts, numbers);
  for (auto* items : {&record.facts.left_out, &record.facts.planned_out, &record.facts.losses}) {
    if (!read_items(in, *items)) return std::nullopt;
  }
  if (!in.is_at_end()) return std::nullopt;
  return record;
}

}  // namespace meshlode::app
