// SPDX-License-Identifier: GPL-3.0-or-later
// Samples: the project's own scenes and hard cases, made from nothing. Bytes are the same with every compiler: only
// + - * / sqrt and floor are used (lab/samples/noise.h has the turns, base/random.h the random numbers).
//
// Shapes are counter-clockwise seen from outside. Where nothing else is said they have positions and indices only, and
// vertices are shared (a closed shape is closed by index as well as by position).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace meshlode::lab {

// -------------------------------------------------------------------------------------------- shapes of any resolution

/// A closed sphere: a cube of `n` x `n` cells a face, projected. 12·n² triangles, 6·n² + 2 vertices. \pre n >= 1
[[nodiscard]] scene::Primitive make_sphere(std::uint32_t n, double radius = 1.0);
/// A closed cube of `n` x `n` cells a face, from -half to +half. 12·n² triangles. \pre n >= 1
[[nodiscard]] scene::Primitive make_cube(std::uint32_t n, double half = 1.0);
/// A closed torus around the y axis. 2·major·minor triangles. \pre major, minor >= 3
[[nodiscard]] scene::Primitive make_torus(std::uint32_t major, std::uint32_t minor, double radius = 1.0,
                                          double tube = 0.35);
/// A flat square in the xz plane, facing +y, from -half to +half. 2·n² triangles. \pre n >= 1
[[nodiscard]] scene::Primitive make_plane(std::uint32_t n, double half = 1.0);

// ---------------------------------------------------------------------------------------------------------- hard cases

/// `count` closed boxes of random size and place that share nothing. 12 triangles each.
[[nodiscard]] scene::Primitive make_box_soup(std::uint32_t count, std::uint64_t seed = 1);
/// `count` pieces of one to three triangles that share nothing.
[[nodiscard]] scene::Primitive make_loose_pieces(std::uint32_t count, std::uint64_t seed = 1);
/// A closed blade, 2 x 1 and `thickness` thin, of `n` cells along each side of its two faces. \pre n >= 1
[[nodiscard]] scene::Primitive make_blade(std::uint32_t n, double thickness = 1e-4);
/// Three sheets of `n` x `n` cells that share one border edge line. \pre n >= 1
[[nodiscard]] scene::Primitive make_three_sheets(std::uint32_t n);
/// Two cones that touch in one vertex, their tip. \pre segments >= 3
[[nodiscard]] scene::Primitive make_double_cone(std::uint32_t segments);
/// A strip of `count` triangles that are `aspect` times as long as wide. \pre count >= 1
[[nodiscard]] scene::Primitive make_slivers(std::uint32_t count, double aspect = 1e5);
/// A sphere in which every third triangle is there twice, the second time with its corners rotated.
[[nodiscard]] scene::Primitive make_duplicates(std::uint32_t n);
/// A sphere with one zero-area triangle for every tenth triangle: repeated corners, equal positions and collinear ones.
[[nodiscard]] scene::Primitive make_zero_areas(std::uint32_t n);
/// A Moebius strip: not orientable, one border. \pre n >= 3, m >= 1
[[nodiscard]] scene::Primitive make_moebius(std::uint32_t n, std::uint32_t m);
/// A plane of `n` x `n` cells 1 wide, with bumps of 1e-3, a million units away from the origin on every axis.
[[nodiscard]] scene::Primitive make_far_plane(std::uint32_t n);
/// The same shape with every position multiplied.
[[nodiscard]] scene::Primitive scaled(scene::Primitive shape, double factor);
/// The same shape with a vertex of its own for every corner and the triangle's normal in it: every edge is a crease.
[[nodiscard]] scene::Primitive with_split_normals(const scene::Primitive& shape);
/// The same shape with area-weighted vertex normals. \pre vertices are shared where the surface is smooth
[[nodiscard]] scene::Primitive with_smooth_normals(scene::Primitive shape);
/// One mesh of one primitive.
[[nodiscard]] scene::SourceMesh as_mesh(scene::Primitive shape, std::string name = "sample");
/// A scene of one mesh, one instance and the default material: what import would hand on.
[[nodiscard]] scene::Scene as_scene(scene::SourceMesh mesh);

// --------------------------------------------------------------------------------------------- the surfaces of data/

/// A closed displaced sphere with smooth normals and six UV charts, so that every cube edge is a seam. 12·n² triangles.
[[nodiscard]] scene::Primitive make_rock(std::uint32_t n, std::uint64_t seed = 7);
/// An open height field of `columns` x `rows` cells in the xz plane with normals and UVs. 2·columns·rows triangles.
[[nodiscard]] scene::Primitive make_terrain(std::uint32_t columns, std::uint32_t rows, std::uint64_t seed = 11);
/// Closed six-sided crystals through one centre; every facet has its own normals. `n` cells along each short edge.
[[nodiscard]] scene::Primitive make_crystal(std::uint32_t crystals, std::uint32_t n, std::uint64_t seed = 3);
/// `count` loose quads, leaf cards, with normals and UVs.
[[nodiscard]] scene::Primitive make_foliage(std::uint32_t count, std::uint64_t seed = 5);

// ------------------------------------------------------------------------------------------- what is seen as a whole

/// The crown of a tree: `count` loose leaf cards with normals and UVs, some 2 wide.
[[nodiscard]] scene::Primitive make_crown(std::uint32_t count, std::uint64_t seed = 21);
/// A field of 2 x 2 with `blades` loose upright quads.
[[nodiscard]] scene::Primitive make_grass(std::uint32_t blades, std::uint64_t seed = 22);

/// Other kinds: "hedge", "ivy" along a wall, "pads" on a pond, "clumps", a "conifer" of slender needles, "blades" and
/// "splinters" of a triangle each, and a "fence" of cards that stand.
[[nodiscard]] std::vector<std::string> aggregate_kinds();
/// `count` loose pieces of one of these.
[[nodiscard]] scene::Primitive make_aggregate_kind(const std::string& kind, std::uint32_t count,
                                                   std::uint64_t seed = 23);

// ---------------------------------------------------------------------------------------------------- what is painted

/// The wood of a tree, a trunk and its limbs: open tubes of rough bark with normals and UVs, a seam along each.
/// `around` cells around the trunk and half as many around a limb. \pre around >= 6
[[nodiscard]] scene::Primitive make_tree_wood(std::uint32_t around, std::uint64_t seed = 31);
/// `count` leaf cards around the ends of the same limbs, with normals and UVs.
[[nodiscard]] scene::Primitive make_tree_leaves(std::uint32_t count, std::uint64_t seed = 31);

// --------------------------------------------------------------------------------------------------- the files of
// data/

struct SampleFile {
  std::string name;                 ///< for example "rock.glb"
  std::vector<std::uint8_t> bytes;  ///< a GLB
};

/// Scenes for benchmarks of aggregates: "tree" (40,000 masked leaf cards), "grass" (20,000 opaque blades), "soup"
/// (20,000 opaque boxes) and 10,000 opaque pieces of each of aggregate_kinds().
[[nodiscard]] std::vector<std::string> aggregate_names();
/// \pre one of aggregate_names()
[[nodiscard]] SampleFile make_aggregate_file(const std::string& name);

/// "painted-tree.glb", a scene for measurements of what is painted: bark and masked leaves in one mesh.
/// As make_tree_wood() and make_tree_leaves().
[[nodiscard]] SampleFile make_painted_tree_file(std::uint32_t around = 48, std::uint32_t leaves = 2400);

/// Kinds of scenes whose layers lie closely above one another: "plate" in a recess, "decal", "shells" in each other,
/// "cloth" over a body, "coins" in a tray, "facade" with inset windows, "leaves" over a branch.
[[nodiscard]] std::vector<std::string> layered_kinds();
/// One of them, a mesh and a material for each layer, the deepest first. Some 10,000 triangles with `cells` 48; they
/// grow with its square. \pre one of layered_kinds(), cells >= 16
[[nodiscard]] SampleFile make_layered_file(const std::string& kind, std::uint64_t seed = 1, std::uint32_t cells = 48);

/// The names of data/, in order.
[[nodiscard]] std::vector<std::string> sample_names();
/// The bytes of one of them. \pre name is one of sample_names()
[[nodiscard]] SampleFile make_sample_file(const std::string& name);
/// A terrain of about `triangles` triangles, for benchmarks. \pre 2 <= triangles <= 100,000,000
[[nodiscard]] SampleFile make_terrain_file(std::uint64_t triangles);

}  // namespace meshlode::lab
