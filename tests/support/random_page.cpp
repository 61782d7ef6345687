// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/random_page.h"

#include <algorithm>
#include <bit>

#include "support/random.h"

namespace meshlode::test {

namespace {

class BitList {
 public:
  explicit BitList(std::vector<std::uint32_t>& words) : words_(words), start_(words.size()) {}
  void put(std::uint32_t value, std::uint32_t bits) {
    for (std::uint32_t bit = 0; bit < bits; ++bit, ++count_) {
      if (count_ % 32 == 0) words_.push_back(0);
      words_[start_ + count_ / 32] |= (value >> bit & 1U) << count_ % 32;
    }
  }

 private:
  std::vector<std::uint32_t>& words_;
  std::size_t start_, count_ = 0;
};

struct UvRange {
  std::vector<std::uint32_t> words;
  std::uint32_t vertex_count = 0, bits[2] = {};
};

/// What a cluster is drawn from; another cluster may take over everything but the topology.
struct Cluster {
  std::uint32_t head[6] = {};
  std::uint32_t vertex_count = 0;
  std::uint32_t bits[3] = {}, normal_bits[2] = {}, color_bits[4] = {};
  std::vector<UvRange> ranges[format::kMaxUvSets];
  std::uint32_t color_words[2] = {};
  std::vector<std::vector<std::uint32_t>> fields;  ///< of each vertex, in the order of the streams
};

class PageMaker {
 public:
  explicit PageMaker(const RandomPageOptions& options) : options_(options), random_(options.seed) {}

  RandomPage run() {
    format::MeshRecord& mesh = page_.mesh;
    mesh.normal_mode = options_.has_normals ? format::NormalMode::kStored : format::NormalMode::kNone;
    mesh.normal_scale = options_.has_normals ? 812 : 0;
    mesh.uv_set_count = options_.uv_set_count;
    mesh.has_color = options_.has_color ? 1U : 0U;
    mesh.material = options_.has_material_ranges ? format::kNone : 0U;
    page_.record.first_cluster = 7;
    page_.record.cluster_count = options_.cluster_count;
    page_.words = {7, options_.cluster_count};
    head_words_ = format::head_words(mesh);
    page_.words.resize(2 + options_.cluster_count * std::size_t{head_words_});
    for (std::uint32_t c = 0; c < options_.cluster_count; ++c) add_cluster(c);
    page_.words.push_back(0);
    page_.record.bytes = static_cast<std::uint32_t>(page_.words.size() * 4);
    return std::move(page_);
  }

 private:
  std::uint32_t below(std::uint64_t count) { return static_cast<std::uint32_t>(random_.below(count)); }
  std::uint32_t draw_bits(std::uint32_t most) { return below(std::min(most, options_.max_field_bits) + 1U); }

  void put(Cluster& cluster, format::BitField field, std::uint32_t value) {
    format::put_field(cluster.head, field, static_cast<std::int32_t>(value));
  }

  void add_cluster(std::uint32_t c) {
    Cluster cluster;
    draw_strips(cluster);
    draw_fields(cluster);
    if (!clusters_.empty() && below(2) == 0) copy_some(cluster);
    put(cluster, format::head::kDataWord, static_cast<std::uint32_t>(page_.words.size()));
    std::copy_n(cluster.head, head_words_, page_.words.begin() + 2 + c * head_words_);
    put_ranges(cluster);
    put_stream(cluster);
    clusters_.push_back(std::move(cluster));
  }

  void draw_strips(Cluster& cluster) {
    namespace h = format::head;
    slots_.clear();
    distances_.clear();
    turns_.clear();
    restarts_.clear();
    const std::uint32_t triangles = 1 + below(options_.max_triangles);
    const std::uint32_t strips = 1 + below(std::min(triangles, 12U));
    std::uint32_t fresh = 0;
    for (std::uint32_t strip = 0, t = 0; strip < strips; ++strip) {
      const std::uint32_t most = triangles - t - (strips - strip - 1);
      const std::uint32_t length = strip + 1 == strips ? most : 1 + below(most);
      if (strip > 0) restarts_.push_back(t);
      for (std::uint32_t i = 0; i < length + 2; ++i) {
        const bool is_fresh = fresh == 0 || (fresh < 256 && below(3) != 0);
        slots_.push_back(is_fresh);
        if (is_fresh) {
          ++fresh;
        } else {
          distances_.push_back(below(below(4) == 0 ? fresh : std::min(fresh, 9U)));
        }
        if (i > 1) turns_.push_back(i == 2 ? 0 : below(2));
      }
      t += length;
    }
    cluster.vertex_count = fresh;
    const auto most = distances_.empty() ? 1U : *std::max_element(distances_.begin(), distances_.end());
    reference_bits_ = std::max(1U, static_cast<std::uint32_t>(std::bit_width(most)));
    put(cluster, h::kVerticesLess1, fresh - 1);
    put(cluster, h::kTrianglesLess1, triangles - 1);
    put(cluster, h::kStripsLess1, strips - 1);
    put(cluster, h::kReferenceBits, reference_bits_);
  }

  void draw_fields(Cluster& cluster) {
    namespace h = format::head;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cluster.bits[axis] = draw_bits(24);
      put(cluster, h::kMinimum[axis], below(1U << 24U));
      put(cluster, h::kBits[axis], cluster.bits[axis]);
    }
    put(cluster, h::kShearAxis, below(3));
    put(cluster, h::kShearU, below(256));
    put(cluster, h::kShearV, below(256));
    if (options_.has_normals) {
      put(cluster, h::kChart, below(6));
      cluster.normal_bits[0] = draw_bits(14);
      cluster.normal_bits[1] = draw_bits(14);
      put(cluster, h::kNormalBitsA, cluster.normal_bits[0]);
      put(cluster, h::kNormalBitsB, cluster.normal_bits[1]);
      put(cluster, h::kNormalMinimumA, below(1625));
      put(cluster, h::kNormalMinimumB, below(1625));
    }
    for (std::uint32_t set = 0; set < options_.uv_set_count; ++set) draw_uv_ranges(cluster, set);
    if (options_.has_color) {
      for (std::size_t k = 0; k < 4; ++k) {
        cluster.color_bits[k] = draw_bits(8);
        format::put_field(cluster.color_words, format::color_range::kBits[k],
                          static_cast<std::int32_t>(cluster.color_bits[k]));
      }
      cluster.color_words[0] = static_cast<std::uint32_t>(random_.next());
    }
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      auto& fields = cluster.fields.emplace_back();
      const auto draw = [&](std::uint32_t bits) { fields.push_back(bits == 0 ? 0 : below(std::uint64_t{1} << bits)); };
      for (const std::uint32_t bits : cluster.bits) draw(bits);
      if (options_.has_normals) {
        for (const std::uint32_t bits : cluster.normal_bits) draw(bits);
      }
      for (std::uint32_t set = 0; set < options_.uv_set_count; ++set) {
        for (const std::uint32_t bits : range_of(cluster, set, v).bits) draw(bits);
      }
      if (options_.has_color) {
        for (const std::uint32_t bits : cluster.color_bits) draw(bits);
      }
    }
  }

  void draw_uv_ranges(Cluster& cluster, std::uint32_t set) {
    namespace f = format::uv_range;
    for (std::uint32_t covered = 0; covered < cluster.vertex_count;) {
      const std::uint32_t left = cluster.vertex_count - covered;
      UvRange range;
      range.vertex_count = below(2) == 0 ? left : 1 + below(left);
      range.bits[0] = draw_bits(25);
      range.bits[1] = draw_bits(25);
      const bool has_fit = below(2) == 0;
      range.words.assign(f::kWords + (has_fit ? f::kFitWords : 0U), 0);
      std::uint32_t* const words = range.words.data();
      format::put_field(words, f::kVerticesLess1, static_cast<std::int32_t>(range.vertex_count) - 1);
      format::put_field(words, f::kBitsU, static_cast<std::int32_t>(range.bits[0]));
      format::put_field(words, f::kBitsV, static_cast<std::int32_t>(range.bits[1]));
      format::put_field(words, f::kShiftU, static_cast<std::int32_t>(below(32)));
      format::put_field(words, f::kShiftV, static_cast<std::int32_t>(below(32)));
      format::put_field(words, f::kHasFit, has_fit ? 1 : 0);
      for (std::size_t w = 1; w < range.words.size(); ++w) range.words[w] = static_cast<std::uint32_t>(random_.next());
      covered += range.vertex_count;
      cluster.ranges[set].push_back(std::move(range));
    }
  }

  static const UvRange& range_of(const Cluster& cluster, std::uint32_t set, std::uint32_t vertex) {
    std::size_t r = 0;
    for (std::uint32_t covered = cluster.ranges[set][0].vertex_count; covered <= vertex;
         covered += cluster.ranges[set][r].vertex_count) {
      ++r;
    }
    return cluster.ranges[set][r];
  }

  /// The cluster takes over how an earlier one stores vertices, and every other vertex of it: twins.
  void copy_some(Cluster& cluster) {
    const Cluster& other = clusters_[below(clusters_.size())];
    std::uint32_t own[6];
    std::copy_n(cluster.head, 6, own);
    const std::uint32_t topology = 0xFFFU << 16U;  // strips and reference bits
    std::copy_n(other.head, 6, cluster.head);
    cluster.head[0] = own[0];
    cluster.head[4] = (other.head[4] & ~topology) | (own[4] & topology);
    std::copy_n(other.bits, 3, cluster.bits);
    std::copy_n(other.normal_bits, 2, cluster.normal_bits);
    std::copy_n(other.color_bits, 4, cluster.color_bits);
    std::copy_n(other.color_words, 2, cluster.color_words);
    for (std::uint32_t set = 0; set < options_.uv_set_count; ++set) {
      UvRange range = other.ranges[set][0];
      range.vertex_count = cluster.vertex_count;
      format::BitField count = format::uv_range::kVerticesLess1;
      range.words[count.word] &= ~count.mask();
      format::put_field(range.words.data(), count, static_cast<std::int32_t>(cluster.vertex_count) - 1);
      cluster.ranges[set].assign(1, range);
    }
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      const std::uint32_t from = below(other.ranges[0].empty() ? other.vertex_count : other.ranges[0][0].vertex_count);
      cluster.fields[v] = other.fields[from];
      for (std::uint32_t set = 1; set < options_.uv_set_count; ++set) {
        if (from >= other.ranges[set][0].vertex_count) cluster.fields[v] = other.fields[0];
      }
      if (below(2) == 0) cluster.fields[v][0] ^= cluster.bits[0] > 0 ? 1U : 0U;
    }
  }

  void put_ranges(const Cluster& cluster) {
    const std::uint32_t triangles = static_cast<std::uint32_t>(turns_.size());
    if (options_.has_material_ranges) {
      for (std::uint32_t covered = 0, material = 0; covered < triangles; ++material) {
        const std::uint32_t count = 1 + below(triangles - covered);
        std::uint32_t word = 0;
        format::put_field(&word, format::material_range::kTrianglesLess1, static_cast<std::int32_t>(count) - 1);
        format::put_field(&word, format::material_range::kMaterial, static_cast<std::int32_t>(material));
        page_.words.push_back(word);
        covered += count;
      }
    }
    for (std::uint32_t set = 0; set < options_.uv_set_count; ++set) {
      for (const UvRange& range : cluster.ranges[set]) {
        page_.words.insert(page_.words.end(), range.words.begin(), range.words.end());
      }
    }
    if (options_.has_color) page_.words.insert(page_.words.end(), cluster.color_words, cluster.color_words + 2);
  }

  void put_stream(const Cluster& cluster) {
    BitList bits(page_.words);
    std::size_t field = 0;
    const auto put_fields = [&](const std::uint32_t* widths, std::size_t count) {
      for (const auto& fields : cluster.fields) {
        for (std::size_t k = 0; k < count; ++k) bits.put(fields[field + k], widths[k]);
      }
      field += count;
    };
    put_fields(cluster.bits, 3);
    if (options_.has_normals) put_fields(cluster.normal_bits, 2);
    for (std::uint32_t set = 0; set < options_.uv_set_count; ++set) {
      for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
        for (std::size_t k = 0; k < 2; ++k) bits.put(cluster.fields[v][field + k], range_of(cluster, set, v).bits[k]);
      }
      field += 2;
    }
    if (options_.has_color) put_fields(cluster.color_bits, 4);
    for (const std::uint32_t turn : turns_) bits.put(turn, 1);
    for (const bool is_fresh : slots_) bits.put(is_fresh ? 1U : 0U, 1);
    const auto restart_bits = static_cast<std::uint32_t>(std::bit_width(turns_.size() - 1));
    for (const std::uint32_t restart : restarts_) bits.put(restart, restart_bits);
    for (const std::uint32_t distance : distances_) bits.put(distance, reference_bits_);
  }

  RandomPageOptions options_;
  Random random_;
  RandomPage page_;
  std::uint32_t head_words_ = 0;
  std::vector<Cluster> clusters_;
  std::vector<bool> slots_;
  std::vector<std::uint32_t> distances_, turns_, restarts_;
  std::uint32_t reference_bits_ = 0;
};

}  // namespace

RandomPage make_random_page(const RandomPageOptions& options) {
  return PageMaker(options).run();
}

}  // namespace meshlode::test
