// SPDX-License-Identifier: GPL-3.0-or-later
// What is streamed: the tables of several assets as one set of tables, placed in one world. Pages keep nothing but
// their sizes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "base/box.h"
#include "base/vec.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::app {

/// An asset with all of its instances, turned about the y axis, scaled and moved.
struct Placement {
  std::uint32_t asset = 0;
  Vec3d position{0.0};
  double yaw_degrees = 0.0;
  double scale = 1.0;  ///< above 0
};

/// Lines `asset x y z yaw scale`: a name, and numbers between spaces. Empty lines and what follows # are left out.
/// `names`: of the assets, as the command line has them; a file name alone will do where only one asset has it.
/// `where` names the text in errors, with the line: kInvalid for what is no such line, an asset that is not there, and
/// for more than kMostInstances lines.
[[nodiscard]] Result<std::vector<Placement>> parse_placements(std::string_view text, const std::string& where,
                                                              std::span<const std::string> names);

/// A picture of 1080 rows shows fewer objects apart, and a selection of more takes seconds per frame.
constexpr std::uint32_t kMostInstances = 65536;
/// Of all instances together: a cut without culling may have as many entries, of 8 bytes each.
constexpr std::uint64_t kMostPlacedClusters = std::uint64_t{1} << 27U;

struct StreamPage {
  std::uint32_t bytes = 0;         ///< decoded: what it takes in a pool
  std::uint32_t stored_bytes = 0;  ///< what is loaded
};

struct StreamScene {
  std::vector<format::MeshRecord> meshes;
  std::vector<format::InstanceRecord> instances;
  std::vector<format::GroupRecord> groups;
  std::vector<format::ClusterRecord> clusters;
  std::vector<format::NodeRecord> nodes;
  std::vector<StreamPage> pages;
  std::vector<std::uint32_t> first_mesh_of_file;  ///< of each asset
  std::vector<std::uint32_t> cluster_bytes;       ///< decoded, of each cluster in its page
  Box3d box;                                      ///< of what is drawn
  double object_radius = 1.0;                     ///< half the diagonal of the largest instance

  [[nodiscard]] run::SelectTables tables() const { return {meshes, instances, groups, clusters, nodes}; }
  [[nodiscard]] std::uint64_t page_bytes() const;    ///< of all pages, decoded
  [[nodiscard]] std::uint64_t stored_bytes() const;  ///< of all pages
};

/// Loads each page once, for the sizes of its clusters. Errors: those of load_page(), with the asset's name in front;
/// kUnsupported where the tables together have more records than ids, or the scene more than kMostInstances instances
/// or kMostPlacedClusters clusters; kInvalid where nothing is drawn. \param names  of the assets
[[nodiscard]] Result<StreamScene> make_stream_scene(std::span<const run::Asset> assets,
                                                    std::span<const std::string> names,
                                                    std::span<const Placement> placements);

}  // namespace meshlode::app
