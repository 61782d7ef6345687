// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the groups of one level after another, fine to coarse, against what is there once they are replaced
// (LevelSurface), both ways:
//   1. ask_units, ask_vertices: the vertices of the source are asked for the surface, new vertices of the surface for
//      the source,
//   2. check_units: source triangles that pass from one triangle of the surface to another are laid over it (Overlay),
//   3. check_made: so are triangles of the surface over the source, where it is not parallel, ends or leaps, or is
//      not seen;
//      after each of 2 and 3 finish_searches: a search that has not ended goes on where it may be farther than what is
//      known by then,
//   4. wait_for_others: what a group stood for and is now near to another's part is held to cuts without that part.
// Whatever is farther than what is known of a group so far is its new known distance; what is nearer is dismissed as
// early as a bound allows.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "base/box.h"
#include "builder/deviation/bounded_search.h"
#include "builder/deviation/source_tree.h"
#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/measure/group_attributes.h"
#include "builder/measure/level_surface.h"
#include "builder/measure/overlay.h"
#include "builder/measure/source_units.h"
#include "builder/prepared.h"

namespace meshlode::builder {

class LevelMeter {
 public:
  /// `source` is the tree over the mesh's exact triangles; `form` is the DAG's, whose triangles are in its order. What
  /// it is given must outlive it, but for level0_of_source, which is freed. What searches have not ended in so many
  /// rounds counts by its bound. `least`: of measure_levels().
  LevelMeter(const PreparedMesh& mesh, SourceTree source, CanonicalForm& form, double margin, std::size_t rounds,
             std::span<const double> least, LodDag& dag);

  /// All groups of a level; finer ones are measured.
  void measure_level(std::uint32_t first_group, std::uint32_t end_group);

 private:
  /// Of a group, while its level is measured. Object units.
  struct Known {
    double floor = 0.0;  ///< its error is no less
    double found = 0.0;  ///< the largest distance
    double known = 0.0;  ///< no smaller one matters
    double open = 0.0;   ///< what searches left in the end is no farther; 0: they left nothing
  };
  struct Raise {
    std::uint32_t group;
    double distance;
  };
  /// A unit of the source, and the groups of the level that stand for it.
  struct OwnedUnit {
    std::uint32_t unit = 0;
    std::uint32_t first_owner = 0, owner_count = 0;  ///< into owners_
  };
  /// What a vertex of a unit is near to.
  struct NearVertex {
    std::uint32_t triangle;  ///< of the surface
    float distance;
  };
  /// A vertex or a triangle of the source that a group stood for, and that is now near to what another one made.
  struct Moved {
    std::uint32_t group, to;
    std::uint32_t id;
    bool is_triangle;
    double distance = 0.0;  ///< from what is there where the other group is not replaced
    [[nodiscard]] bool operator<(const Moved& other) const {
      return std::tie(group, is_triangle, id, to) < std::tie(other.group, other.is_triangle, other.id, other.to);
    }
  };
  /// A search that did not end by the parts that it had at first.
  struct Left {
    BoundedSearch search;
    std::uint32_t group;
    const OwnedUnit* shared = nullptr;  ///< what it looks at, where that is of several groups
    std::vector<Raise> raised;
  };
  /// Units of one group that one turn looks after.
  struct UnitChunk {
    std::uint32_t group = 0;
    std::span<const OwnedUnit> units;
    std::vector<std::uint32_t> first_near;  ///< per unit: into near; kNoId: all of it is near to one triangle
    std::vector<std::uint32_t> near_all;    ///< per unit: to this one
    std::vector<NearVertex> near;
    std::vector<Raise> raised;
    std::vector<Left> left;
    std::vector<Moved> moved;
    std::vector<Moved> searched;  ///< a search does not say to what; not farther than this from what the overlay says
  };
  /// A cluster that a group made.
  struct Made {
    std::uint32_t group = 0, cluster = 0;
    std::uint32_t first_triangle = 0, triangle_count = 0;  ///< of the surface
    std::vector<TreeSlot> near;                            ///< per triangle: of the source
    std::vector<Raise> raised;
    std::vector<Left> left;
  };
  /// What one group made of the surface.
  struct PartBox {
    std::uint32_t group;
    Box3d box;
  };
  class Owners;

  // level_meter.cpp
  void find_new_vertices();
  /// Late, where the first level's surface, the largest, is no longer searched: memory is least where both are not.
  void link_source();
  void begin_level(std::uint32_t first_group, std::uint32_t end_group);
  [[nodiscard]] std::vector<UnitChunk> chunk_units() const;
  [[nodiscard]] std::vector<Made> made_clusters(const LevelSurface& surface) const;
  template <class Item>
  void merge(std::vector<Item>& items);
  template <class Item>
  void finish_searches(std::vector<Item>& items);
  /// Tells it what is known by now. False: it is done.
  [[nodiscard]] bool is_open(Left& left) const;
  /// Returns the parts that it made.
  std::size_t go_on(Left& left) const;
  void finish_groups(std::span<const Made> made);
  void hand_on(const LevelSurface& surface, std::span<const UnitChunk> chunks);

  // over_surface.cpp: the source against the surface
  void ask_units(const LevelSurface& surface, UnitChunk& chunk) const;
  void check_units(const LevelSurface& surface, UnitChunk& chunk);
  [[nodiscard]] GroupId owner_of(const SourceUnits::Unit& unit, const SourceUnits::Triangle& triangle) const;
  [[nodiscard]] static bool has_common_corner(const LevelSurface& surface, std::uint32_t a, std::uint32_t b);
  void mark_seen(const LevelSurface& surface, std::uint32_t triangle, const Vec3f& normal, bool is_end);
  [[nodiscard]] bool is_flat(const LevelSurface& surface, const TriangleCorners& corners, const Vec3f& normal,
                             const std::array<std::uint32_t, 3>& near, double within) const;

  // over_source.cpp: the surface against the source
  void ask_vertices(Made& made) const;
  void check_made(const LevelSurface& surface, Made& made) const;

  // moved.cpp
  void list_moved(const LevelSurface& surface, const OwnedUnit& unit, const NearVertex* near, std::uint32_t near_all,
                  UnitChunk& chunk) const;
  [[nodiscard]] double distance_from(const SurfaceTree& tree, const Moved& m, double enough, bool is_all) const;
  void measure_from_own(const LevelSurface& surface, std::span<Moved> moved) const;
  void measure_from_both(const LevelSurface& surface, std::span<Moved> moved) const;
  void measure_all_moved(const LevelSurface& surface, std::span<Moved> moved) const;
  [[nodiscard]] std::vector<PartBox> part_boxes(const LevelSurface& surface) const;
  [[nodiscard]] std::vector<Moved> list_searched(const LevelSurface& surface, std::span<UnitChunk> chunks) const;
  void raise_by(std::span<const Moved> moved);
  void wait_for_others(const LevelSurface& surface, std::span<UnitChunk> chunks);

  [[nodiscard]] bool is_of_level(std::uint32_t group) const { return group >= first_ && group < end_; }
  [[nodiscard]] Known& known(std::uint32_t group) { return known_[group - first_]; }
  [[nodiscard]] const Known& known(std::uint32_t group) const { return known_[group - first_]; }
  /// What is no farther does not raise a group's error.
  [[nodiscard]] double enough(std::uint32_t group) const { return dag_.groups[group].error / margin_; }
  /// The group that made a triangle of the surface; invalid for level 0.
  [[nodiscard]] GroupId maker(const LevelSurface& surface, std::uint32_t triangle) const {
    return dag_.clusters[surface.cluster[triangle]].own_group;
  }

  [[nodiscard]] std::span<const std::uint32_t> owners_of(const OwnedUnit& unit) const {
    return std::span(owners_).subspan(unit.first_owner, unit.owner_count);
  }
  /// Which of the groups made a triangle of the surface; their number: none of them.
  [[nodiscard]] std::size_t part_of(std::span<const std::uint32_t> groups, const LevelSurface& surface,
                                    std::uint32_t triangle) const {
    const GroupId made = maker(surface, triangle);
    const auto at = made.is_valid() ? std::find(groups.begin(), groups.end(), made.value) : groups.end();
    return static_cast<std::size_t>(at - groups.begin());
  }

  const PreparedMesh& mesh_;
  double margin_;
  std::size_t rounds_;
  std::span<const double> least_;
  const CanonicalForm& form_;
  LodDag& dag_;
  SourceTree source_;
  GroupAttributes attributes_;
  SourceUnits units_;
  std::vector<LinkedSurface::Triangle> source_neighbor_;  ///< of link_source()
  std::vector<Vec3f> source_normal_;                      ///< likewise
  std::vector<std::vector<std::uint32_t>> outputs_;       ///< per group: the clusters that it made
  std::vector<std::uint8_t> is_new_;                      ///< per vertex of the DAG: no finer cluster has it
  std::vector<std::uint32_t> owner_;                      ///< per vertex of a unit: the cluster that stands for it
  std::vector<std::vector<std::uint32_t>> units_of_;      ///< per cluster: the units with a vertex that it stands for

  std::uint32_t first_ = 0, end_ = 0;          ///< the level's groups
  std::vector<Known> known_;                   ///< per group of the level
  std::vector<std::vector<OwnedUnit>> owned_;  ///< likewise; a unit of several groups is the first one's
  std::vector<std::uint32_t> owners_;
  std::vector<std::atomic<std::uint8_t>> seen_;  ///< per triangle of the surface: flags
};

/// Groups that a point of a unit may belong to, and what is known of them: before, and by what a chunk raised.
class LevelMeter::Owners {
 public:
  Owners(const LevelMeter& meter, const OwnedUnit& unit, std::vector<Raise>& raised)
      : meter_(meter), groups_(meter.owners_of(unit)), raised_(raised), known_(least_known()) {}

  [[nodiscard]] bool is_one() const { return groups_.size() == 1; }
  /// What all of them are known to be off by.
  [[nodiscard]] double known() const { return known_; }
  /// What each of them is, and at last, for what none of them made, known().
  [[nodiscard]] std::vector<double> known_of_each() const {
    std::vector<double> all;
    for (const std::uint32_t g : groups_) all.push_back(known_of(g));
    all.push_back(known_);
    return all;
  }
  /// A point is so far: if that is farther than what is known, which of them made what is nearest to it answers, else
  /// all.
  void raise(const LevelSurface& surface, double distance, std::uint32_t nearest) {
    if (distance > known_) raise(meter_.part_of(groups_, surface, nearest), distance);
  }
  void raise(std::size_t part, double distance) {
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      if (part < groups_.size() && part != i) continue;
      const auto raise = find(groups_[i]);
      if (raise == raised_.end()) {
        raised_.push_back({groups_[i], distance});
      } else {
        raise->distance = std::max(raise->distance, distance);
      }
    }
    known_ = least_known();
  }
  /// By what a search found of each.
  void raise(const BoundedSearch& search) {
    for (std::size_t part = 0; part <= groups_.size(); ++part) {
      if (search.found_of(part) > 0.0) raise(part, search.found_of(part));
    }
  }

 private:
  [[nodiscard]] std::vector<Raise>::iterator find(std::uint32_t group) const {
    return std::find_if(raised_.begin(), raised_.end(), [group](const Raise& raise) { return raise.group == group; });
  }
  [[nodiscard]] double known_of(std::uint32_t group) const {
    const auto raise = find(group);
    const double known = meter_.known(group).known;
    return raise == raised_.end() ? known : std::max(known, raise->distance);
  }
  [[nodiscard]] double least_known() const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t g : groups_) least = std::min(least, known_of(g));
    return least;
  }

  const LevelMeter& meter_;
  std::span<const std::uint32_t> groups_;
  std::vector<Raise>& raised_;
  double known_;
};

/// What a triangle of the surface is known to have over it: source that is about parallel; and source that is not, ends
/// there, or leaps, with corners near to triangles that do not touch. Where it leaps between two sheets, neither has
/// source over all of it: a cut of random scene 1343127 (--layers) is at 1.19 of its error by the first alone.
constexpr std::uint8_t kSeen = 1, kOpen = 2;
/// Within this cosine two surfaces are about parallel. 0.9 misses 5% of one group of the dragon's 711, 0.8 misses 10%.
constexpr float kParallel = 0.95F;
/// Searches go on to what is farther by this at least.
constexpr double kTolerance = 1.002;
/// Parts that a search may make at first, for each triangle that needs one: most of them are ended by what others find.
/// With 16, 64 and 256 random scene 940027 takes 9, 20 and 55 s to build for 6.4, and with 1 the dragon has other
/// errors.
constexpr std::size_t kPartsPerTriangle = 4;

}  // namespace meshlode::builder
