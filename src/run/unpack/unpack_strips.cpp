// SPDX-License-Identifier: MIT
#include "run/unpack/unpack_strips.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include <meshlode/page.h>

#include "format/vertex_fields.h"
#include "run/unpack/byte_sink.h"
#include "run/unpack/processor.h"
#include "run/unpack/strip_slots.h"
#include "run/unpack/twin_fields.h"

namespace meshlode::run {

namespace {

using format::ClusterLayout;

/// Bits of a cluster's stream at most: 256 vertices of all fields, and its topology; and what a sink stores behind.
constexpr std::size_t kMaxStreamBytes =
    format::kMaxClusterVertices * (3 * 24 + 2 * 14 + format::kMaxUvSets * 2 * 25 + 4 * 8) / 8 +
    (format::kMaxClusterTriangles + kMaxSlots * (1 + 8) + format::kMaxClusterTriangles * 8) / 8 + 32;

/// Masks over all lanes by slot byte: all ones where the turn changes, and where the vertex is new.
template <class L>
struct SlotMasks {
  std::array<Quad<L>, kSlotBytes> change{}, is_new{};
};
template <class L>
constexpr SlotMasks<L> make_slot_masks() {
  SlotMasks<L> out;
  for (std::uint32_t byte = 0; byte < kSlotBytes; ++byte) {
    for (std::uint32_t lane = 0; lane < L::kLanes; ++lane) {
      out.change[byte].lane[lane] = static_cast<typename L::Word>((byte & kTurnBit) != 0 ? ~0U : 0U);
      out.is_new[byte].lane[lane] = static_cast<typename L::Word>((byte & kNewBit) != 0 ? ~0U : 0U);
    }
  }
  return out;
}
template <class L>
constexpr SlotMasks<L> kSlotMasks = make_slot_masks<L>();

/// `kQuads`: vectors that a vertex takes.
template <class L, std::uint32_t kQuads>
class StripUnpacker {
 public:
  StripUnpacker(const format::MeshRecord& mesh, const PagePlan& plan, const StripValues<L>& values,
                std::span<std::uint32_t> page)
      : mesh_(mesh),
        plan_(plan),
        values_(values),
        page_(page),
        fields_(format::field_count(mesh)),
        vertex_count_(plan.first_vertex.back()),
        cluster_of_(vertex_count_),
        range_of_(std::size_t{vertex_count_} * mesh.uv_set_count),
        twin_fields_(mesh, plan.clusters, plan.ranges, range_of_, vertex_count_) {
    name_ranges();
    raw_.resize(vertex_count_ + kRawPadding);
    if (mesh.normal_mode == format::NormalMode::kStored) {
      normals_.lane[kNormalSlot % L::kLanes] = normals_.lane[kNormalSlot % L::kLanes + 1] = static_cast<Word>(~Word{0});
    }
  }

  bool run() {
    for (std::uint32_t c = 0; c < plan_.clusters.size(); ++c) {
      const format::ClusterFields& cluster = plan_.clusters[c];
      if (!read_topology(cluster.layout) || !place_twins(c) || !walk(c)) return false;
      write_stream(c);
      std::fill_n(cluster_of_.begin() + plan_.first_vertex[c], cluster.layout.vertex_count,
                  static_cast<std::uint16_t>(c));
    }
    return true;
  }

 private:
  using Word = typename L::Word;
  using Vector = typename L::Vector;
  using SignedVector = typename L::SignedVector;
  struct Vectors {
    Vector of[kQuads];
  };
  /// The fields of a vertex by slot.
  union Vertex {
    Word lane[kQuads * L::kLanes];
    Vectors vectors;
  };
  static constexpr std::uint32_t kNormalQuad = kNormalSlot / L::kLanes;
  /// Vertices behind the page's last that a broken reference may name before it is found out.
  static constexpr std::size_t kRawPadding = format::kMaxClusterVertices;

  /// Both are of the page's vertices, so that twins find their cluster and its ranges without a search.
  void name_ranges() {
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

  /// The streams are as long as the heads say, and this takes as much as the heads say: never more than there is.
  const std::uint32_t* take(std::uint32_t stream, std::uint32_t count) {
    const std::uint32_t* const at = values_.streams[stream].data() + next_[stream];
    next_[stream] += count;
    return at;
  }

  bool read_topology(const ClusterLayout& layout) {
    const std::uint32_t* const steps = take(format::kReferenceStream, layout.reference_count);
    std::uint32_t last = 0;
    for (std::uint32_t i = 0; i < layout.reference_count; ++i) {
      references_[i] = static_cast<std::uint8_t>(last += steps[i]);
    }
    references_[layout.reference_count] = 0;  // looked at, and of no effect, behind the last one
    return slots_.read(layout, take(format::kTripleStream, (layout.triangle_count - layout.strip_count + 2) / 3),
                       take(format::kStartStream, layout.strip_count),
                       take(format::kLengthStream, layout.strip_count - 1));
  }

  /// The fields of vertices that earlier clusters hold.
  bool place_twins(std::uint32_t c) {
    const format::ClusterFields& cluster = plan_.clusters[c];
    const std::uint32_t first = plan_.first_vertex[c];
    const std::uint32_t count = slots_.twin_count();
    if (count > values_.streams[format::kTwinStream].size() - next_[format::kTwinStream] ||
        cluster.layout.vertex_count - count > values_.errors[0].size() - next_error_) {
      return false;
    }
    const std::uint32_t* step = take(format::kTwinStream, count);
    bool is_ok = true;
    slots_.each_twin(cluster.layout.slot_count, [&](std::uint32_t v) {
      last_twin_ += *step++;
      if (last_twin_ >= first) {
        is_ok = false;
        return;
      }
      twin_fields_.move<Word>(cluster_of_[last_twin_], last_twin_, raw_.data()[last_twin_].lane, c, first + v,
                              raw_.data()[first + v].lane);
    });
    return is_ok;
  }

  /// Half the range of every field.
  Vectors nobody(const format::ClusterFields& cluster) const {
    Vertex out{};
    const format::RawVertex bits = format::first_field_bits({mesh_, page_.data(), plan_.ranges}, cluster);
    const std::array<std::uint32_t, 3> axes = format::axes_by_role(cluster.layout.shear_axis);
    for (std::uint32_t f = 0; f < fields_; ++f) {
      const std::uint32_t slot = slot_of(f);
      out.lane[slot] = static_cast<Word>((1U << bits[f < 3 ? axes[f] : f]) >> 1U);
    }
    return out.vectors;
  }

  /// Goes along the strips: which vertex every slot names, and the fields of the new ones. The last three vertices stay
  /// in registers, and every choice is made by masks: which way a slot is named cannot be foreseen, and a wrong guess
  /// costs more than all of this.
  bool walk(std::uint32_t c) {
    const format::ClusterFields& cluster = plan_.clusters[c];
    const ClusterLayout& layout = cluster.layout;
    Vertex* const raw = raw_.data() + plan_.first_vertex[c];
    const Vector normals = normals_.vector;
    std::array<const Quad<L>*, kQuads> errors;
    for (std::uint32_t q = 0; q < kQuads; ++q) errors[q] = values_.errors[q].data() + next_error_;
    std::uint32_t next = 0;   // vertices named so far
    std::uint32_t slot = 0;   // slots so far: the others were references
    std::uint32_t error = 0;  // new vertices so far

    /// The vertex of a slot with byte `byte`, predicted as n + a - c.
    const auto name = [&](std::uint32_t byte, const Vectors& n, const Vectors& a, const Vectors& c3) {
      const std::uint32_t is_fresh = byte & kFreshBit;
      const std::uint32_t reference = references_[slot - next];
      distances_[slot - next] = static_cast<std::uint16_t>(next - 1U - reference);
      const std::uint32_t vertex = reference ^ ((reference ^ next) & (0U - is_fresh));
      const Vector is_new = kSlotMasks<L>.is_new[byte].vector;
      Vectors out;
      for (std::uint32_t q = 0; q < kQuads; ++q) {
        // Only n is late: what it is not needed for comes first.
        Vector known = a.of[q] - c3.of[q];
        Vector named = raw[vertex].vectors.of[q] & ~is_new;
        if (q == kNormalQuad) {
          const Vector half = n.of[q] + n.of[q] + n.of[q] + (a.of[q] + known + known);
          known = ((known + n.of[q]) & ~normals) + errors[q][error].vector;
          named = (named | (known & is_new)) +
                  (reinterpret_cast<Vector>(reinterpret_cast<SignedVector>(half) >> 2) & (normals & is_new));
        } else {
          named |= (known + errors[q][error].vector + n.of[q]) & is_new;
        }
        out.of[q] = named;
      }
      raw[vertex].vectors = out;
      ++slot;
      next += is_fresh;
      error += byte >> kNewBitIndex;
      return out;
    };

    const std::uint8_t* bytes = slots_.slots();
    Vectors n = nobody(cluster);
    for (std::uint32_t strip = 0; strip < layout.strip_count; ++strip) {
      Vectors a = name(bytes[0], n, n, n);
      Vectors b = name(bytes[1], a, a, a);
      n = name(bytes[2], b, b, b);
      bytes += 3;
      const std::uint8_t* const end = bytes + slots_.more_triangles(strip);
      for (; bytes < end; ++bytes) {
        const std::uint32_t byte = *bytes;
        // Of the triangle's two older vertices the strip keeps one, a, and leaves the other, c. After as many turns the
        // same way a stays; where the turn changes it is left, and the one that came before the newest is kept.
        const Vector change = kSlotMasks<L>.change[byte].vector;
        Vectors left;
        for (std::uint32_t q = 0; q < kQuads; ++q) {
          const Vector exchange = (a.of[q] ^ b.of[q]) & change;
          a.of[q] ^= exchange;
          left.of[q] = b.of[q] ^ exchange;
        }
        b = n;
        n = name(byte, n, a, left);
      }
    }
    next_error_ += error;
    std::uint32_t is_bad = 0;
    for (std::uint32_t i = 0; i < layout.reference_count; ++i) is_bad |= distances_[i] >> 15U;
    return is_bad == 0;
  }

  void write_stream(std::uint32_t c) {
    const format::ClusterFields& cluster = plan_.clusters[c];
    const ClusterLayout& layout = cluster.layout;
    const Vertex* const raw = raw_.data() + plan_.first_vertex[c];
    ByteSink sink(stream_.data());
    put_positions(sink, layout, raw);
    if constexpr (kQuads * L::kLanes > kNormalSlot) put_attributes(sink, cluster, raw);
    put_topology(sink, layout);
    sink.flush();
    std::memcpy(page_.data() + layout.stream_word, stream_.data(),
                std::size_t{layout.end_word - layout.stream_word} * sizeof(std::uint32_t));
  }

  void put_attributes(ByteSink& sink, const format::ClusterFields& cluster, const Vertex* raw) const {
    const ClusterLayout& layout = cluster.layout;
    std::uint32_t slot = kNormalSlot;
    if (mesh_.normal_mode == format::NormalMode::kStored) {
      put_pairs(sink, raw, slot, layout.normal_bits, 0, layout.vertex_count);
      slot += 2;
    }
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set, slot += 2) {
      std::uint32_t range = cluster.first_range[set];
      for (std::uint32_t end = 0; end < layout.vertex_count; ++range) {
        put_pairs(sink, raw, slot, plan_.ranges[range].bits, end, plan_.ranges[range].end_vertex);
        end = plan_.ranges[range].end_vertex;
      }
    }
    if (mesh_.has_color != 0) {
      for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
        for (std::uint32_t k = 0; k < 4; ++k) {
          sink.put(raw[v].lane[slot + k] & low_mask(cluster.color_bits[k]), cluster.color_bits[k]);
        }
      }
    }
  }

  void put_topology(ByteSink& sink, const ClusterLayout& layout) const {
    for (std::uint32_t t = 0; t < layout.triangle_count; t += 32) {
      std::uint64_t bits = 0;
      for (std::uint32_t k = 0; k < 32; k += 8)
        bits |= std::uint64_t{gather_bits(slots_.turns() + t + k, kTurnBitIndex)} << k;
      const std::uint32_t count = std::min(layout.triangle_count - t, 32U);
      sink.put(bits & low_mask(count), count);
    }
    for (std::uint32_t s = 0; s < layout.slot_count; s += 32) {
      const std::uint32_t count = std::min(layout.slot_count - s, 32U);
      sink.put(slots_.fresh_word(s / 64) >> s % 64 & low_mask(count), count);
    }
    for (std::uint32_t k = 0; k + 1 < layout.strip_count; ++k) {
      sink.put(slots_.restart(k) & low_mask(layout.restart_bits), layout.restart_bits);
    }
    const std::uint64_t mask = low_mask(layout.reference_bits);
    sink.put_each(0, layout.reference_count, layout.reference_bits,
                  [this, mask](std::uint32_t i) { return distances_[i] & mask; });
  }

  static void put_positions(ByteSink& sink, const ClusterLayout& layout, const Vertex* raw) {
    std::array<std::uint32_t, 3> lane{};
    const std::array<std::uint32_t, 3> axes = format::axes_by_role(layout.shear_axis);
    for (std::uint32_t f = 0; f < 3; ++f) lane[axes[f]] = f;
    const std::uint32_t x_bits = layout.bits[0];
    const std::uint32_t xy_bits = x_bits + layout.bits[1];
    const std::uint32_t all_bits = xy_bits + layout.bits[2];
    const std::uint64_t x_mask = low_mask(x_bits);
    const std::uint64_t y_mask = low_mask(layout.bits[1]);
    const std::uint64_t z_mask = low_mask(layout.bits[2]);
    if (all_bits <= ByteSink::kMaxBits) {
      sink.put_each(0, layout.vertex_count, all_bits, [&](std::uint32_t v) {
        const Word* const at = raw[v].lane;
        return (at[lane[0]] & x_mask) | (at[lane[1]] & y_mask) << x_bits | (at[lane[2]] & z_mask) << xy_bits;
      });
      return;
    }
    for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
      const Word* const at = raw[v].lane;
      sink.put((at[lane[0]] & x_mask) | (at[lane[1]] & y_mask) << x_bits, xy_bits);
      sink.put(at[lane[2]] & z_mask, layout.bits[2]);
    }
  }

  /// Fields of two slots.
  static void put_pairs(ByteSink& sink, const Vertex* raw, std::uint32_t slot, const std::uint32_t* bits,
                        std::uint32_t from, std::uint32_t to) {
    const std::uint32_t first_bits = bits[0];
    const std::uint64_t first_mask = low_mask(bits[0]);
    const std::uint64_t second_mask = low_mask(bits[1]);
    sink.put_each(from, to, bits[0] + bits[1], [=](std::uint32_t v) {
      return (raw[v].lane[slot] & first_mask) | (raw[v].lane[slot + 1] & second_mask) << first_bits;
    });
  }

  const format::MeshRecord& mesh_;
  const PagePlan& plan_;
  const StripValues<L>& values_;
  std::span<std::uint32_t> page_;
  std::uint32_t fields_, vertex_count_;
  std::vector<std::uint16_t> cluster_of_, range_of_;
  TwinFields twin_fields_;
  std::array<std::uint32_t, format::kFieldStreams> next_{};  ///< number of each stream
  std::uint32_t next_error_ = 0;
  std::uint32_t last_twin_ = 0;
  Quad<L> normals_{};          ///< mask of the fields that are normals
  UnfilledArray<Vertex> raw_;  ///< the page's vertices, field by field as their own cluster says them

  // Of the cluster at hand.
  StripSlots slots_;
  std::array<std::uint8_t, kMaxSlots + 1> references_;
  std::array<std::uint16_t, kMaxSlots + 1> distances_;
  std::array<std::uint8_t, kMaxStreamBytes> stream_;
};

#if MESHLODE_HAS_BMI2_PATH
template <class L, std::uint32_t kQuads>
MESHLODE_FOR_BMI2 bool run_with_bmi2(StripUnpacker<L, kQuads>& unpacker) {
  return unpacker.run();
}
#endif

template <class L, std::uint32_t kQuads = 1>
bool unpack_page_strips(const format::MeshRecord& mesh, const PagePlan& plan, const StripValues<L>& values,
                        std::span<std::uint32_t> page) {
  if constexpr (kQuads < kMaxQuads<L>) {
    if (quad_count<L>(mesh) > kQuads) return unpack_page_strips<L, kQuads + 1>(mesh, plan, values, page);
  }
  const auto unpacker = std::make_unique<StripUnpacker<L, kQuads>>(mesh, plan, values, page);
#if MESHLODE_HAS_BMI2_PATH
  if (has_bmi2()) return run_with_bmi2(*unpacker);
#endif
  return unpacker->run();
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

}  // namespace meshlode::run
