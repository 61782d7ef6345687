// SPDX-License-Identifier: MIT
#include "unpack/unpack_strips.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include <meshlode/page.h>

#include "coding/vertex_fields.h"
#include "unpack/byte_sink.h"
#include "unpack/processor.h"
#include "unpack/twin_fields.h"

namespace meshlode {

namespace {

using format::ClusterLayout;

constexpr std::uint32_t kMaxSlots = format::kMaxClusterTriangles * 3;  ///< every triangle a strip of its own
/// Bits of a cluster's stream at most: 256 vertices of all fields, and its topology; and what a sink stores behind.
constexpr std::size_t kMaxStreamBytes =
    format::kMaxClusterVertices * (3 * 24 + 2 * 14 + format::kMaxUvSets * 2 * 25 + 4 * 8) / 8 +
    (format::kMaxClusterTriangles + kMaxSlots * (1 + 8) + format::kMaxClusterTriangles * 8) / 8 + 32;

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

template <class L>
class StripUnpacker {
 public:
  StripUnpacker(const format::MeshRecord& mesh, const PagePlan& plan, const StripValues<L>& values,
                std::span<std::uint32_t> page)
      : mesh_(mesh), plan_(plan), values_(values), page_(page), fields_(field_count(mesh)),
        vertex_count_(plan.first_vertex.back()) {
    name_ranges();
  }

  bool run() {
    for (std::uint32_t c = 0; c < plan_.clusters.size(); ++c) {
      const ClusterFields& cluster = plan_.clusters[c];
      if (!read_topology(cluster.layout) || !place_twins(c) || !predict(cluster)) return false;
      write_stream(cluster);
      std::fill_n(cluster_of_.begin() + plan_.first_vertex[c], cluster.layout.vertex_count, static_cast<std::uint16_t>(c));
    }
    return true;
  }

 private:
  using Word = typename L::Word;
  using Vector = typename L::Vector;
  using SignedVector = typename L::SignedVector;
  static constexpr std::uint32_t kNormalQuad = kNormalSlot / L::kLanes;

  static Vector unfold_lanes(Vector value) { return (value >> 1) ^ (Vector{} - (value & (Vector{} + 1))); }

  /// Both are of the page's vertices, so that twins find their cluster and its ranges without a search.
  void name_ranges() {
    cluster_of_.resize(vertex_count_);
    range_of_.resize(std::size_t{vertex_count_} * mesh_.uv_set_count);
    for (std::size_t c = 0; c < plan_.clusters.size(); ++c) {
      for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
        std::uint32_t range = plan_.clusters[c].first_range[set];
        for (std::uint32_t v = 0; v < plan_.clusters[c].layout.vertex_count; v = plan_.ranges[range++].end_vertex) {
          std::fill_n(range_of_.begin() + set * vertex_count_ + plan_.first_vertex[c] + v,
                      plan_.ranges[range].end_vertex - v, static_cast<std::uint16_t>(range));
        }
      }
    }
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
    std::array<std::uint8_t, kMaxSlots + 1> steps;  // from one reference to the next, modulo 256
    const std::uint32_t* const folded = values_.streams[kReferenceStream].data() + next_[kReferenceStream];
    for (std::uint32_t i = 0; i < layout.reference_count; ++i) steps[i] = static_cast<std::uint8_t>(unfold(folded[i]));
    steps[layout.reference_count] = 0;  // looked at, and of no effect, behind the last one
    next_[kReferenceStream] += layout.reference_count;

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
    const ClusterFields& cluster = plan_.clusters[c];
    const std::uint32_t first = plan_.first_vertex[c];
    const TwinFields fields(mesh_, page_.data(), plan_.ranges, range_of_, vertex_count_);
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
    if (twin_count > values_.streams[kTwinStream].size() - next_[kTwinStream]) return false;
    for (std::uint32_t i = 0; i < twin_count; ++i) {
      last_twin_ += unfold(take(kTwinStream));
      if (last_twin_ >= first) return false;
      const std::uint32_t other = cluster_of_[last_twin_];
      const std::uint32_t v = twins[i];
      fields.move(plan_.clusters[other], plan_.first_vertex[other], last_twin_, cluster, first + v,
                  [this, v](std::uint32_t field, std::uint32_t value) {
                    const std::uint32_t slot = slot_of(field);
                    raw_[slot / L::kLanes][v].lane[slot % L::kLanes] = static_cast<Word>(value);
                  });
    }
    return true;
  }

  [[nodiscard]] std::uint32_t take(std::uint32_t stream) { return values_.streams[stream].data()[next_[stream]++]; }

  /// Errors and predictions become fields, a vector at a time.
  bool predict(const ClusterFields& cluster) {
    if (new_count_ > values_.errors[0].size() - next_error_) return false;
    const RawVertex bits = first_field_bits({mesh_, page_.data(), plan_.ranges}, cluster);
    const std::array<std::uint32_t, 3> axes = axes_by_role(cluster.layout.shear_axis);
    for (std::uint32_t f = 0; f < fields_; ++f) {
      const std::uint32_t slot = slot_of(f);
      raw_[slot / L::kLanes][kNobody].lane[slot % L::kLanes] = static_cast<Word>((1U << bits[f < 3 ? axes[f] : f]) >> 1U);
    }
    for (std::uint32_t quad = 0; quad <= slot_of(fields_ - 1) / L::kLanes; ++quad) {
      if (quad == kNormalQuad && mesh_.normal_mode == format::NormalMode::kStored) {
        predict_quad<true>(quad);
      } else {
        predict_quad<false>(quad);
      }
    }
    next_error_ += new_count_;
    return true;
  }

  template <bool kHasNormals>
  void predict_quad(std::uint32_t quad) {
    Vector normals{};
    normals[kNormalSlot % L::kLanes] = normals[kNormalSlot % L::kLanes + 1] = static_cast<Word>(~Word{0});
    const Quad<L>* const errors = values_.errors[quad].data() + next_error_;
    Quad<L>* const raw = raw_[quad].data();
    for (std::uint32_t i = 0; i < new_count_; ++i) {
      const std::uint32_t v = new_vertices_[i];
      const Gate gate = gates_[v];
      const Vector sum = raw[gate.a].vector + raw[gate.b].vector;
      const Vector c = raw[gate.c].vector;
      Vector prediction = sum - c;
      if constexpr (kHasNormals) {
        const auto half = reinterpret_cast<Vector>(reinterpret_cast<SignedVector>(sum + prediction + prediction) >> 2);
        prediction = (half & normals) | (prediction & ~normals);
      }
      raw[v].vector = prediction + unfold_lanes(errors[i].vector);
    }
  }

  void write_stream(const ClusterFields& cluster) {
    const ClusterLayout& layout = cluster.layout;
    ByteSink sink(stream_.data());
    put_positions(sink, layout);
    std::uint32_t slot = kNormalSlot;
    if (mesh_.normal_mode == format::NormalMode::kStored) {
      put_pairs(sink, slot, layout.normal_bits, 0, layout.vertex_count);
      slot += 2;
    }
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set, slot += 2) {
      std::uint32_t range = cluster.first_range[set];
      for (std::uint32_t end = 0; end < layout.vertex_count; ++range) {
        put_pairs(sink, slot, plan_.ranges[range].bits, end, plan_.ranges[range].end_vertex);
        end = plan_.ranges[range].end_vertex;
      }
    }
    if (mesh_.has_color != 0) {
      for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
        for (std::uint32_t k = 0; k < 4; ++k) sink.put(field_of(v, slot + k, cluster.color_bits[k]), cluster.color_bits[k]);
      }
    }
    sink.put_flags(turns_.data(), layout.triangle_count);
    sink.put_flags(fresh_.data(), layout.slot_count);
    for (std::uint32_t k = 0; k + 1 < layout.strip_count; ++k) {
      sink.put(restarts_[k] & low_mask(layout.restart_bits), layout.restart_bits);
    }
    const std::uint64_t mask = low_mask(layout.reference_bits);
    sink.put_each(0, layout.reference_count, layout.reference_bits,
                  [this, mask](std::uint32_t i) { return distances_[i] & mask; });
    sink.flush();
    std::memcpy(page_.data() + layout.stream_word, stream_.data(),
                std::size_t{layout.end_word - layout.stream_word} * sizeof(std::uint32_t));
  }

  [[nodiscard]] std::uint64_t field_of(std::uint32_t v, std::uint32_t slot, std::uint32_t bits) const {
    return raw_[slot / L::kLanes][v].lane[slot % L::kLanes] & low_mask(bits);
  }

  void put_positions(ByteSink& sink, const ClusterLayout& layout) const {
    std::array<std::uint32_t, 3> lane{};
    const std::array<std::uint32_t, 3> axes = axes_by_role(layout.shear_axis);
    for (std::uint32_t f = 0; f < 3; ++f) lane[axes[f]] = f;
    const std::uint32_t x_bits = layout.bits[0];
    const std::uint32_t xy_bits = x_bits + layout.bits[1];
    const std::uint32_t all_bits = xy_bits + layout.bits[2];
    const std::uint64_t x_mask = low_mask(x_bits);
    const std::uint64_t y_mask = low_mask(layout.bits[1]);
    const std::uint64_t z_mask = low_mask(layout.bits[2]);
    const Quad<L>* const raw = raw_[0].data();
    if (all_bits <= ByteSink::kMaxBits) {
      sink.put_each(0, layout.vertex_count, all_bits, [&](std::uint32_t v) {
        const Word* const at = raw[v].lane;
        return (at[lane[0]] & x_mask) | (at[lane[1]] & y_mask) << x_bits | (at[lane[2]] & z_mask) << xy_bits;
      });
      return;
    }
    for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
      sink.put((raw[v].lane[lane[0]] & x_mask) | (raw[v].lane[lane[1]] & y_mask) << x_bits, xy_bits);
      sink.put(raw[v].lane[lane[2]] & z_mask, layout.bits[2]);
    }
  }

  /// Fields of two slots that share a vector.
  void put_pairs(ByteSink& sink, std::uint32_t slot, const std::uint32_t* bits, std::uint32_t from, std::uint32_t to) const {
    const Quad<L>* const raw = raw_[slot / L::kLanes].data();
    const std::uint32_t lane = slot % L::kLanes;
    const std::uint32_t first_bits = bits[0];
    const std::uint64_t first_mask = low_mask(bits[0]);
    const std::uint64_t second_mask = low_mask(bits[1]);
    sink.put_each(from, to, bits[0] + bits[1], [=](std::uint32_t v) {
      return (raw[v].lane[lane] & first_mask) | (raw[v].lane[lane + 1] & second_mask) << first_bits;
    });
  }

  const format::MeshRecord& mesh_;
  const PagePlan& plan_;
  const StripValues<L>& values_;
  std::span<std::uint32_t> page_;
  std::uint32_t fields_, vertex_count_;
  std::array<std::uint32_t, kFieldStreams> next_{};  ///< number of each stream
  std::uint32_t next_error_ = 0;
  std::uint32_t last_twin_ = 0;
  std::vector<std::uint16_t> cluster_of_, range_of_;

  // Of the cluster at hand. Longer than a valid one needs: a broken one is only noticed behind its last slot.
  static constexpr std::size_t kSlotRoom = format::kMaxClusterVertices + kMaxSlots;
  std::array<Gate, kSlotRoom> gates_;
  std::array<std::uint8_t, kMaxSlots + 8> distances_, fresh_{};
  std::array<std::uint8_t, format::kMaxClusterTriangles + 8> turns_{};
  std::array<std::uint8_t, format::kMaxClusterTriangles> restarts_;
  std::array<std::uint8_t, format::kMaxClusterVertices + 1> new_vertices_;
  std::uint32_t new_count_ = 0;
  std::array<std::array<Quad<L>, kNobody + 1>, kMaxQuads<L>> raw_{};
  std::array<std::uint8_t, kMaxStreamBytes> stream_;
};

#if MESHLODE_HAS_BMI2_PATH
template <class L>
MESHLODE_FOR_BMI2 bool run_with_bmi2(StripUnpacker<L>& unpacker) {
  return unpacker.run();
}
#endif

template <class L>
bool unpack_page_strips(const format::MeshRecord& mesh, const PagePlan& plan, const StripValues<L>& values,
                        std::span<std::uint32_t> page) {
  StripUnpacker<L> unpacker(mesh, plan, values, page);
#if MESHLODE_HAS_BMI2_PATH
  if (has_bmi2()) return run_with_bmi2(unpacker);
#endif
  return unpacker.run();
}

}  // namespace

bool unpack_strips(const format::MeshRecord& mesh, const PagePlan& plan, const StripValues<WideLanes>& values,
                   std::span<std::uint32_t> page) {
  return unpack_page_strips(mesh, plan, values, page);
}
bool unpack_strips(const format::MeshRecord& mesh, const PagePlan& plan, const StripValues<NarrowLanes>& values,
                   std::span<std::uint32_t> page) {
  return unpack_page_strips(mesh, plan, values, page);
}

}  // namespace meshlode
