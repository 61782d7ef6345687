// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts held against their source by id pictures, from one camera after the other: what V211 is decided by.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/projection.h"
#include "draw/raster/raster.h"
#include "judge/pictures/id_distance.h"
#include "judge/pictures/id_picture.h"
#include "judge/pictures/source_picture.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::judge {

/// The source from one camera.
struct SourceIds {
  draw::Projection projection;
  IdPicture ids;
  IdPicture finer;  ///< of the same camera with more pixels; empty until something narrow has to be seen
  /// What is drawn only where it is asked for: depths of both sides of all triangles, and of one surface by itself.
  std::vector<std::uint32_t> both_sides;
  std::map<std::uint64_t, std::vector<std::uint32_t>> of_surface;
};

class IdJudge {
 public:
  /// `masks`: load_alpha_masks() of the asset. \pre all outlive this
  IdJudge(const run::Asset& asset, std::span<const SourceSurface> source, const draw::AlphaMasks& masks)
      : asset_(asset), source_(source), masks_(masks), painter_(asset) {}

  /// Errors: kUsage for a camera that cannot be drawn from.
  [[nodiscard]] Result<SourceIds> draw_source_ids(const run::Camera& camera) const;
  /// Not judged are pixels behind a back that is not drawn, of the cut or of the source: an open surface from behind.
  /// How far that shows through hangs on how triangles face, which no error bounds.
  /// Where the source has both surfaces in one place either is seen there: nothing says which is in front.
  /// `drawn`: the picture of `cut`, which was chosen by `pixel_error`, by the CPU or a GPU. \pre `truth` is of `camera`
  [[nodiscard]] Result<IdDistance> judge_cut(SourceIds& truth, const run::Camera& camera,
                                             std::span<const run::ClusterInstance> cut,
                                             const draw::VisibilityBuffer& drawn, double pixel_error) const;

 private:
  [[nodiscard]] const std::vector<std::uint32_t>& depths_of(SourceIds& truth, std::uint64_t id) const;
  /// Where the source has what both pictures show, either shows both. Whether there is such a pixel.
  [[nodiscard]] bool add_surfaces_in_one_place(std::span<const AstrayPixel> astray, SourceIds& truth,
                                               IdPicture& cut) const;
  [[nodiscard]] bool has_both_in_one_place(SourceIds& truth, const IdPicture& cut, std::uint32_t pixel) const;

  /// Errors: as judge_cut().
  [[nodiscard]] Status look_closer(SourceIds& truth, const run::Camera& camera,
                                   std::span<const run::ClusterInstance> cut, const IdPicture& ids,
                                   const AllowedPixels& allowed, std::vector<AstrayPixel>& astray) const;

  const run::Asset& asset_;
  std::span<const SourceSurface> source_;
  const draw::AlphaMasks& masks_;
  IdPainter painter_;
};

/// Of a picture's pixels so many may be astray, and no fewer than so many are a finding. Of what data/ and the models
/// of the tests lose by the default build, the most that nobody would call lost is 0.84% (buckles and edges of
/// FlightHelmet at 8 pixels of 400), and the least that everybody would is 1.8% (its plaque). A patch of 8 by 8 pixels
/// is seen as one; a picture that a scene hardly covers has fewer.
constexpr double kMostAstray = 0.01;
constexpr std::uint64_t kSmallestPatch = 64;

[[nodiscard]] inline bool is_beyond_limit(const IdDistance& distance) {
  return distance.share() > kMostAstray && distance.astray >= kSmallestPatch;
}

/// Many pictures together.
struct IdTotals {
  std::uint64_t pictures = 0, beyond_limit = 0;
  IdDistance all;             ///< of all
  IdDistance worst;           ///< of the picture with the largest share
  std::string worst_picture;  ///< its name; empty where no pixel is astray

  void add(const std::string& picture, const IdDistance& distance);
};

/// "0.023% of pixels show another surface than the source, none farther than 88.0 px; at worst …"
[[nodiscard]] std::string describe(const IdTotals& totals);

}  // namespace meshlode::judge
