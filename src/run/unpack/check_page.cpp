// SPDX-License-Identifier: MIT
#include "run/unpack/check_page.h"

#include <bit>
#include <cstring>
#include <string>

#include <meshlode/page.h>

namespace meshlode::run {

namespace {

static_assert(std::endian::native == std::endian::little, "pages are read as they lie in memory");

class PageChecker {
 public:
  PageChecker(const Asset& asset, PageId page, std::span<const std::uint32_t> words)
      : asset_(asset),
        record_(asset.pages()[page.value]),
        mesh_(asset.meshes()[asset.groups()[record_.first_group].mesh]),
        page_(page),
        words_(words) {}

  Status run() {
    // check_pages made sure that the page holds its header, the heads and a word more.
    if (words_[0] != record_.first_cluster) return fail("first_cluster", "does not match the page table");
    if (words_[1] != record_.cluster_count) return fail("cluster_count", "does not match the page table");
    std::uint32_t at = 2 + record_.cluster_count * format::head_words(mesh_);
    for (cluster_ = 0; cluster_ < record_.cluster_count; ++cluster_) {
      if (Status status = check_cluster(at); !status) return status;
    }
    if (at + 1 != words_.size()) return fail("data_word", "words are left over behind the last cluster");
    if (words_.back() != 0) return fail("data_word", "the page's last word is not zero");
    return Ok{};
  }

 private:
  [[nodiscard]] Error fail(const char* field, const char* detail) const {
    std::string where = "page " + std::to_string(page_.value);
    if (cluster_ < record_.cluster_count) where += ", cluster " + std::to_string(record_.first_cluster + cluster_);
    return {ErrorCode::kInvalid, where + ", field " + field, detail};
  }

  /// Checks the cluster whose data must start at word `at`, and moves `at` behind it.
  Status check_cluster(std::uint32_t& at) {
    const std::uint32_t head = 2 + cluster_ * format::head_words(mesh_);  // check_pages made sure of the heads
    if (static_cast<std::uint32_t>(format::get_field(&words_[head], format::head::kDataWord)) != at) {
      return fail("data_word", "does not follow the data before it");
    }
    format::ClusterLayout layout;
    if (const char* field = format::read_cluster_layout(mesh_, words_, cluster_, layout)) {
      return fail(field, "is out of range, or the cluster reaches beyond the page");
    }
    const format::ClusterRecord& cluster = asset_.clusters()[record_.first_cluster + cluster_];
    if (layout.vertex_count != cluster.vertex_count()) return fail("vertices_less_1", "does not match the record");
    if (layout.triangle_count != cluster.triangle_count()) return fail("triangles_less_1", "does not match the record");
    if (Status status = check_unused_bits(layout); !status) return status;
    if (Status status = check_materials(layout); !status) return status;
    if (Status status = check_topology(layout); !status) return status;
    at = layout.end_word;
    return Ok{};
  }

  Status check_unused_bits(const format::ClusterLayout& layout) {
    const std::uint32_t* const head = &words_[layout.head_word];
    if (head[2] >> 31 != 0 || head[3] >> 29 != 0) return fail("head", "an unnamed bit is not zero");
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      std::uint32_t at = layout.uv_word[set];
      for (std::uint32_t r = 0; r < layout.uv_range_count[set]; ++r) {
        const std::uint32_t* const range = &words_[at];
        const bool has_fit = format::get_field(range, format::uv_range::kHasFit) != 0;
        if (range[0] >> 29 != 0 || (has_fit && (range[3] >> 30 != 0 || range[4] >> 30 != 0))) {
          return fail("uv_range", "an unnamed bit is not zero");
        }
        at += format::uv_range::kWords + (has_fit ? format::uv_range::kFitWords : 0U);
      }
    }
    if (mesh_.has_color != 0 && words_[layout.color_word + 1] >> 16 != 0) {
      return fail("color_range", "an unnamed bit is not zero");
    }
    if (layout.end_bit % 32 != 0 && words_[layout.end_bit / 32] >> layout.end_bit % 32 != 0) {
      return fail("data_word", "a bit behind the stream is not zero");
    }
    return Ok{};
  }

  Status check_materials(const format::ClusterLayout& layout) {
    std::int64_t previous = -1;
    for (std::uint32_t r = 0; r < layout.material_count; ++r) {
      const std::int32_t material = format::get_field(
          &words_[layout.material_word + r * format::material_range::kWords], format::material_range::kMaterial);
      if (static_cast<std::uint32_t>(material) >= asset_.materials().size()) return fail("material", "is out of range");
      if (material <= previous) return fail("material", "must be larger than the one before it");
      previous = material;
    }
    return Ok{};
  }

  /// Strips start in order, every vertex is named first by a fresh slot, and every reference names one before it.
  Status check_topology(const format::ClusterLayout& layout) {
    const auto bits = [&](std::uint32_t at, std::uint32_t count) { return format::get_bits(words_.data(), at, count); };
    std::uint32_t first = 0;
    if (bits(layout.turn_bit, 1) != 0) return fail("turn", "the first triangle of a strip turns left");
    for (std::uint32_t k = 1; k < layout.strip_count; ++k) {
      const std::uint32_t next = bits(layout.restart_bit + (k - 1) * layout.restart_bits, layout.restart_bits);
      if (next <= first || next >= layout.triangle_count) return fail("restart", "strips must start in order");
      first = next;
      if (bits(layout.turn_bit + first, 1) != 0) return fail("turn", "the first triangle of a strip turns left");
    }
    std::uint32_t fresh = 0;
    std::uint32_t reference = 0;
    for (std::uint32_t slot = 0; slot < layout.slot_count; ++slot) {
      if (bits(layout.fresh_bit + slot, 1) != 0) {
        if (++fresh > layout.vertex_count) return fail("fresh", "there are more fresh slots than vertices");
        continue;
      }
      // There are slot_count - vertex_count references in the stream, and no more are read.
      if (reference >= layout.reference_count) return fail("fresh", "there are fewer fresh slots than vertices");
      const std::uint32_t distance =
          bits(layout.reference_bit + reference * layout.reference_bits, layout.reference_bits);
      if (distance >= fresh) return fail("reference", "names a vertex before the first");
      ++reference;
    }
    return Ok{};
  }

  const Asset& asset_;
  const format::PageRecord& record_;
  const format::MeshRecord& mesh_;
  PageId page_;
  std::span<const std::uint32_t> words_;
  std::uint32_t cluster_ = format::kNone;  ///< in the page; kNone while the page's own header is checked
};

}  // namespace

Status check_page(const Asset& asset, PageId page, std::span<const std::uint32_t> words) {
  return PageChecker(asset, page, words).run();
}

}  // namespace meshlode::run
