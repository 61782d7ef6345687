// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of pages (L203 … L212, L214 … L216), parsed by the judge's own lines and not by `decode`.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "format/grid.h"
#include "judge/validate/page_rules.h"

namespace meshlode::judge {

namespace {

/// A page as words, read by the letter of docs/reference/format.md: nothing of <meshlode/page.h> or of decode.
class Words {
 public:
  explicit Words(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::uint64_t size() const { return bytes_.size() / 4; }
  /// \pre index < size()
  [[nodiscard]] std::uint32_t operator[](std::uint64_t index) const {
    std::uint32_t word;
    std::memcpy(&word, bytes_.data() + 4 * index, sizeof word);
    return word;
  }
  /// `count` bits of word `index` from bit `shift`.
  [[nodiscard]] std::uint32_t field(std::uint64_t index, std::uint32_t shift, std::uint32_t count) const {
    return static_cast<std::uint32_t>((*this)[index] >> shift & ((std::uint64_t{1} << count) - 1));
  }
  [[nodiscard]] std::int64_t signed_field(std::uint64_t index, std::uint32_t shift, std::uint32_t count) const {
    const std::int64_t value = field(index, shift, count);
    return value >= std::int64_t{1} << (count - 1) ? value - (std::int64_t{1} << count) : value;
  }
  /// \pre bit + count <= 32 * size()
  [[nodiscard]] std::uint32_t stream(std::uint64_t bit, std::uint32_t count) const {
    if (count == 0) return 0;
    std::uint64_t window = (*this)[bit / 32];
    if (bit % 32 + count > 32) window |= std::uint64_t{(*this)[bit / 32 + 1]} << 32;
    return static_cast<std::uint32_t>(window >> bit % 32 & ((std::uint64_t{1} << count) - 1));
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// The low 32 bits as a signed integer: what arithmetic modulo 2^32 leaves.
std::int64_t wrap(std::int64_t value) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

struct Spread {
  std::uint32_t lowest = 0xFFFFFFFFU, highest = 0;
  void add(std::uint32_t value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
};

struct UvRangeWords {
  std::uint32_t vertices, bits[2], shift[2];
  std::int64_t minimum[2];
  std::int64_t slope[2][3];
};

class ClusterBytesChecker {
 public:
  ClusterBytesChecker(const FileTables& file, std::size_t page, std::span<const std::uint8_t> bytes, RuleLog& log)
      : file_(file),
        page_(page),
        words_(bytes),
        log_(log),
        mesh_(file.meshes[file.groups[file.pages[page].first_group].mesh]),
        has_normal_(mesh_.normal_mode == format::NormalMode::kStored) {}

  [[nodiscard]] std::uint64_t head_words() const { return has_normal_ ? 6 : 5; }

  /// Checks the cluster whose data should start at word `data`; the word behind them, or nothing where it is broken.
  std::optional<std::uint64_t> run(std::size_t cluster, std::uint64_t index, std::uint64_t data) {
    cluster_ = cluster;
    head_ = 2 + index * head_words();
    sound_ = true;
    if (!parse_head(data) || !parse_ranges() || !parse_stream()) return std::nullopt;
    check_positions();
    if (has_normal_) check_normals();
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) check_uvs(set);
    if (mesh_.has_color != 0) check_colors();
    check_strips();
    return sound_ ? std::optional(end_) : std::nullopt;
  }

 private:
  [[nodiscard]] std::string at() const { return place("page", page_, "cluster", cluster_); }

  template <class Detail>
  bool expect(bool holds, Rule rule, const Detail& detail) {
    log_.expect(
        holds, rule, [&] { return at(); }, [&] { return std::string(detail()); });
    return holds;
  }
  /// For rules without which nothing more of the cluster can be trusted.
  template <class Detail>
  bool require(bool holds, Rule rule, const Detail& detail) {
    if (!expect(holds, rule, detail)) sound_ = false;
    return holds;
  }

  bool parse_head(std::uint64_t data) {
    const format::ClusterRecord& record = file_.clusters[cluster_];
    vertices_ = words_.field(head_, 0, 8) + 1;
    triangles_ = words_.field(head_, 8, 8) + 1;
    if (!require(vertices_ == record.vertex_count() && triangles_ == record.triangle_count(), Rule::kL206, [&] {
          return differs("vertices", std::uint64_t{vertices_}, "record", std::uint64_t{record.vertex_count()}) + "; " +
                 differs("triangles", std::uint64_t{triangles_}, "record", std::uint64_t{record.triangle_count()});
        })) {
      return false;
    }
    const std::uint64_t start = words_.field(head_, 16, 16);
    if (!require(start == data, Rule::kL205, [&] { return differs("data word", start, "should be", data); }))
      return false;
    cursor_ = start;
    bool known = true;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      minimum_[axis] = words_.signed_field(head_ + 1 + axis, 0, 24);
      bits_[axis] = words_.field(head_ + 1 + axis, 24, 5);
      known &= bits_[axis] <= 24;
    }
    chart_ = words_.field(head_ + 1, 29, 3);
    shear_axis_ = words_.field(head_ + 2, 29, 2);
    expect(words_.field(head_ + 2, 31, 1) == 0 && words_.field(head_ + 3, 29, 3) == 0, Rule::kL214,
           [] { return "an unnamed bit of the head is not zero"; });
    shear_[0] = words_.signed_field(head_ + 4, 0, 8);
    shear_[1] = words_.signed_field(head_ + 4, 8, 8);
    strips_ = words_.field(head_ + 4, 16, 8) + 1;
    reference_bits_ = words_.field(head_ + 4, 24, 4);
    normal_bits_[0] = words_.field(head_ + 4, 28, 4);
    normal_bits_[1] = 0;
    if (has_normal_) {
      normal_minimum_[0] = words_.field(head_ + 5, 0, 14);
      normal_minimum_[1] = words_.field(head_ + 5, 14, 14);
      normal_bits_[1] = words_.field(head_ + 5, 28, 4);
    }
    known &= chart_ < (has_normal_ ? 6U : 1U) && shear_axis_ < 3 && reference_bits_ >= 1 && reference_bits_ <= 8 &&
             normal_bits_[0] <= (has_normal_ ? 14U : 0U) && normal_bits_[1] <= 14;
    return require(known, Rule::kL208, [] { return "a bit count, the chart or the shear axis is unknown"; });
  }

  /// Takes `count` words at the cursor, where the page has them before its last one.
  bool take(std::uint64_t count) {
    const bool fits = cursor_ <= words_.size() - 1 && count <= words_.size() - 1 - cursor_;
    if (!require(fits, Rule::kL208, [] { return "reaches beyond the page"; })) return false;
    cursor_ += count;
    return true;
  }

  bool parse_ranges() {
    if (mesh_.material == format::kNone && !parse_materials()) return false;
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      if (!parse_uv_ranges(set)) return false;
    }
    if (mesh_.has_color == 0) return true;
    const std::uint64_t word = cursor_;
    if (!take(2)) return false;
    bool known = true;
    for (std::uint32_t k = 0; k < 4; ++k) {
      color_minimum_[k] = words_.field(word, 8 * k, 8);
      color_bits_[k] = words_.field(word + 1, 4 * k, 4);
      known &= color_bits_[k] <= 8;
    }
    expect(words_.field(word + 1, 16, 16) == 0, Rule::kL214,
           [] { return "an unnamed bit of the colour range is not zero"; });
    return require(known, Rule::kL208, [] { return "a colour has more than 8 bits"; });
  }

  bool parse_materials() {
    std::uint64_t covered = 0;
    std::int64_t before = -1;
    while (covered < triangles_) {
      const std::uint64_t word = cursor_;
      if (!take(1)) return false;
      const std::int64_t material = words_.field(word, 8, 24);
      covered += words_.field(word, 0, 8) + 1;
      require(std::cmp_less(material, file_.materials.size()), Rule::kL211,
              [&] { return "material " + std::to_string(material) + " does not exist"; });
      expect(material > before, Rule::kL211, [] { return "materials are not ascending"; });
      before = material;
    }
    return require(covered == triangles_, Rule::kL211,
                   [&] { return differs("triangles in ranges", covered, "triangles", std::uint64_t{triangles_}); });
  }

  bool parse_uv_ranges(std::uint32_t set) {
    ranges_[set].clear();
    std::uint64_t covered = 0;
    while (covered < vertices_) {
      const std::uint64_t word = cursor_;
      if (!take(3)) return false;
      UvRangeWords range{};
      range.vertices = words_.field(word, 0, 8) + 1;
      const bool has_fit = words_.field(word, 28, 1) != 0;
      if (has_fit && !take(2)) return false;
      for (std::uint32_t c = 0; c < 2; ++c) {
        range.bits[c] = words_.field(word, 8 + 5 * c, 5);
        range.shift[c] = words_.field(word, 18 + 5 * c, 5);
        range.minimum[c] = words_.signed_field(word + 1 + c, 0, 32);
        for (std::uint32_t k = 0; k < 3 && has_fit; ++k) {
          range.slope[c][k] = words_.signed_field(word + 3 + c, 10 * k, 10);
        }
      }
      expect(words_.field(word, 29, 3) == 0 &&
                 (!has_fit || (words_.field(word + 3, 30, 2) == 0 && words_.field(word + 4, 30, 2) == 0)),
             Rule::kL214, [] { return "an unnamed bit of a UV range is not zero"; });
      covered += range.vertices;
      ranges_[set].push_back(range);
      if (!require(range.bits[0] <= 25 && range.bits[1] <= 25, Rule::kL208,
                   [] { return "a UV range has more than 25 bits"; })) {
        return false;
      }
    }
    return require(covered == vertices_, Rule::kL208,
                   [&] { return differs("vertices in UV ranges", covered, "vertices", std::uint64_t{vertices_}); });
  }

  bool parse_stream() {
    slots_ = triangles_ + 2 * strips_;
    if (!require(strips_ <= triangles_ && slots_ >= vertices_, Rule::kL216,
                 [] { return "has more strips than triangles, or fewer slots than vertices"; })) {
      return false;
    }
    const std::uint64_t first = cursor_;
    std::uint64_t bit = 32 * first;
    const auto part = [&](std::uint64_t count) { return std::exchange(bit, bit + count); };
    position_bit_ = part(std::uint64_t{vertices_} * (bits_[0] + bits_[1] + bits_[2]));
    normal_bit_ = part(std::uint64_t{vertices_} * (normal_bits_[0] + normal_bits_[1]));
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      uv_bit_[set] = bit;
      for (const UvRangeWords& range : ranges_[set])
        part(std::uint64_t{range.vertices} * (range.bits[0] + range.bits[1]));
    }
    const std::uint32_t color_bits = color_bits_[0] + color_bits_[1] + color_bits_[2] + color_bits_[3];
    color_bit_ = part(mesh_.has_color == 0 ? 0 : std::uint64_t{vertices_} * color_bits);
    turn_bit_ = part(triangles_);
    fresh_bit_ = part(slots_);
    restart_bits_ = static_cast<std::uint32_t>(std::bit_width(triangles_ - 1));
    restart_bit_ = part(std::uint64_t{strips_ - 1} * restart_bits_);
    reference_bit_ = part(std::uint64_t{slots_ - vertices_} * reference_bits_);
    if (!take((bit + 31) / 32 - first)) return false;
    end_ = cursor_;
    expect(bit % 32 == 0 || words_[bit / 32] >> (bit % 32) == 0, Rule::kL214,
           [] { return "bits behind the stream are not zero"; });
    return true;
  }

  void expect_spread(const Spread& spread, std::uint32_t bits, std::uint32_t fewest, const char* what) {
    expect(spread.lowest == 0 && std::max(fewest, static_cast<std::uint32_t>(std::bit_width(spread.highest))) == bits,
           Rule::kL207, [&] {
             return std::string(what) + " are " + std::to_string(spread.lowest) + " … " +
                    std::to_string(spread.highest) + " in " + std::to_string(bits) + " bits";
           });
  }

  void expect_value(std::int64_t value, std::int64_t lowest, std::int64_t highest, const char* what, std::uint32_t v) {
    if (value >= lowest && value <= highest) return;
    require(false, Rule::kL212,
            [&] { return std::string(what) + " of vertex " + std::to_string(v) + " is " + std::to_string(value); });
  }

  void check_positions() {
    constexpr std::uint32_t kOthers[3][2] = {{1, 2}, {0, 2}, {0, 1}};
    Spread spread[3];
    raw_.assign(std::size_t{3} * vertices_, 0);
    std::uint64_t bit = position_bit_;
    for (std::uint32_t v = 0; v < vertices_; ++v) {
      std::int64_t* const raw = &raw_[std::size_t{3} * v];
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t value = words_.stream(bit, bits_[axis]);
        bit += bits_[axis];
        spread[axis].add(value);
        raw[axis] = value;
      }
      const std::int64_t shear = shear_[0] * raw[kOthers[shear_axis_][0]] + shear_[1] * raw[kOthers[shear_axis_][1]];
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::int64_t value = minimum_[axis] + raw[axis] + (axis == shear_axis_ ? wrap(shear) >> 7 : 0);
        expect_value(wrap(value), -format::kMaxGridCoordinate, format::kMaxGridCoordinate, "a coordinate", v);
      }
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis) expect_spread(spread[axis], bits_[axis], 0, "coordinates");
  }

  void check_normals() {
    const std::int64_t scale = mesh_.normal_scale;
    Spread spread[2];
    std::uint64_t bit = normal_bit_;
    for (std::uint32_t v = 0; v < vertices_; ++v) {
      std::int64_t ab[2];
      for (std::uint32_t c = 0; c < 2; ++c) {
        const std::uint32_t value = words_.stream(bit, normal_bits_[c]);
        bit += normal_bits_[c];
        spread[c].add(value);
        expect_value(normal_minimum_[c] + value, 0, 2 * scale, "a normal", v);
        ab[c] = normal_minimum_[c] + value - scale;
      }
      if (std::abs(ab[0]) + std::abs(ab[1]) <= scale) continue;
      // Where the far half of the octahedron unfolds, a direction could be written in several ways.
      expect((std::abs(ab[1]) != scale || ab[0] >= 0) && (std::abs(ab[0]) != scale || ab[1] >= 0), Rule::kL215,
             [&] { return "vertex " + std::to_string(v) + " has another pair for its normal"; });
    }
    for (std::uint32_t c = 0; c < 2; ++c) expect_spread(spread[c], normal_bits_[c], 0, "normals");
  }

  void check_uvs(std::uint32_t set) {
    constexpr std::int64_t kMaxUv = (1 << 24) - 1;  // a float holds every decoded coordinate exactly
    std::uint64_t bit = uv_bit_[set];
    std::uint32_t v = 0;
    for (const UvRangeWords& range : ranges_[set]) {
      Spread spread[2];
      for (const std::uint32_t end = v + range.vertices; v < end; ++v) {
        for (std::uint32_t c = 0; c < 2; ++c) {
          const std::uint32_t value = words_.stream(bit, range.bits[c]);
          bit += range.bits[c];
          spread[c].add(value);
          std::int64_t sum = 0;
          for (std::uint32_t k = 0; k < 3; ++k) sum += range.slope[c][k] * raw_[std::size_t{3} * v + k];
          expect_value(wrap(range.minimum[c] + value + (wrap(sum) >> range.shift[c])), -kMaxUv, kMaxUv,
                       "a texture coordinate", v);
        }
      }
      for (std::uint32_t c = 0; c < 2; ++c) expect_spread(spread[c], range.bits[c], 0, "texture coordinates");
    }
  }

  void check_colors() {
    Spread spread[4];
    std::uint64_t bit = color_bit_;
    for (std::uint32_t v = 0; v < vertices_; ++v) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t value = words_.stream(bit, color_bits_[k]);
        bit += color_bits_[k];
        spread[k].add(value);
        expect_value(std::int64_t{color_minimum_[k]} + value, 0, 255, "a colour", v);
      }
    }
    for (std::uint32_t k = 0; k < 4; ++k) expect_spread(spread[k], color_bits_[k], 0, "colours");
  }

  void check_strips() {
    std::uint32_t start = 0;
    for (std::uint32_t k = 0; k < strips_; ++k) {
      const std::uint32_t next =
          k == 0 ? 0 : words_.stream(restart_bit_ + std::uint64_t{k - 1} * restart_bits_, restart_bits_);
      if (!require((k == 0 || next > start) && next < triangles_, Rule::kL216,
                   [&] { return "strip " + std::to_string(k) + " starts at triangle " + std::to_string(next); })) {
        return;
      }
      start = next;
      require(words_.stream(turn_bit_ + start, 1) == 0, Rule::kL216,
              [&] { return "strip " + std::to_string(k) + " starts with a right turn"; });
    }
    std::uint32_t fresh = 0;
    for (std::uint32_t s = 0; s < slots_; ++s) fresh += words_.stream(fresh_bit_ + s, 1);
    if (!require(fresh == vertices_, Rule::kL210,
                 [&] { return differs("fresh slots", std::uint64_t{fresh}, "vertices", std::uint64_t{vertices_}); })) {
      return;
    }
    Spread spread;
    spread.lowest = 0;  // the shortest reference need not be 0
    std::uint64_t bit = reference_bit_;
    std::uint32_t named = 0;
    for (std::uint32_t s = 0; s < slots_; ++s) {
      if (words_.stream(fresh_bit_ + s, 1) != 0) {
        ++named;
        continue;
      }
      const std::uint32_t distance = words_.stream(bit, reference_bits_);
      bit += reference_bits_;
      spread.add(distance);
      require(distance < named, Rule::kL209,
              [&] { return "slot " + std::to_string(s) + " names a vertex before the first"; });
    }
    expect_spread(spread, reference_bits_, 1, "references");
  }

  const FileTables& file_;
  std::size_t page_;
  Words words_;
  RuleLog& log_;
  const format::MeshRecord& mesh_;
  bool has_normal_;
  std::size_t cluster_ = 0;
  std::uint64_t head_ = 0, cursor_ = 0, end_ = 0;
  std::uint32_t vertices_ = 0, triangles_ = 0, strips_ = 0, slots_ = 0;
  std::int64_t minimum_[3] = {}, shear_[2] = {};
  std::uint32_t bits_[3] = {}, shear_axis_ = 0, chart_ = 0;
  std::int64_t normal_minimum_[2] = {};
  std::uint32_t normal_bits_[2] = {};
  std::array<std::vector<UvRangeWords>, format::kMaxUvSets> ranges_;
  std::uint32_t color_minimum_[4] = {}, color_bits_[4] = {};
  std::uint32_t reference_bits_ = 0, restart_bits_ = 0;
  std::uint64_t position_bit_ = 0, normal_bit_ = 0, uv_bit_[format::kMaxUvSets] = {}, color_bit_ = 0, turn_bit_ = 0,
                fresh_bit_ = 0, restart_bit_ = 0, reference_bit_ = 0;
  std::vector<std::int64_t> raw_;  ///< positions as stored: texture coordinates are predicted from them
  bool sound_ = true;
};

bool check_decoded_page(const FileTables& file, std::size_t p, std::span<const std::uint8_t> bytes, RuleLog& log) {
  const format::PageRecord& page = file.pages[p];
  const auto at = [&] { return place("page", p); };
  ClusterBytesChecker checker(file, p, bytes, log);
  const Words words(bytes);
  const std::uint64_t heads = 2 + page.cluster_count * checker.head_words();
  if (!log.expect(heads < words.size(), Rule::kL205, at,
                  [] { return std::string("is shorter than its header and cluster heads"); })) {
    return false;
  }
  const bool sound = log.expect(words[0] == page.first_cluster && words[1] == page.cluster_count, Rule::kL205, at,
                                [] { return std::string("its header names other clusters"); });
  std::uint64_t next = heads;
  for (std::uint32_t k = 0; k < page.cluster_count; ++k) {
    const std::optional<std::uint64_t> end = checker.run(std::size_t{page.first_cluster} + k, k, next);
    if (!end) return false;
    next = *end;
  }
  if (!log.expect(next + 1 == words.size(), Rule::kL205, at,
                  [&] { return differs("words", words.size(), "used", next + 1); })) {
    return false;
  }
  log.expect(words[next] == 0, Rule::kL214, at, [] { return std::string("the last word is not zero"); });
  return sound;
}

}  // namespace

LoadedPages load_pages(const FileTables& file, const run::Asset* asset, RuleLog& log) {
  LoadedPages loaded;
  loaded.pages.reserve(file.pages.size());
  log.check(Rule::kL203);
  log.check(Rule::kL204);
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const format::PageRecord& page = file.pages[p];
    const auto at = [&] { return place("page", p); };
    const auto stored = file.bytes.subspan(page.offset, page.stored_bytes);
    loaded.pages.emplace_back(std::span<const std::uint8_t>{});
    log.expect(hash64(stored) == page.checksum, Rule::kL203, at,
               [] { return std::string("checksum of the stored bytes does not match"); });
    const bool is_plain = page.codec == format::Codec::kNone;
    // A page that does not shrink is stored plain.
    const bool sized = page.bytes <= format::kMaxPageBytes && page.bytes % 4 == 0 &&
                       (is_plain ? page.stored_bytes == page.bytes : page.stored_bytes < page.bytes);
    log.expect(sized, Rule::kL204, at, [&] {
      return differs("bytes", std::uint64_t{page.bytes}, "stored_bytes", std::uint64_t{page.stored_bytes});
    });
    if (sized && is_plain) {
      loaded.pages.back() = run::PageBytes(stored);
    } else if (sized && asset != nullptr) {
      Result<run::PageBytes> unpacked = run::load_page(*asset, PageId(static_cast<std::uint32_t>(p)));
      if (log.expect(unpacked.ok(), Rule::kL204, at, [&] { return unpacked.error().message(); })) {
        loaded.pages.back() = std::move(*unpacked);
      }
    }
    const auto bytes = loaded.pages.back().bytes();
    if (bytes.size() != page.bytes) {
      loaded.is_complete = false;
      continue;
    }
    log.expect(hash64(bytes) == page.decoded_checksum, Rule::kL203, at,
               [] { return std::string("checksum of the decoded bytes does not match"); });
  }
  return loaded;
}

bool check_page_bytes(const FileTables& file, const LoadedPages& loaded, RuleLog& log) {
  for (const Rule rule : {Rule::kL205, Rule::kL206, Rule::kL207, Rule::kL208, Rule::kL209, Rule::kL210, Rule::kL211,
                          Rule::kL212, Rule::kL214, Rule::kL215, Rule::kL216})
    log.check(rule);
  bool sound = loaded.is_complete;
  for (std::size_t p = 0; p < file.pages.size(); ++p) {
    const auto bytes = loaded.pages[p].bytes();
    if (!bytes.empty() || file.pages[p].bytes == 0) sound &= check_decoded_page(file, p, bytes, log);
  }
  return sound;
}

}  // namespace meshlode::judge
