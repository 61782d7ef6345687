// SPDX-License-Identifier: GPL-3.0-or-later
// Prediction along strips after "Triangle mesh compression" (Touma and Gotsman, 1998), on the raw fields of the page:
// the shear of positions and the affine fit of UVs have already turned most of what is predictable into small numbers.
#include "builder/pack/page_model.h"

#include <algorithm>
#include <map>
#include <utility>

#include <meshlode/page.h>

#include "format/vertex_fields.h"

namespace meshlode::builder {

namespace {

using format::ClusterLayout;

/// One cluster's strips with the gate of every vertex.
struct StripWalk {
  struct Slot {
    std::uint32_t vertex;
    bool is_fresh;
  };
  std::vector<std::uint32_t> first_triangle;  ///< of each strip
  std::vector<std::uint32_t> turns;
  std::vector<Slot> slots;
  std::vector<format::Gate> gates;  ///< of each vertex
};

class PageModeler {
 public:
  PageModeler(const format::MeshRecord& mesh, std::span<const std::uint32_t> page)
      : mesh_(mesh), page_(page), fields_(format::field_count(mesh)) {}

  std::optional<PageModel> run() {
    if (page_.size() < 3) return std::nullopt;
    const std::uint32_t cluster_count = page_[1];
    if (cluster_count > page_.size() / format::kHeadWords) return std::nullopt;
    std::uint64_t expected = 2 + std::uint64_t{cluster_count} * format::head_words(mesh_);
    for (std::uint32_t c = 0; c < cluster_count; ++c) {
      ClusterLayout layout;
      if (format::read_cluster_layout(mesh_, page_, c, layout) != nullptr) return std::nullopt;
      if (layout.data_word != expected || !is_padding_zero(layout)) return std::nullopt;
      expected = layout.end_word;
      clusters_.emplace_back().layout = layout;
      format::read_cluster_fields(mesh_, page_.data(), clusters_.back(), ranges_);
    }
    if (expected + 1 != page_.size() || page_.back() != 0) return std::nullopt;
    for (const format::ClusterFields& cluster : clusters_) {
      if (!add_cluster(cluster)) return std::nullopt;
    }
    return std::move(model_);
  }

 private:
  [[nodiscard]] bool is_padding_zero(const ClusterLayout& layout) const {
    const std::uint32_t used = layout.end_bit % 32;
    return used == 0 || page_[layout.end_bit / 32] >> used == 0;
  }

  bool add_cluster(const format::ClusterFields& cluster) {
    const ClusterLayout& layout = cluster.layout;
    add_head(layout);
    const std::optional<StripWalk> walk = walk_strips(layout);
    if (!walk) return false;
    const std::vector<format::SlotKind> kinds = add_vertices(cluster, *walk);
    add_topology(layout, *walk, kinds);
    first_vertex_ += layout.vertex_count;
    return true;
  }

  void add_head(const ClusterLayout& layout) {
    auto& head = model_.heads.emplace_back();
    std::copy_n(page_.begin() + layout.head_word, format::head_words(mesh_), head.begin());
    const auto add = [this](format::RangeWord kind, std::uint32_t word) {
      model_.range_words[kind].push_back(page_[word]);
    };
    for (std::uint32_t i = 0; i < layout.material_count; ++i) add(format::kMaterialWord, layout.material_word + i);
    for (std::uint32_t set = 0; set < mesh_.uv_set_count; ++set) {
      std::uint32_t word = layout.uv_word[set];
      for (std::uint32_t i = 0; i < layout.uv_range_count[set]; ++i) {
        const bool has_fit = format::get_field(&page_[word], format::uv_range::kHasFit) != 0;
        add(format::kUvWord0, word++);
        add(format::kUvWord1, word++);
        add(format::kUvWord2, word++);
        if (!has_fit) continue;
        add(format::kFitWord0, word++);
        add(format::kFitWord1, word++);
      }
    }
    if (mesh_.has_color != 0) {
      add(format::kColorWord0, layout.color_word);
      add(format::kColorWord1, layout.color_word + 1);
    }
    model_.stream_words.insert(model_.stream_words.end(), page_.begin() + layout.stream_word,
                               page_.begin() + layout.end_word);
  }

  /// Null where the topology is not in its one canonical form.
  [[nodiscard]] std::optional<StripWalk> walk_strips(const ClusterLayout& layout) const {
    const std::uint32_t* const words = page_.data();
    StripWalk walk;
    walk.first_triangle.push_back(0);
    for (std::uint32_t k = 1; k < layout.strip_count; ++k) {
      const std::uint32_t first =
          format::get_bits(words, layout.restart_bit + (k - 1) * layout.restart_bits, layout.restart_bits);
      if (first <= walk.first_triangle.back() || first >= layout.triangle_count) return std::nullopt;
      walk.first_triangle.push_back(first);
    }
    std::uint32_t reference = 0;
    std::uint32_t p = format::kNobody;
    std::uint32_t q = format::kNobody;
    std::uint32_t n = format::kNobody;
    /// Names the vertex of the next slot; a fresh one gets the gate.
    const auto name = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) -> std::optional<std::uint32_t> {
      const bool is_fresh =
          format::get_bits(words, layout.fresh_bit + static_cast<std::uint32_t>(walk.slots.size()), 1) != 0;
      auto vertex = static_cast<std::uint32_t>(walk.gates.size());
      if (is_fresh) {
        if (vertex >= layout.vertex_count) return std::nullopt;
        walk.gates.push_back(
            {static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b), static_cast<std::uint16_t>(c), 0});
      } else {
        if (reference >= layout.reference_count) return std::nullopt;
        const std::uint32_t distance =
            format::get_bits(words, layout.reference_bit + reference * layout.reference_bits, layout.reference_bits);
        if (distance >= vertex) return std::nullopt;
        vertex -= 1 + distance;
        ++reference;
      }
      walk.slots.push_back({vertex, is_fresh});
      return vertex;
    };
    for (std::uint32_t t = 0, strip = 0; t < layout.triangle_count; ++t) {
      const std::uint32_t turn = format::get_bits(words, layout.turn_bit + t, 1);
      walk.turns.push_back(turn);
      if (strip < layout.strip_count && walk.first_triangle[strip] == t) {
        if (turn != 0) return std::nullopt;
        ++strip;
        std::uint32_t last = n;
        std::uint32_t corner[3];
        for (std::uint32_t& c : corner) {
          const auto vertex = name(last, last, last);
          if (!vertex) return std::nullopt;
          c = last = *vertex;
        }
        p = corner[0];
        q = corner[1];
        n = corner[2];
        continue;
      }
      const std::uint32_t opposite = turn == 0 ? q : p;
      (turn == 0 ? q : p) = n;
      const auto vertex = name(p, q, opposite);
      if (!vertex) return std::nullopt;
      n = *vertex;
    }
    if (walk.gates.size() != layout.vertex_count) return std::nullopt;
    return walk;
  }

  /// Fills the field and twin streams. Returns how each vertex was named.
  std::vector<format::SlotKind> add_vertices(const format::ClusterFields& cluster, const StripWalk& walk) {
    const ClusterLayout& layout = cluster.layout;
    const format::FieldContext context{mesh_, page_.data(), ranges_};
    std::vector<format::RawVertex> raw(format::kNobody + 1);
    raw[format::kNobody] = format::first_field_bits(context, cluster);
    for (std::uint32_t f = 0; f < fields_; ++f) raw[format::kNobody][f] = (1U << raw[format::kNobody][f]) >> 1U;
    const std::array<std::uint32_t, 3> axes = format::axes_by_role(layout.shear_axis);
    std::vector<format::SlotKind> kinds;
    std::vector<std::pair<format::FullVertex, std::uint32_t>> own;
    for (std::uint32_t v = 0; v < layout.vertex_count; ++v) {
      format::read_raw_vertex(context, cluster, v, raw[v]);
      format::FullVertex full{};
      format::full_from_raw(context, cluster, v, raw[v], full);
      const auto twin = seen_.find(full);
      if (twin == seen_.end()) {
        own.emplace_back(full, first_vertex_ + v);
      } else if (format::RawVertex back{}; format::raw_from_full(context, cluster, v, full, back), back == raw[v]) {
        kinds.push_back(format::SlotKind::kTwin);
        put(format::kTwinStream, format::fold(twin->second - last_twin_));
        last_twin_ = twin->second;
        continue;
      }
      kinds.push_back(format::SlotKind::kNew);
      const format::Gate gate = walk.gates[v];
      for (std::uint32_t f = 0; f < fields_; ++f) {
        const std::uint32_t at = f < 3 ? axes[f] : f;
        const std::uint32_t a = raw[gate.a][at];
        const std::uint32_t b = raw[gate.b][at];
        const std::uint32_t c = raw[gate.c][at];
        const bool is_normal = format::table_of_field(mesh_, f) == format::kNormalTable;
        put(format::kFieldStreams + f, format::fold(raw[v][at] - (is_normal ? format::predict_half(a, b, c)
                                                                            : format::predict_parallelogram(a, b, c))));
      }
    }
    for (const auto& [full, vertex] : own) seen_.emplace(full, vertex);  // twins are in earlier clusters only
    return kinds;
  }

  void add_topology(const ClusterLayout& layout, const StripWalk& walk, const std::vector<format::SlotKind>& kinds) {
    std::vector<std::uint32_t> slot_kinds;
    std::uint32_t last = 0;
    for (const StripWalk::Slot& slot : walk.slots) {
      slot_kinds.push_back(
          static_cast<std::uint32_t>(slot.is_fresh ? kinds[slot.vertex] : format::SlotKind::kReference));
      if (slot.is_fresh) continue;
      put(format::kReferenceStream, format::fold(slot.vertex - last));
      last = slot.vertex;
    }
    std::uint32_t triple = 0;
    std::uint32_t weight = 1;
    std::size_t s = 0;
    for (std::uint32_t t = 0, strip = 0; t < layout.triangle_count; ++t) {
      if (strip < layout.strip_count && walk.first_triangle[strip] == t) {
        if (strip > 0) put(format::kLengthStream, t - walk.first_triangle[strip - 1] - 1);
        ++strip;
        put(format::kStartStream,
            (slot_kinds[s] * format::kSlotKinds + slot_kinds[s + 1]) * format::kSlotKinds + slot_kinds[s + 2]);
        s += 3;
        continue;
      }
      triple += weight * (format::kSlotKinds * walk.turns[t] + slot_kinds[s++]);
      weight *= format::kTriangleSymbols;
      if (weight < format::kTripleSymbols) continue;
      put(format::kTripleStream, triple);
      triple = 0;
      weight = 1;
    }
    if (weight > 1) put(format::kTripleStream, triple);
  }

  void put(std::uint32_t stream, std::uint32_t value) { model_.streams[stream].push_back(value); }

  const format::MeshRecord& mesh_;
  std::span<const std::uint32_t> page_;
  std::uint32_t fields_;
  std::vector<format::ClusterFields> clusters_;
  std::vector<format::UvRangeFields> ranges_;
  PageModel model_;
  std::map<format::FullVertex, std::uint32_t> seen_;  ///< the first vertex of the page with these integers
  std::uint32_t first_vertex_ = 0;
  std::uint32_t last_twin_ = 0;
};

}  // namespace

std::optional<PageModel> model_page(const format::MeshRecord& mesh, std::span<const std::uint32_t> page) {
  return PageModeler(mesh, page).run();
}

}  // namespace meshlode::builder
