// SPDX-License-Identifier: MIT
#include "unpack/unpack_strips.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include <meshlode/page.h>

#include "coding/vertex_fields.h"

namespace meshlode {

namespace {

using format::ClusterLayout;

constexpr std::uint32_t kMaxSlots = format::kMaxClusterTriangles * 3;  ///< every triangle a strip of its own
using Lanes = Quad::Lanes;
using SignedLanes = std::int32_t __attribute__((vector_size(16)));

Lanes unfold_lanes(Lanes value) { return (value >> 1U) ^ (0U - (value & 1U)); }

/// Writes fields into words, lowest bit first. Stores the word at hand every time: cheaper than a branch nobody foresees.
class WordSink {
 public:
  explicit WordSink(std::uint32_t* at) : at_(at) {}
  /// \pre value < 2^bits, bits <= 32
  void put(std::uint32_t value, std::uint32_t bits) {
    pending_ |= std::uint64_t{value} << count_;
    count_ += bits;
    *at_ = static_cast<std::uint32_t>(pending_);
    at_ += count_ >> 5U;
    pending_ >>= count_ & 32U;
    count_ &= 31U;
  }
  void flush() {
    if (count_ > 0) *at_ = static_cast<std::uint32_t>(pending_);
  }

 private:
  std::uint32_t* at_;
  std::uint64_t pending_ = 0;
  std::uint32_t count_ = 0;
};

constexpr std::uint32_t low_mask(std::uint32_t bits) { return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1U); }

/// The three triangles in a triple, one a byte: 4 · turn + kind.
constexpr std::array<std::uint32_t, kTripleSymbols> make_triple_table() {
  std::array<std::uint32_t, kTripleSymbols> table{};
  for (std::uint32_t t = 0; t < kTripleSymbols; ++t) {
    for (std::uint32_t rest = t, k = 0; k < 3; ++k, rest /= kTriangleSymbols) {
      const std::uint32_t symbol = rest % kTriangleSymbols;
      table[t] |= (symbol / kSlotKinds * 4U + symbol % kSlotKinds) << 8U * k;
    }
  }
  return table;
}
constexpr auto kTripleTableWords = make_triple_table();

class StripUnpacker {
 public:
  StripUnpacker(const format::MeshRecord& mesh, std::uint32_t cluster_count, PageColumns& columns,
                const StripValues& values, std::span<std::uint32_t> page)
      : mesh_(mesh), cluster_count_(cluster_count), columns_(columns), values_(values), page_(page),
        fields_(field_count(mesh)) {}

  bool run() {
    clusters_.resize(cluster_count_);
    ranges_.reserve(std::size_t{cluster_count_} * mesh_.uv_set_count);
    first_vertex_.resize(cluster_count_ + std::size_t{1});
    word_ = columns_.first_data_word();
    for (std::uint32_t c = 0; c < cluster_count_; ++c) {
      if (!unpack_cluster(c)) return false;
    }
    return word_ + 1 == page_.size();
  }

 private:
  bool unpack_cluster(std::uint32_t c) {
    if (!columns_.place_cluster(c, word_)) return false;
    ClusterFields& cluster = clusters_[c];
    ClusterLayout& layout = cluster.layout;
    if (format::read_cluster_layout(mesh_, page_, c, layout) != nullptr || layout.stream_word != word_) return false;
    read_cluster_fields(mesh_, page_.data(), cluster, ranges_);
    if (!read_topology(layout) || !place_twins(c) || !predict(cluster)) return false;
    write_stream(cluster);
    word_ = layout.end_word;
    first_vertex_[c + 1] = first_vertex_[c] + layout.vertex_count;
    return true;
  }

  /// Reads the strips of a cluster and walks them: gates_, kinds_, and what the page's topology bits say.
  bool read_topology(const ClusterLayout& layout) {
    // The streams are as long as the heads say, and this takes as much as the heads say: never more than there is.
    const std::uint32_t continued = layout.triangle_count - layout.strip_count;
    std::array<std::uint8_t, format::kMaxClusterTriangles + 4> symbols;
    for (std::uint32_t i = 0; i < continued; i += 3) {
      const std::uint32_t triple = take(kTripleStream);
      if (triple >= kTripleSymbols) return false;
      std::memcpy(symbols.data() + i, &kTripleTableWords[triple], 4);
    }
    std::array<std::uint8_t, kMaxSlots> steps{};  // from one reference to the next, modulo 256
    for (std::uint32_t i = 0; i < layout.reference_count; ++i) {
      steps[i] = static_cast<std::uint8_t>(unfold(take(kReferenceStream)));
    }

    const std::uint8_t* symbol = symbols.data();
    std::uint32_t next = 0;       // vertices named so far
    std::uint32_t reference = 0;  // references so far
    std::uint32_t last = 0;       // vertex of the last one
    std::uint32_t slot = 0;
    std::uint32_t is_bad = 0;
    // Selects by masks: which way a slot is named cannot be foreseen, and a wrong guess costs more than all of this.
    const auto name = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t kind) {
      const std::uint32_t is_fresh = (kind + 1U) >> 1U;  // 0 1 1
      const std::uint32_t mask = is_fresh - 1U;          // all ones for a reference
      const std::uint32_t referred = (last + steps[reference]) & 0xFFU;
      const std::uint64_t gate = a | std::uint64_t{b} << 16U | std::uint64_t{c} << 32U | std::uint64_t{kind} << 48U;
      std::memcpy(&gates_[next], &gate, sizeof(gate));
      distances_[reference] = static_cast<std::uint8_t>(next - 1U - referred);
      fresh_[slot++] = static_cast<std::uint8_t>(is_fresh);
      is_bad |= mask & ((next - 1U - referred) >> 31U);
      const std::uint32_t vertex = next ^ ((next ^ referred) & mask);
      last ^= (last ^ referred) & mask;
      reference += 1U - is_fresh;
      next += is_fresh;
      return vertex;
    };
    std::uint32_t p = kNobody;
    std::uint32_t q = kNobody;
    std::uint32_t n = kNobody;
    std::uint32_t t = 0;
    for (std::uint32_t strip = 0; strip < layout.strip_count; ++strip) {
      const std::uint32_t left = layout.triangle_count - t - (layout.strip_count - strip - 1);  // one each for the others
      std::uint32_t length = left;
      if (strip + 1 < layout.strip_count) {
        length = take(kLengthStream) + 1U;
        if (length > left || length == 0) return false;
        restarts_[strip] = static_cast<std::uint8_t>(t + length);
      }
      const std::uint32_t start = take(kStartStream);
      if (start >= kStartSymbols) return false;
      p = name(n, n, n, start / (kSlotKinds * kSlotKinds));
      q = name(p, p, p, start / kSlotKinds % kSlotKinds);
      n = name(q, q, q, start % kSlotKinds);
      turns_[t++] = 0;
      for (std::uint32_t i = 1; i < length; ++i, ++t) {
        const std::uint32_t turn = *symbol >> 2U;
        const std::uint32_t mask = 0U - turn;
        const std::uint32_t kind = *symbol & 3U;
        ++symbol;
        turns_[t] = static_cast<std::uint8_t>(turn);
        const std::uint32_t opposite = q ^ ((p ^ q) & mask);
        p ^= (p ^ n) & mask;
        q ^= (q ^ n) & ~mask;
        n = name(p, q, opposite, kind);
      }
    }
    return is_bad == 0 && next == layout.vertex_count && reference == layout.reference_count;
  }

  /// The fields of vertices that earlier clusters hold. Also the list of those that none does.
  bool place_twins(std::uint32_t c) {
    const ClusterFields& cluster = clusters_[c];
    const FieldContext context{mesh_, page_.data(), ranges_};
    std::array<std::uint8_t, format::kMaxClusterVertices + 1> twins;
    std::uint32_t twin_count = 0;
    new_count_ = 0;
    for (std::uint32_t v = 0; v < cluster.layout.vertex_count; ++v) {
      const std::uint32_t is_twin = gates_[v].kind >> 1U;
      new_vertices_[new_count_] = static_cast<std::uint8_t>(v);
      twins[twin_count] = static_cast<std::uint8_t>(v);
      twin_count += is_twin;
      new_count_ += 1U - is_twin;
    }
    const std::array<std::uint32_t, 3> axes = axes_by_role(cluster.layout.shear_axis);
    RawVertex raw;
    RawVertex here;
    FullVertex full;
    std::uint32_t other = 0;
    for (std::uint32_t i = 0; i < twin_count; ++i) {
      if (next_[kTwinStream] >= values_.streams[kTwinStream].size()) return false;
      last_twin_ += unfold(take(kTwinStream));
      if (last_twin_ >= first_vertex_[c]) return false;
      if (last_twin_ < first_vertex_[other] || last_twin_ >= first_vertex_[other + 1]) {
        const auto behind = std::upper_bound(first_vertex_.begin(), first_vertex_.begin() + c + 1, last_twin_);
        other = static_cast<std::uint32_t>(behind - first_vertex_.begin()) - 1U;
      }
      const std::uint32_t there = last_twin_ - first_vertex_[other];
      read_raw_vertex(context, clusters_[other], there, raw);
      full_from_raw(context, clusters_[other], there, raw, full);
      raw_from_full(context, cluster, twins[i], full, here);
      for (std::uint32_t f = 0; f < 3; ++f) raw_[0][twins[i]].lane[f] = here[axes[f]];
      for (std::uint32_t f = 3; f < fields_; ++f) raw_[quad_of(f)][twins[i]].lane[lane_of(f)] = here[f];
    }
    return true;
  }

  [[nodiscard]] std::uint32_t take(std::uint32_t stream) { return values_.streams[stream][next_[stream]++]; }

  /// Errors and predictions become fields, four at a time.
  bool predict(const ClusterFields& cluster) {
    if (new_count_ > values_.errors[0].size() - next_error_) return false;
    const RawVertex bits = first_field_bits({mesh_, page_.data(), ranges_}, cluster);
    const std::array<std::uint32_t, 3> axes = axes_by_role(cluster.layout.shear_axis);
    for (std::uint32_t f = 0; f < fields_; ++f) {
      raw_[quad_of(f)][kNobody].lane[lane_of(f)] = (1U << bits[f < 3 ? axes[f] : f]) >> 1U;
    }
    for (std::uint32_t quad = 0; quad <= quad_of(fields_ - 1); ++quad) {
      const Quad* const errors = values_.errors[quad].data() + next_error_;
      Quad* const raw = raw_[quad].data();
      if (quad == 1 && mesh_.normal_mode == format::NormalMode::kStored) {
        constexpr Lanes kNormals = {~0U, ~0U, 0U, 0U};
        for (std::uint32_t i = 0; i < new_count_; ++i) {
          const Gate gate = gates_[new_vertices_[i]];
          const Lanes sum = raw[gate.a].lanes + raw[gate.b].lanes;
          const Lanes c = raw[gate.c].lanes;
          const auto half = reinterpret_cast<Lanes>(reinterpret_cast<SignedLanes>(3U * sum - 2U * c) >> 2);
          raw[new_vertices_[i]].lanes = ((half & kNormals) | ((sum - c) & ~kNormals)) + unfold_lanes(errors[i].lanes);
        }
      } else {
        for (std::uint32_t i = 0; i < new_count_; ++i) {
          const Gate gate = gates_[new_vertices_[i]];
          raw[new_vertices_[i]].lanes =
              raw[gate.a].lanes + raw[gate.b].lanes - raw[gate.c].lanes + unfold_lanes(errors[i].lanes);
        }
      }
    }
    next_error_ += new_count_;
    return true;
  }

  void write_stream(const ClusterFields& cluster) {
    const ClusterLayout& layout = cluster.layout;
    WordSink sink(page_.data() + layout.stream_word);
    put_positions(sink, layout);
    std::uint32_t field = 3;
    if (mesh_.normal_mode == format::NormalMode::kStored) {
      put_pairs(sink, field, layout.normal_bits, 0, layout.vertex_count);
      field += 2;
    }
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set, field += 2) {
      std::uint32_t range = cluster.first_range[set];
      for (std::uint32_t end = 0; end < layout.vertex_count; ++range) {
        put_pairs(sink, field, ranges_[range].bits, end, ranges_[range].end_vertex);
        end = ranges_[range].end_vertex;
      }
    }
    if (mesh_.has_color != 0) {
      for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
        for (std::uint32_t k = 0; k < 4; ++k) {
          const std::uint32_t bits = cluster.color_bits[k];
          sink.put(raw_[quad_of(field + k)][v].lane[lane_of(field + k)] & low_mask(bits), bits);
        }
      }
    }
    put_flags(sink, turns_.data(), layout.triangle_count);
    put_flags(sink, fresh_.data(), layout.slot_count);
    for (std::uint32_t k = 0; k + 1 < layout.strip_count; ++k) sink.put(restarts_[k], layout.restart_bits);
    const std::uint32_t mask = low_mask(layout.reference_bits);
    for (std::uint32_t i = 0; i < layout.reference_count; ++i) sink.put(distances_[i] & mask, layout.reference_bits);
    sink.flush();
  }

  void put_positions(WordSink& sink, const ClusterLayout& layout) const {
    std::array<std::uint32_t, 3> lane_of_axis{};
    const std::array<std::uint32_t, 3> axes = axes_by_role(layout.shear_axis);
    for (std::uint32_t f = 0; f < 3; ++f) lane_of_axis[axes[f]] = f;
    const std::uint32_t x_bits = layout.bits[0];
    const std::uint32_t y_bits = layout.bits[1];
    const std::uint32_t z_bits = layout.bits[2];
    const std::uint32_t x_mask = low_mask(x_bits);
    const std::uint32_t y_mask = low_mask(y_bits);
    const std::uint32_t z_mask = low_mask(z_bits);
    const bool is_one_word = x_bits + y_bits + z_bits <= 32;
    for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
      const std::uint32_t* const lane = raw_[0][v].lane;
      if (is_one_word) {
        const std::uint64_t yz = (lane[lane_of_axis[1]] & y_mask) | std::uint64_t{lane[lane_of_axis[2]] & z_mask} << y_bits;
        sink.put((lane[lane_of_axis[0]] & x_mask) | static_cast<std::uint32_t>(yz << x_bits), x_bits + y_bits + z_bits);
      } else {
        sink.put(lane[lane_of_axis[0]] & x_mask, x_bits);
        sink.put(lane[lane_of_axis[1]] & y_mask, y_bits);
        sink.put(lane[lane_of_axis[2]] & z_mask, z_bits);
      }
    }
  }

  /// \pre both fields are in one quad
  void put_pairs(WordSink& sink, std::uint32_t field, const std::uint32_t* bits, std::uint32_t from,
                 std::uint32_t to) const {
    const Quad* const raw = raw_[quad_of(field)].data();
    const std::uint32_t lane = lane_of(field);
    const std::uint32_t a_bits = bits[0];
    const std::uint32_t b_bits = bits[1];
    const std::uint32_t a_mask = low_mask(a_bits);
    const std::uint32_t b_mask = low_mask(b_bits);
    const bool is_one_word = a_bits + b_bits <= 32;
    for (std::uint32_t v = from; v < to; ++v) {
      const std::uint32_t a = raw[v].lane[lane] & a_mask;
      const std::uint32_t b = raw[v].lane[lane + 1] & b_mask;
      if (is_one_word) {
        sink.put(static_cast<std::uint32_t>(a | std::uint64_t{b} << a_bits), a_bits + b_bits);
      } else {
        sink.put(a, a_bits);
        sink.put(b, b_bits);
      }
    }
  }

  /// Bytes of 0 or 1 as bits, eight at a time by one product.
  static void put_flags(WordSink& sink, const std::uint8_t* flags, std::uint32_t count) {
    for (; count > 0; flags += 8) {
      std::uint64_t eight;
      std::memcpy(&eight, flags, sizeof(eight));
      const std::uint32_t bits = std::min(count, 8U);
      sink.put(static_cast<std::uint32_t>(eight * 0x0102040810204080U >> 56U) & low_mask(bits), bits);
      count -= bits;
    }
  }

  const format::MeshRecord& mesh_;
  std::uint32_t cluster_count_;
  PageColumns& columns_;
  const StripValues& values_;
  std::span<std::uint32_t> page_;
  std::uint32_t fields_;
  std::array<std::uint32_t, kFieldStreams> next_{};  ///< number of each stream
  std::uint32_t next_error_ = 0;

  std::uint32_t word_ = 0;  ///< where the next cluster's data goes
  std::vector<ClusterFields> clusters_;
  std::vector<UvRangeFields> ranges_;
  std::vector<std::uint32_t> first_vertex_;  ///< in the page, of each cluster; one more for the end
  std::uint32_t last_twin_ = 0;

  // Of the cluster at hand. Longer than a valid one needs: a broken one is only noticed behind its last slot.
  static constexpr std::size_t kSlotRoom = format::kMaxClusterVertices + kMaxSlots;
  std::array<Gate, kSlotRoom> gates_;
  std::array<std::uint8_t, kMaxSlots + 8> distances_, fresh_{};
  std::array<std::uint8_t, format::kMaxClusterTriangles + 8> turns_{};
  std::array<std::uint8_t, format::kMaxClusterTriangles> restarts_;
  std::array<std::uint8_t, format::kMaxClusterVertices + 1> new_vertices_;
  std::uint32_t new_count_ = 0;
  std::array<std::array<Quad, kNobody + 1>, kMaxQuads> raw_{};
};

}  // namespace

bool unpack_strips(const format::MeshRecord& mesh, std::uint32_t cluster_count, PageColumns& columns,
                   const StripValues& values, std::span<std::uint32_t> page) {
  return StripUnpacker(mesh, cluster_count, columns, values, page).run();
}

}  // namespace meshlode
