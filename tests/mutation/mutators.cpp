// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutation/mutators.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include "run/decode/decode.h"
#include "run/read/asset.h"

namespace meshlode::test {

namespace {

using format::SectionId;
using Edit = AssetEdit;
using Random = SplitMix64;

std::uint32_t pick(Random& r, std::size_t count) {
  return static_cast<std::uint32_t>(r.below(count));
}
float shrink(Random& r) {
  return static_cast<float>(r.between(0.3, 0.999));
}
float grow(Random& r) {
  return static_cast<float>(r.between(1.001, 3.0));
}

/// Another value than `value` below `bound`; or `value` itself where there is no other.
std::uint32_t other(Random& r, std::uint32_t value, std::uint32_t first, std::uint32_t count) {
  if (count < 2) return value;
  const std::uint32_t drawn = first + pick(r, count - 1);
  return drawn >= value ? drawn + 1 : drawn;
}

template <class T>
bool nudge(T& value, Random& r) {
  const T before = value;
  const auto step = static_cast<T>(1 + r.below(7));
  value = static_cast<T>(r.below(2) == 0 ? value + step : value - step);
  return value != before;
}

std::uint32_t mesh_of_cluster(const Edit& e, std::uint32_t c) {
  const auto meshes = e.meshes();
  std::uint32_t m = 0;
  while (c < meshes[m].first_cluster || c - meshes[m].first_cluster >= meshes[m].cluster_count) ++m;
  return m;
}

/// A random cluster of level 0, or of a level above.
std::uint32_t pick_cluster(const Edit& e, Random& r, bool level0) {
  const auto clusters = e.clusters();
  std::vector<std::uint32_t> matching;
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    if ((clusters[c].own_group == format::kNone) == level0) matching.push_back(c);
  }
  return matching.empty() ? format::kNone : matching[pick(r, matching.size())];
}

/// Changes a group and the leaf of the hierarchy that repeats it, so that the leaf does not tell.
template <class Change>
void with_leaf(Edit& e, std::uint32_t g, const Change& change) {
  e.group(g, change);
  const auto group = e.groups()[g];
  const auto nodes = e.nodes();
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].child_count != 0 || nodes[n].first != g) continue;
    e.node(n, [&](auto& node) {
      std::copy(std::begin(group.center), std::end(group.center), std::begin(node.center));
      node.radius = group.radius;
      node.error = group.error;
    });
  }
}

template <class Record>
bool move_center(Record& record, Random& r) {
  if (record.radius == 0.0F) return false;
  record.center[r.below(3)] +=
      record.radius * static_cast<float>(r.between(0.02, 1.0)) * (r.below(2) == 0 ? 1.0F : -1.0F);
  return true;
}

std::uint32_t pick_inner_node(const Edit& e, Random& r) {
  const auto nodes = e.nodes();
  std::vector<std::uint32_t> inner;
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].child_count > 0) inner.push_back(n);
  }
  return inner.empty() ? format::kNone : inner[pick(r, inner.size())];
}

float largest_finer_error(const Edit& e, std::uint32_t g) {
  const auto groups = e.groups();
  const auto clusters = e.clusters();
  float largest = 0.0F;
  for (std::uint32_t c = groups[g].first_cluster; c < groups[g].first_cluster + groups[g].cluster_count; ++c) {
    if (clusters[c].own_group != format::kNone) largest = std::max(largest, groups[clusters[c].own_group].error);
  }
  return largest;
}

/// What is promised of a group besides its position.
std::uint64_t promise_offset(const Edit& e, std::uint32_t g) {
  return e.offset_of<format::PromiseGroupRecord>(SectionId::kPromiseErrors, g);
}
bool has_promises(const Edit& e) {
  return e.section_entry_offset(SectionId::kPromiseErrors) != 0;
}

/// The least appearance that the rules of validate let a group promise, where it is no terminal one.
float least_appearance(const Edit& e, std::uint32_t g) {
  const auto groups = e.groups();
  const auto clusters = e.clusters();
  float least = std::max(groups[g].error, e.get<format::PromiseGroupRecord>(promise_offset(e, g)).texel_error);
  for (std::uint32_t c = groups[g].first_cluster; c < groups[g].first_cluster + groups[g].cluster_count; ++c) {
    if (clusters[c].own_group == format::kNone) continue;
    const auto finer = e.get<format::PromiseGroupRecord>(promise_offset(e, clusters[c].own_group));
    least = std::max(least, finer.appearance_error * 1.001F);
  }
  return least;
}

// -------------------------------------------------------------------------------------------------------------
// vertices

using Position = std::array<std::int64_t, 3>;

Position position_of(const Edit& e, std::uint32_t c, std::uint32_t v) {
  Position p{};
  for (std::uint32_t k = 0; k < 3; ++k) p[k] = e.minimum(c, k) + std::int64_t{e.stored(c, v, k)};
  const auto at = e.layout(c);
  const std::uint32_t u = at.shear_axis == 0 ? 1 : 0;
  const std::uint32_t w = at.shear_axis == 2 ? 1 : 2;
  p[at.shear_axis] += (at.shear_u * std::int64_t{e.stored(c, v, u)} + at.shear_v * std::int64_t{e.stored(c, v, w)}) >>
                      format::kShearShift;
  return p;
}

/// Vertices of a cluster that clusters of other own groups of the mesh and level have, too; or those that they have
/// not.
std::vector<std::uint32_t> vertices_where(const Edit& e, std::uint32_t c, bool shared) {
  const auto clusters = e.clusters();
  const auto mesh = e.meshes()[mesh_of_cluster(e, c)];
  std::set<Position> others;
  for (std::uint32_t k = mesh.first_cluster; k < mesh.first_cluster + mesh.cluster_count; ++k) {
    if (clusters[k].level != clusters[c].level || clusters[k].own_group == clusters[c].own_group) continue;
    for (std::uint32_t v = 0; v < clusters[k].vertex_count(); ++v) others.insert(position_of(e, k, v));
  }
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < clusters[c].vertex_count(); ++v) {
    if (others.contains(position_of(e, c, v)) == shared) out.push_back(v);
  }
  return out;
}

/// Positions on the border of the cut in which the own group of a cluster is replaced, and nothing that is coarser or
/// beside it: where the source is open, its border as simplified there. \pre the asset is sound
std::set<Position> rim_around(const Edit& e, std::uint32_t c) {
  const Result<run::Asset> asset = run::Asset::from_bytes(e.bytes());
  const Result<std::vector<run::DecodedCluster>> decoded =
      asset ? run::decode_all(*asset) : Result<std::vector<run::DecodedCluster>>(asset.error());
  std::set<Position> rim;
  if (!decoded) return rim;
  const auto clusters = e.clusters();
  const auto groups = e.groups();
  const auto mesh = e.meshes()[mesh_of_cluster(e, c)];
  std::vector<bool> passes(groups.size(), false);
  passes[clusters[c].own_group] = true;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {  // from coarse to fine
    for (std::uint32_t k = 0; passes[g] && k < groups[g].cluster_count; ++k) {
      const std::uint32_t own = clusters[groups[g].first_cluster + k].own_group;
      if (own != format::kNone) passes[own] = true;
    }
  }
  std::map<std::pair<Position, Position>, int> net;  // uses from the smaller to the larger position minus those back
  for (std::uint32_t k = mesh.first_cluster; k < mesh.first_cluster + mesh.cluster_count; ++k) {
    const bool is_drawn =
        (clusters[k].own_group == format::kNone || passes[clusters[k].own_group]) && !passes[clusters[k].coarser_group];
    if (!is_drawn) continue;
    const run::DecodedCluster& cluster = (*decoded)[k];
    for (const auto& triangle : cluster.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3i p = cluster.position(triangle[i]);
        const Vec3i q = cluster.position(triangle[(i + 1) % 3]);
        const Position a{p.x, p.y, p.z};
        const Position b{q.x, q.y, q.z};
        if (a != b) net[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
  }
  for (const auto& [edge, uses] : net) {
    if (uses != 0) rim.insert({edge.first, edge.second});
  }
  return rim;
}

/// Shared vertices on the border of the source as simplified there, or those that are not.
std::vector<std::uint32_t> shared_vertices_where(const Edit& e, std::uint32_t c, bool on_rim) {
  std::vector<std::uint32_t> out;
  const std::vector<std::uint32_t> shared = vertices_where(e, c, true);
  if (shared.empty()) return out;
  const std::set<Position> rim = rim_around(e, c);
  for (const std::uint32_t v : shared) {
    if (rim.contains(position_of(e, c, v)) == on_rim) out.push_back(v);
  }
  return out;
}

/// The one cluster that was made from its group.
bool is_alone_in_place_of_its_group(const Edit& e, std::uint32_t c) {
  const auto clusters = e.clusters();
  const std::uint32_t own = clusters[c].own_group;
  return own != format::kNone &&
         std::count_if(clusters.begin(), clusters.end(), [&](const auto& x) { return x.own_group == own; }) == 1;
}

/// Flips one bit of a stored value at or above `lowest`.
bool flip_bit(Edit& e, Random& r, std::uint32_t c, std::uint32_t v, std::uint32_t k, std::uint32_t lowest) {
  const std::uint32_t bits = e.place_of(c, v, k).count;
  if (bits <= lowest) return false;
  e.put_stored(c, v, k, e.stored(c, v, k) ^ 1U << (lowest + pick(r, bits - lowest)));
  return true;
}

/// The smallest bit of a value whose flip leaves the rounding of quantization: a normal's value may be two off.
std::uint32_t lowest_telling_bit(const Edit& e, std::uint32_t c, std::uint32_t k) {
  const auto mesh = e.meshes()[mesh_of_cluster(e, c)];
  const bool is_normal = mesh.normal_mode == format::NormalMode::kStored && (k == 3 || k == 4);
  return is_normal ? 3 : 1;
}

/// A reference names another vertex.
bool change_index(Edit& e, Random& r, std::uint32_t c) {
  const auto at = e.layout(c);
  if (at.reference_count == 0) return false;
  const std::uint32_t bit = at.reference_bit + pick(r, at.reference_count) * at.reference_bits;
  const std::uint32_t value = e.page_bits(c, bit, at.reference_bits);
  e.put_page_bits(c, bit, at.reference_bits, other(r, value, 0, 1U << at.reference_bits));
  return true;
}

/// A strip goes the other way at one of its triangles.
bool turn_triangle(Edit& e, Random& r, std::uint32_t c) {
  const auto at = e.layout(c);
  const std::uint32_t bit = at.turn_bit + pick(r, at.triangle_count);
  e.put_page_bits(c, bit, 1, 1U - e.page_bits(c, bit, 1));
  return true;
}

bool change_material(Edit& e, Random& r, std::uint32_t c) {
  const auto at = e.layout(c);
  const auto count = static_cast<std::uint32_t>(e.materials().size());
  if (count < 2) return false;
  if (at.material_count == 0) {
    bool done = false;
    e.mesh(mesh_of_cluster(e, c), [&](auto& m) {
      m.material = other(r, m.material, 0, count);
      done = true;
    });
    return done;
  }
  const std::uint32_t word = at.material_word + pick(r, at.material_count);
  const auto material = static_cast<std::uint32_t>(e.field(c, word, format::material_range::kMaterial));
  e.put_field(c, word, format::material_range::kMaterial, static_cast<std::int32_t>(other(r, material, 0, count)));
  return true;
}

/// Another value in a field.
bool change_field(Edit& e, Random& r, std::uint32_t c, std::uint32_t word, format::BitField field) {
  const auto value = static_cast<std::uint32_t>(e.field(c, word, field)) & field.mask();
  e.put_field(c, word, field, static_cast<std::int32_t>(value ^ 1U << pick(r, field.bits)));
  return true;
}

bool change_text(Edit& e, Random& r, SectionId id) {
  const auto section = e.section(id);
  if (section.bytes == 0) return false;
  // A letter for a letter: the text stays one of its kind, and says something else.
  for (int tries = 0; tries < 64; ++tries) {
    std::uint8_t& byte = e.bytes()[section.offset + r.below(section.bytes)];
    if (byte < 'a' || byte > 'z') continue;
    byte = byte == 'z' ? 'y' : static_cast<std::uint8_t>(byte + 1);
    return true;
  }
  return false;
}

// ----------------------------------------------------------------------------------------------------------------
// kinds

std::vector<MutantKind> make_kinds() {
  std::vector<MutantKind> kinds;
  const auto always = [&](const char* name, std::function<bool(Edit&, Random&)> mutate) {
    kinds.push_back({name, nullptr, std::move(mutate)});
  };
  const auto mostly = [&](const char* name, const char* why, std::function<bool(Edit&, Random&)> mutate) {
    kinds.push_back({name, why, std::move(mutate)});
  };
  const auto any_group = [](const Edit& e, Random& r) { return pick(r, e.groups().size()); };
  const auto any_cluster = [](const Edit& e, Random& r) { return pick(r, e.clusters().size()); };

  // bounds and errors
  always("group sphere", [=](Edit& e, Random& r) {
    bool done = false;
    e.group(any_group(e, r), [&](auto& g) {
      done = g.radius > 0.0F;
      if (r.below(2) == 0)
        g.radius *= r.below(2) == 0 ? shrink(r) : grow(r);
      else
        done = move_center(g, r);
    });
    return done;
  });
  always("group error", [=](Edit& e, Random& r) {
    bool done = false;
    e.group(any_group(e, r), [&](auto& g) {
      done = g.error > 0.0F && g.error < 1e30F;
      g.error *= r.below(2) == 0 ? shrink(r) : grow(r);
    });
    return done;
  });
  always("LOD sphere shrunk, leaf too", [=](Edit& e, Random& r) {
    const auto g = any_group(e, r);
    if (e.groups()[g].radius == 0.0F) return false;
    const float f = shrink(r);
    with_leaf(e, g, [&](auto& x) { x.radius *= f; });
    return true;
  });
  always("LOD sphere moved, leaf too", [=](Edit& e, Random& r) {
    const auto g = any_group(e, r);
    bool done = false;
    with_leaf(e, g, [&](auto& x) { done = move_center(x, r); });
    return done;
  });
  mostly("LOD sphere grown, leaf too", "a larger sphere that the coarser ones still contain is valid",
         [=](Edit& e, Random& r) {
           const auto g = any_group(e, r);
           const float f = grow(r);
           with_leaf(e, g, [&](auto& x) { x.radius *= f; });
           return e.groups()[g].radius > 0.0F;
         });
  always("error below a finer one, leaf too", [=](Edit& e, Random& r) {
    const auto g = any_group(e, r);
    const float finer = largest_finer_error(e, g);
    if (finer == 0.0F) return false;
    with_leaf(e, g, [&](auto& x) { x.error = finer * shrink(r); });
    return true;
  });
  mostly("error raised, leaf too", "an error may be larger than need be, as long as the coarser ones are larger still",
         [=](Edit& e, Random& r) {
           const auto g = any_group(e, r);
           if (e.groups()[g].error > 1e30F) return false;
           with_leaf(e, g, [&](auto& x) { x.error = x.error * grow(r) + 1e-6F; });
           return true;
         });
  // A forged measurement: nothing in the asset contradicts it, so only the surface can.
  mostly("error and deviation lowered, leaf too",
         "less than 5% too low, or another group's error is as large in every cut that was measured",
         [=](Edit& e, Random& r) {
           const auto g = any_group(e, r);
           const float error = e.groups()[g].error;
           const auto f = static_cast<float>(r.between(0.3, 0.9));
           if (error > 1e30F || error == 0.0F || error * f <= 1.001F * largest_finer_error(e, g)) return false;
           with_leaf(e, g, [&](auto& x) { x.error *= f; });
           e.group(g, [&](auto& x) { x.deviation *= x.deviation < 1e30F ? f : 1.0F; });
           return true;
         });
  mostly("promised appearance lowered",
         "less than 5% too low, or another group's error is as large in every cut that was measured",
         [=](Edit& e, Random& r) {
           if (!has_promises(e)) return false;
           const auto g = any_group(e, r);
           const float least = least_appearance(e, g);
           if (e.groups()[g].error > 1e30F) return false;
           bool done = false;
           e.change_at<format::PromiseGroupRecord>(promise_offset(e, g), [&](auto& x) {
             done = x.appearance_error > 1.2F * least;
             if (done)
               x.appearance_error = std::max(least, x.appearance_error * static_cast<float>(r.between(0.3, 0.8)));
           });
           return done;
         });
  always("promised unit of normals", [=](Edit& e, Random& r) {
    if (!has_promises(e)) return false;
    const auto m = pick(r, e.meshes().size());
    bool done = false;
    e.change_at<format::PromiseMeshRecord>(e.offset_of<format::PromiseMeshRecord>(SectionId::kPromises, m),
                                           [&](auto& x) {
                                             done = x.normal_object > 0.0F;
                                             x.normal_object *= r.below(2) == 0 ? shrink(r) : grow(r);
                                           });
    return done;
  });
  mostly("deviation lowered", "it is a figure to read: what cuts are chosen by is the error, and that is measured",
         [=](Edit& e, Random& r) {
           const auto g = any_group(e, r);
           if (e.groups()[g].deviation > 1e30F || e.groups()[g].deviation == 0.0F) return false;
           e.group(g, [&](auto& x) { x.deviation *= shrink(r); });
           return true;
         });
  mostly("quadric error", "an estimate alone: any between the finer and the coarser ones is valid",
         [=](Edit& e, Random& r) {
           const auto g = any_group(e, r);
           if (e.groups()[g].quadric_error > 1e30F || e.groups()[g].quadric_error == 0.0F) return false;
           e.group(g, [&](auto& x) { x.quadric_error *= r.below(2) == 0 ? shrink(r) : grow(r); });
           return true;
         });
  always("deviation above the error, attribute deviation of a root", [=](Edit& e, Random& r) {
    const auto id = any_group(e, r);
    const bool is_root = (e.groups()[id].flags & format::kGroupTerminal) != 0;
    e.group(id, [&](auto& g) {
      if (!is_root) {  // the qem tier has no deviation at all
        g.deviation = g.error * static_cast<float>(r.between(1.01, 3.0)) + 1e-6F;
        return;
      }
      float& value = r.below(3) == 0 ? g.deviation : r.below(2) == 0 ? g.normal_deviation : g.uv_deviation;
      value = static_cast<float>(r.between(0.1, 2.0));
    });
    return true;
  });
  always("culling sphere shrunk", [=](Edit& e, Random& r) {
    bool done = false;
    e.cluster(any_cluster(e, r), [&](auto& c) {
      const auto smaller = static_cast<std::uint16_t>(static_cast<float>(c.radius) * shrink(r));
      done = smaller + 8 < c.radius;  // a unit or two may be what snapping added
      c.radius = smaller;
    });
    return done;
  });
  always("culling sphere moved", [=](Edit& e, Random& r) {
    bool done = false;
    e.cluster(any_cluster(e, r), [&](auto& c) {
      const auto by = static_cast<std::int32_t>(c.radius * r.between(0.02, 1.0)) * (r.below(2) == 0 ? 1 : -1);
      std::int16_t& center = c.center[r.below(3)];
      done = std::abs(by) > 8 && std::abs(center + by) <= 32767;
      center = static_cast<std::int16_t>(center + by);
    });
    return done;
  });
  mostly("culling sphere grown", "a larger sphere inside the LOD sphere is valid", [=](Edit& e, Random& r) {
    e.cluster(any_cluster(e, r), [&](auto& c) {
      c.radius = static_cast<std::uint16_t>(std::min(65535.0F, static_cast<float>(c.radius) * grow(r)));
    });
    return true;
  });
  mostly("normal cone", "a cone that still holds every normal is valid", [=](Edit& e, Random& r) {
    bool done = false;
    e.cluster(any_cluster(e, r),
              [&](auto& c) { done = r.below(2) == 0 ? nudge(c.cone_cutoff, r) : nudge(c.cone_axis[r.below(3)], r); });
    return done;
  });
  always("node shrunk", [](Edit& e, Random& r) {
    const auto n = pick_inner_node(e, r);
    if (n == format::kNone) return false;
    e.node(n, [&](auto& x) { x.radius *= shrink(r); });
    return true;
  });
  always("node moved", [](Edit& e, Random& r) {
    const auto n = pick_inner_node(e, r);
    bool done = false;
    if (n != format::kNone) e.node(n, [&](auto& x) { done = move_center(x, r); });
    return done;
  });
  mostly("node grown", "a larger sphere inside its parent's is valid", [](Edit& e, Random& r) {
    const auto n = pick_inner_node(e, r);
    if (n == format::kNone) return false;
    e.node(n, [&](auto& x) { x.radius *= grow(r); });
    return true;
  });
  always("leaf", [](Edit& e, Random& r) {
    const auto nodes = e.nodes();
    const auto n = pick(r, nodes.size());
    if (nodes[n].child_count > 0 || nodes[n].radius == 0.0F) return false;
    e.node(n, [&](auto& x) {
      if (r.below(2) == 0)
        x.radius *= grow(r);
      else
        x.center[0] += x.radius;
    });
    return true;
  });
  always("node error lowered", [](Edit& e, Random& r) {
    const auto n = pick(r, e.nodes().size());
    if (e.nodes()[n].error == 0.0F) return false;
    e.node(n, [&](auto& x) { x.error *= shrink(r); });
    return true;
  });
  always("node links", [](Edit& e, Random& r) {
    bool done = false;
    e.node(pick(r, e.nodes().size()),
           [&](auto& x) { done = r.below(2) == 0 ? nudge(x.first, r) : nudge(x.child_count, r); });
    return done;
  });

  // the DAG
  always("own group", [=](Edit& e, Random& r) {
    const auto c = any_cluster(e, r);
    const auto mesh = e.meshes()[mesh_of_cluster(e, c)];
    bool done = false;
    e.cluster(c, [&](auto& x) {
      const auto before = x.own_group;
      x.own_group = before == format::kNone ? mesh.first_group + pick(r, mesh.group_count)
                    : r.below(4) == 0       ? format::kNone
                                            : other(r, before, mesh.first_group, mesh.group_count);
      done = x.own_group != before;
    });
    return done;
  });
  always("coarser group", [=](Edit& e, Random& r) {
    const auto c = any_cluster(e, r);
    const auto mesh = e.meshes()[mesh_of_cluster(e, c)];
    bool done = false;
    e.cluster(c, [&](auto& x) {
      const auto before = x.coarser_group;
      x.coarser_group = other(r, before, mesh.first_group, mesh.group_count);
      done = x.coarser_group != before;
    });
    return done;
  });
  always("cluster level", [=](Edit& e, Random& r) {
    e.cluster(any_cluster(e, r), [&](auto& x) { nudge(x.level, r); });
    return true;
  });
  always("group level", [=](Edit& e, Random& r) {
    e.group(any_group(e, r), [&](auto& x) { nudge(x.level, r); });
    return true;
  });
  always("group flags", [=](Edit& e, Random& r) {
    e.group(any_group(e, r), [&](auto& x) { x.flags = static_cast<std::uint16_t>(x.flags ^ 1U << r.below(16)); });
    return true;
  });
  always("stuck reason", [=](Edit& e, Random& r) {
    e.group(any_group(e, r), [&](auto& x) {
      x.stuck_reason = static_cast<format::StuckReason>(static_cast<std::uint32_t>(x.stuck_reason) + 1 + pick(r, 7));
    });
    return true;
  });
  always("reserved fields", [=](Edit& e, Random& r) {
    e.page(pick(r, e.pages().size()), [&](auto& x) { x.reserved = 1U << r.below(32); });
    return true;
  });
  always("two members of groups swapped", [=](Edit& e, Random& r) {
    const auto a = any_cluster(e, r);
    const auto b = any_cluster(e, r);
    const auto ca = e.clusters()[a];
    const auto cb = e.clusters()[b];
    if (ca.own_group == cb.own_group || mesh_of_cluster(e, a) != mesh_of_cluster(e, b)) return false;
    e.cluster(a, [&](auto& x) { x.own_group = cb.own_group; });
    e.cluster(b, [&](auto& x) { x.own_group = ca.own_group; });
    return true;
  });

  // counts and tables
  always("mesh ranges and counts", [](Edit& e, Random& r) {
    bool done = false;
    e.mesh(pick(r, e.meshes().size()), [&](auto& m) {
      std::uint32_t* fields[] = {&m.first_group, &m.group_count, &m.first_cluster, &m.cluster_count, &m.first_node,
                                 &m.node_count,  &m.level_count, &m.uv_set_count,  &m.has_color,     &m.normal_scale};
      done = nudge(*fields[r.below(std::size(fields))], r);
    });
    return done;
  });
  always("mesh source counts", [](Edit& e, Random& r) {
    bool done = false;
    e.mesh(pick(r, e.meshes().size()), [&](auto& m) {
      std::uint64_t* fields[] = {&m.source_triangles,  &m.source_vertices,  &m.dropped_degenerate,
                                 &m.dropped_duplicate, &m.dropped_repaired, &m.grid_collapsed};
      done = nudge(*fields[r.below(std::size(fields))], r);
    });
    return done;
  });
  always("mesh origin, grid, bounds, diagonal", [](Edit& e, Random& r) {
    const auto m = pick(r, e.meshes().size());
    if (e.meshes()[m].cluster_count == 0) return false;
    e.mesh(m, [&](auto& x) {
      switch (r.below(6)) {
        case 0: x.origin[r.below(3)] += r.between(0.5, 10.0) * (x.diagonal + 1.0); break;
        case 1: x.grid.log2 += r.below(2) == 0 ? 1 : -1; break;
        case 2: x.grid.mantissa += 2; break;
        case 3: nudge(x.bounds_min[r.below(3)], r); break;
        case 4: nudge(x.bounds_max[r.below(3)], r); break;
        default: x.diagonal *= r.between(1.001, 2.0); break;
      }
    });
    return true;
  });
  always("mesh modes and deviation", [](Edit& e, Random& r) {
    const auto m = pick(r, e.meshes().size());
    if (e.meshes()[m].cluster_count == 0) return false;
    e.mesh(m, [&](auto& x) {
      switch (r.below(4)) {
        case 0: x.level0_deviation = x.level0_deviation * 1.01F + 1e-7F; break;
        case 1: x.error_tier = static_cast<format::ErrorTier>(1 + r.below(5)); break;
        case 2:
          x.normal_mode =
              static_cast<format::NormalMode>(x.normal_mode == format::NormalMode::kStored ? 2 * r.below(2) : 1);
          break;
        default: x.uv_log2[r.below(4)] += 1; break;
      }
    });
    return true;
  });
  always("group ranges", [=](Edit& e, Random& r) {
    e.group(any_group(e, r), [&](auto& x) {
      std::uint32_t* fields[] = {&x.first_cluster, &x.mesh, &x.page};
      const auto f = r.below(4);
      if (f < 3)
        nudge(*fields[f], r);
      else
        nudge(x.cluster_count, r);
    });
    return true;
  });
  always("cluster counts", [=](Edit& e, Random& r) {
    e.cluster(any_cluster(e, r), [&](auto& x) { nudge(r.below(2) == 0 ? x.vertices_less_1 : x.triangles_less_1, r); });
    return true;
  });
  always("page table", [](Edit& e, Random& r) {
    e.page(pick(r, e.pages().size()), [&](auto& x) {
      std::uint32_t* fields[] = {&x.stored_bytes,  &x.bytes,         &x.first_group,      &x.group_count,
                                 &x.first_cluster, &x.cluster_count, &x.first_dependency, &x.dependency_count};
      const auto f = r.below(std::size(fields) + 2);
      if (f < std::size(fields))
        nudge(*fields[f], r);
      else if (f == std::size(fields))
        nudge(x.offset, r);
      else
        x.codec = static_cast<format::Codec>(1 + r.below(4));
    });
    return true;
  });
  always("dependencies", [](Edit& e, Random& r) {
    const auto section = e.section(SectionId::kPageDeps);
    if (section.bytes == 0) return false;
    e.change_at<std::uint32_t>(section.offset + 4 * r.below(section.bytes / 4), [&](auto& x) { nudge(x, r); });
    return true;
  });
  always("section table", [](Edit& e, Random& r) {
    const auto header = e.get<format::FileHeader>(0);
    e.change_at<format::SectionEntry>(
        header.section_table_offset + sizeof(format::SectionEntry) * r.below(header.section_count), [&](auto& s) {
          switch (r.below(9)) {
            case 0: s.id ^= 1U << r.below(32); break;
            case 1: nudge(s.version, r); break;
            case 2: s.flags ^= 2U << r.below(31); break;
            case 3: nudge(s.codec, r); break;
            case 4: nudge(s.offset, r); break;
            case 5: nudge(s.bytes, r); break;
            case 6: nudge(s.decoded_bytes, r); break;
            case 7: r.below(2) == 0 ? nudge(s.record_bytes, r) : nudge(s.record_count, r); break;
            default: s.reserved = 1ULL << r.below(64); break;
          }
        });
    return true;
  });
  always("header", [](Edit& e, Random& r) {
    e.header([&](auto& h) {
      switch (r.below(7)) {
        case 0: h.magic ^= 1U << r.below(32); break;
        case 1: nudge(h.version, r); break;
        case 2: nudge(h.header_bytes, r); break;
        case 3: nudge(h.section_count, r); break;
        case 4: nudge(h.file_bytes, r); break;
        case 5: nudge(h.section_table_offset, r); break;
        default: r.below(2) == 0 ? nudge(h.section_entry_bytes, r) : nudge(h.flags, r); break;
      }
    });
    return true;
  });

  // pages
  always("page header", [](Edit& e, Random& r) {
    const auto page = e.pages()[pick(r, e.pages().size())];
    e.change_at<std::uint32_t>(page.offset + 4 * r.below(2U), [&](auto& x) { nudge(x, r); });
    return true;
  });
  always("head: counts, data word, strips, reference bits", [=](Edit& e, Random& r) {
    const auto c = any_cluster(e, r);
    const format::BitField fields[] = {format::head::kVerticesLess1, format::head::kTrianglesLess1,
                                       format::head::kDataWord, format::head::kStripsLess1,
                                       format::head::kReferenceBits};
    return change_field(e, r, c, e.layout(c).head_word, fields[r.below(std::size(fields))]);
  });
  always("head: bits of positions and normals", [=](Edit& e, Random& r) {
    const auto c = any_cluster(e, r);
    const bool has_normal = e.meshes()[mesh_of_cluster(e, c)].normal_mode == format::NormalMode::kStored;
    const format::BitField fields[] = {format::head::kBits[0], format::head::kBits[1], format::head::kBits[2],
                                       format::head::kNormalBitsA, format::head::kNormalBitsB};
    return change_field(e, r, c, e.layout(c).head_word, fields[r.below(has_normal ? 5 : 4)]);
  });
  always("head: chart and shear, level 0", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, true);
    const auto at = e.layout(c);
    // Slopes of axes that have no bits change nothing.
    if (at.bits[0] == 0 || at.bits[1] == 0 || at.bits[2] == 0) return false;
    const bool has_normal = e.meshes()[mesh_of_cluster(e, c)].normal_mode == format::NormalMode::kStored;
    const format::BitField fields[] = {format::head::kShearU, format::head::kShearV, format::head::kChart};
    const auto f = r.below(has_normal ? 3 : 2);
    // The lowest bits of a slope may round away over a short cluster.
    if (f < 2) {
      const auto value = static_cast<std::uint32_t>(e.head(c, fields[f])) & fields[f].mask();
      e.put_head(c, fields[f], static_cast<std::int32_t>(value ^ 0x40U));
      return at.bits[f == 0 ? (at.shear_axis == 0 ? 1 : 0) : (at.shear_axis == 2 ? 1 : 2)] > 2;
    }
    return change_field(e, r, c, at.head_word, fields[f]);
  });
  always("UV ranges: counts, bits", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, r.below(2) == 0);
    const auto mesh = e.meshes()[mesh_of_cluster(e, c)];
    if (mesh.uv_set_count == 0) return false;
    const format::BitField fields[] = {format::uv_range::kVerticesLess1, format::uv_range::kBitsU,
                                       format::uv_range::kBitsV, format::uv_range::kHasFit};
    return change_field(e, r, c, e.layout(c).uv_word[0], fields[r.below(std::size(fields))]);
  });
  always("colour ranges: bits", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, r.below(2) == 0);
    if (e.meshes()[mesh_of_cluster(e, c)].has_color == 0) return false;
    return change_field(e, r, c, e.layout(c).color_word, format::color_range::kBits[r.below(4)]);
  });
  always("minimum of positions", [=](Edit& e, Random& r) {
    const auto c = any_cluster(e, r);
    if (is_alone_in_place_of_its_group(e, c)) return false;
    e.move_minimum(c, pick(r, 3), r.below(2) == 0 ? 1 : -1);
    return true;
  });
  mostly("minimum of positions, a group's only cluster",
         "where it has no border but the source's it may lie a step aside: the simplifier's choice",
         [=](Edit& e, Random& r) {
           const auto c = any_cluster(e, r);
           if (!is_alone_in_place_of_its_group(e, c)) return false;
           e.move_minimum(c, pick(r, 3), r.below(2) == 0 ? 1 : -1);
           return true;
         });
  always("minimum of attributes, level 0", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, true);
    const auto n = e.stored_count(c);
    if (n < 4) return false;
    e.move_minimum(c, 3 + pick(r, n - 3U), r.below(2) == 0 ? 6 : -6);
    return true;
  });
  mostly("minimum of attributes, above",
         "attributes above level 0 that no neighbour shares are the simplifier's choice", [](Edit& e, Random& r) {
           const auto c = pick_cluster(e, r, false);
           const auto n = e.stored_count(c);
           if (n < 4) return false;
           e.move_minimum(c, 3 + pick(r, n - 3U), r.below(2) == 0 ? 3 : -3);
           return true;
         });
  always("vertex position, level 0", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, true);
    return flip_bit(e, r, c, pick(r, e.clusters()[c].vertex_count()), pick(r, 3), 0);
  });
  always("vertex attribute, level 0", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, true);
    const auto n = e.stored_count(c);
    if (n < 4) return false;
    const auto k = 3 + pick(r, n - 3U);
    return flip_bit(e, r, c, pick(r, e.clusters()[c].vertex_count()), k, lowest_telling_bit(e, c, k));
  });
  always("vertex position, shared, above", [](Edit& e, Random& r) {
    const auto c = pick_cluster(e, r, false);
    const auto v = shared_vertices_where(e, c, false);
    return !v.empty() && flip_bit(e, r, c, v[pick(r, v.size())], pick(r, 3), 0);
  });
  mostly("vertex position, shared and on a rim, above",
         "a notch in a rim of the source that lost edges elsewhere: how deep it is only the deviation tells (I7)",
         [](Edit& e, Random& r) {
           const auto c = pick_cluster(e, r, false);
           const auto v = shared_vertices_where(e, c, true);
           return !v.empty() && flip_bit(e, r, c, v[pick(r, v.size())], pick(r, 3), 0);
         });
  mostly("vertex position, inside, above",
         "a vertex above level 0 that no neighbour shares is the simplifier's choice: only its deviation tells (I7)",
         [](Edit& e, Random& r) {
           const auto c = pick_cluster(e, r, false);
           const auto v = vertices_where(e, c, false);
           return !v.empty() && flip_bit(e, r, c, v[pick(r, v.size())], pick(r, 3), 0);
         });
  mostly("vertex attribute, above", "attributes above level 0 that no neighbour shares are the simplifier's choice",
         [](Edit& e, Random& r) {
           const auto c = pick_cluster(e, r, false);
           const auto n = e.stored_count(c);
           return n > 3 && flip_bit(e, r, c, pick(r, e.clusters()[c].vertex_count()), 3 + pick(r, n - 3U), 0);
         });
  always("triangle index, level 0", [](Edit& e, Random& r) { return change_index(e, r, pick_cluster(e, r, true)); });
  always("triangle turned, level 0", [](Edit& e, Random& r) { return turn_triangle(e, r, pick_cluster(e, r, true)); });
  mostly("triangle index, above",
         "beside a border of the source that was simplified, another shape of the border is valid",
         [](Edit& e, Random& r) { return change_index(e, r, pick_cluster(e, r, false)); });
  mostly("triangle turned, above",
         "beside a border of the source that was simplified, another shape of the border is valid",
         [](Edit& e, Random& r) { return turn_triangle(e, r, pick_cluster(e, r, false)); });
  always("material range counts", [=](Edit& e, Random& r) {
    const auto c = any_cluster(e, r);
    const auto at = e.layout(c);
    if (at.material_count == 0) return false;
    const std::uint32_t word = at.material_word + pick(r, at.material_count);
    return change_field(e, r, c, word, format::material_range::kTrianglesLess1);
  });
  always("material, level 0", [](Edit& e, Random& r) { return change_material(e, r, pick_cluster(e, r, true)); });
  mostly("material, above", "a triangle above level 0 may have any material of its group",
         [](Edit& e, Random& r) { return change_material(e, r, pick_cluster(e, r, false)); });

  // the scene around
  always("instances", [](Edit& e, Random& r) {
    if (e.instances().empty()) return false;
    bool done = true;
    e.instance(pick(r, e.instances().size()), [&](auto& x) {
      switch (r.below(6)) {
        case 0: x.transform[r.below(12)] += r.between(0.01, 2.0); break;
        case 1:
          if ((x.flags & format::kInstanceSingular) != 0)
            done = false;
          else
            x.scale *= r.below(2) == 0 ? shrink(r) : grow(r);
          break;
        case 2: nudge(x.mesh, r); break;
        case 3: nudge(x.node, r); break;
        case 4: x.flags ^= 1U << r.below(32); break;
        default: x.reserved = 1; break;
      }
    });
    return done;
  });
  always("materials", [](Edit& e, Random& r) {
    e.material(pick(r, e.materials().size()), [&](auto& x) {
      switch (r.below(7)) {
        case 0:
          x.base_color[r.below(4)] *= 0.5F;
          x.base_color[3] += 0.125F;
          break;
        case 1: x.alpha_cutoff += 0.125F; break;
        case 2: x.double_sided ^= 1U; break;
        case 3: x.source_index ^= 1U << r.below(31); break;
        case 4:
          x.alpha_mode = static_cast<format::AlphaMode>((static_cast<std::uint32_t>(x.alpha_mode) + 1) % 3);
          break;
        case 5: x.base_color_texture ^= 1U << r.below(31); break;
        default: x.base_color_uv_set ^= 1U << r.below(31); break;
      }
    });
    return true;
  });
  always("blobs", [](Edit& e, Random& r) {
    if (e.blobs().empty()) return false;
    const auto b = pick(r, e.blobs().size());
    if (r.below(2) == 0) {
      e.bytes()[e.blobs()[b].offset + r.below(e.blobs()[b].bytes)] ^= static_cast<std::uint8_t>(1U << r.below(8));
      return true;
    }
    e.blob(b, [&](auto& x) {
      switch (r.below(4)) {
        case 0: nudge(x.offset, r); break;
        case 1: nudge(x.bytes, r); break;
        case 2: x.kind = static_cast<format::BlobKind>(3 - static_cast<std::uint32_t>(x.kind)); break;
        default: nudge(x.source_index, r); break;
      }
    });
    return true;
  });
  always("names", [](Edit& e, Random& r) { return change_text(e, r, SectionId::kStrings); });
  always("scene text", [](Edit& e, Random& r) { return change_text(e, r, SectionId::kScene); });
  mostly("META text", "what META tells of the making besides the source's hash is not in the geometry",
         [](Edit& e, Random& r) { return change_text(e, r, SectionId::kMeta); });
  return kinds;
}

}  // namespace

const std::vector<MutantKind>& mutant_kinds() {
  static const std::vector<MutantKind> kinds = make_kinds();
  return kinds;
}

}  // namespace meshlode::test
