// SPDX-License-Identifier: MIT
/// \file
/// The bytes of a .lode asset, versions 1 and 2. docs/reference/format.md is the normative text; this header is the
/// same thing as structs.
///
/// Everything is little-endian. Every struct here is copied as it lies in the file: sizes are asserted, there is no
/// implicit padding, and reserved fields are written as zero and ignored on reading.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(__GNUC__) && !defined(__clang__)  // GCC warns although scoped enumerators shadow nothing
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#endif

namespace meshlode::format {

/// Four characters as the bytes of a little-endian word.
constexpr std::uint32_t four_cc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24;
}

constexpr std::uint32_t kMagic = four_cc('L', 'O', 'D', 'E');  ///< the first four bytes of a file
constexpr std::uint32_t kVersion = 2;         ///< the newest: of an asset that has a group flagged kGroupAggregate
constexpr std::uint32_t kPlainVersion = 1;    ///< of every other asset
constexpr std::uint32_t kNone = 0xFFFFFFFFu;  ///< "no such id"

/// A root's coarser error: it never passes. Written as null in JSON.
constexpr float kInfiniteError = std::numeric_limits<float>::max();

constexpr std::uint32_t kMaxClusterTriangles = 256;  ///< hard cap of the format (I2); the default build uses 128
constexpr std::uint32_t kMaxClusterVertices = 256;   ///< hard cap of the format (I2)
constexpr std::uint32_t kMaxPageBytes = 128 * 1024;  ///< decoded bytes of a page at most
constexpr std::uint32_t kMaxUvSets = 4;              ///< UV sets that a mesh stores at most
constexpr std::uint32_t kBvhWidth = 8;               ///< children of a BVH node at most
constexpr std::uint32_t kSectionAlignment = 16;      ///< file offsets of sections and pages are multiples of this

// ---------------------------------------------------------------------------------------------------------------- file

/// The start of a file.
struct FileHeader {
  std::uint32_t magic;                 ///< kMagic
  std::uint32_t version;               ///< kPlainVersion or kVersion
  std::uint32_t header_bytes;          ///< sizeof(FileHeader); a later version may be longer
  std::uint32_t section_count;         ///< entries of the section table
  std::uint64_t file_bytes;            ///< size of the whole file
  std::uint64_t section_table_offset;  ///< from the start of the file
  std::uint8_t content_hash[16];       ///< XXH3-128 over the decoded content, see docs/reference/format.md
  std::uint32_t section_entry_bytes;   ///< stride of the section table
  std::uint32_t flags;                 ///< zero
  std::uint64_t header_checksum;       ///< XXH3-64 of the header with this field zero, then of the section table
};
static_assert(sizeof(FileHeader) == 64);

/// Section ids. A reader skips ids it does not know unless kSectionRequired is set.
enum class SectionId : std::uint32_t {
  kMeta = four_cc('M', 'E', 'T', 'A'),           ///< JSON text: source, settings, plan, drops (UTF-8, no terminator)
  kScene = four_cc('S', 'C', 'N', 'E'),          ///< JSON text: the glTF scene graph, materials, textures as they were
  kStrings = four_cc('S', 'T', 'R', 'S'),        ///< UTF-8 bytes that StringRef points into
  kMeshes = four_cc('M', 'E', 'S', 'H'),         ///< MeshRecord[]
  kMaterials = four_cc('M', 'A', 'T', 'L'),      ///< MaterialRecord[]
  kInstances = four_cc('I', 'N', 'S', 'T'),      ///< InstanceRecord[]
  kGroups = four_cc('G', 'R', 'U', 'P'),         ///< GroupRecord[]
  kClusters = four_cc('C', 'L', 'U', 'S'),       ///< ClusterRecord[]
  kNodes = four_cc('N', 'O', 'D', 'E'),          ///< NodeRecord[]
  kPages = four_cc('P', 'A', 'G', 'T'),          ///< PageRecord[]
  kPageDeps = four_cc('P', 'D', 'E', 'P'),       ///< u32[]: page ids
  kPageData = four_cc('P', 'A', 'G', 'E'),       ///< the pages' stored bytes
  kBlobs = four_cc('B', 'L', 'B', 'T'),          ///< BlobRecord[]
  kPromises = four_cc('P', 'R', 'M', 'S'),       ///< PromiseMeshRecord[]; optional, not required
  kPromiseErrors = four_cc('P', 'R', 'M', 'G'),  ///< PromiseGroupRecord[]; there exactly where kPromises is
  kPageHints = four_cc('P', 'H', 'N', 'T'),      ///< PageHintRecord[]; optional, not required
  kBlobData = four_cc('B', 'L', 'O', 'B'),       ///< images and animation data as they were
};

constexpr std::uint32_t kSectionRequired = 1u;  ///< SectionEntry::flags: a reader that does not know the id must refuse

/// Where a section lies, and how it is stored.
struct SectionEntry {
  std::uint32_t id;       ///< SectionId
  std::uint32_t version;  ///< of this section's layout; 0
  std::uint32_t flags;    ///< kSectionRequired
  std::uint32_t codec;    ///< of the section: 0 as it is, 1 by columns (docs/reference/codecs.md); pages have their own
  std::uint64_t offset;   ///< from the start of the file, a multiple of kSectionAlignment
  std::uint64_t bytes;    ///< stored
  std::uint64_t decoded_bytes;  ///< after the codec
  std::uint64_t checksum;       ///< XXH3-64 of the stored bytes; 0 for kPageData, whose pages carry their own
  std::uint32_t record_bytes;   ///< stride of a table; 0 for text and raw bytes
  std::uint32_t record_count;   ///< records of a table; 0 for text and raw bytes
  std::uint64_t reserved;       ///< zero
};
static_assert(sizeof(SectionEntry) == 64);

/// Disk codec of a page. Values are stable.
enum class Codec : std::uint32_t { kNone = 0, kLz4 = 1, kZstd = 2, kDraco = 3, kStrips = 4 };

/// A text in kStrings.
struct StringRef {
  std::uint32_t offset;  ///< into kStrings
  std::uint32_t bytes;   ///< length
};
static_assert(sizeof(StringRef) == 8);

// -------------------------------------------------------------------------------------------------------------- meshes

/// What stored errors mean: an estimate, measured, a proven upper bound.
enum class ErrorTier : std::uint32_t { kQem = 0, kMeasured = 1, kCertified = 2 };

/// Where a triangle's shading normals come from.
enum class NormalMode : std::uint32_t {
  kNone = 0,    ///< left out by option: a renderer may use the geometric normal
  kStored = 1,  ///< octahedral, per vertex
  kFlat = 2,    ///< the geometric normal of each triangle is the shading normal: nothing is stored
};

/// position_object = origin + step · q, with q a signed integer of at most 24 bits and step = mantissa · 2^log2.
struct Grid {
  std::int32_t log2;       ///< power of two of the step
  std::uint32_t mantissa;  ///< a small odd integer, 1 when the budget is free to choose
};
static_assert(sizeof(Grid) == 8);

/// Integers of a vertex, in this order, each attribute present or absent for the whole mesh:
///   position x y z · normal X Y Z · uv0 u v · … uv3 u v · colour r g b a
///   position  origin + step · (x, y, z)
///   normal    the direction of (X, Y, Z), an integer point of |X| + |Y| + |Z| = normal_scale
///   uv        2^uv_log2 · (u, v), below 2^24 in magnitude, so that a float holds it exactly
///   colour    c / 255, linear as in the source
/// A vertex that two clusters share has the same integers in both (I3).
struct MeshRecord {
  StringRef name;                    ///< as in the source
  double origin[3];                  ///< mesh space, object units
  Grid grid;                         ///< of the positions
  std::int32_t bounds_min[3];        ///< of level 0, grid units
  std::int32_t bounds_max[3];        ///< of level 0, grid units
  double diagonal;                   ///< of the source's bounding box, object units; relative errors are over it
  float level0_deviation;            ///< how far quantization alone moves the surface at most, object units
  ErrorTier error_tier;              ///< of all errors of the mesh
  NormalMode normal_mode;            ///< where shading normals come from
  std::uint32_t normal_scale;        ///< M, 1 … kMaxNormalScale where normals are stored, else 0; angle <= √2 / M
  std::uint32_t uv_set_count;        ///< stored UV sets
  std::uint32_t has_color;           ///< 0 or 1
  std::int32_t uv_log2[kMaxUvSets];  ///< step of each stored set; 0 from uv_set_count on
  std::uint8_t uv_set_source[kMaxUvSets];  ///< the TEXCOORD_n that stored set k was
  std::uint32_t material;                  ///< of every triangle; kNone: clusters hold material ranges
  std::int32_t sphere_log2;                ///< unit of the clusters' culling spheres: 2^sphere_log2 object units
  std::uint32_t level_count;               ///< levels, 0 the finest
  std::uint64_t source_triangles;          ///< after triangulation, before anything was dropped
  std::uint64_t source_vertices;           ///< before anything was dropped
  std::uint64_t dropped_degenerate;        ///< triangles without area that are not part of the source
  std::uint64_t dropped_duplicate;         ///< same positions, winding, stored attributes and material
  std::uint64_t dropped_repaired;          ///< by --repair: non-finite, out of range, degenerate, duplicate
  std::uint64_t grid_collapsed;            ///< triangles of level 0 that have zero area after quantization; they stay
  std::uint32_t first_group;               ///< groups of this mesh are contiguous, coarse to fine
  std::uint32_t group_count;               ///< groups of this mesh
  std::uint32_t first_cluster;             ///< clusters of this mesh are contiguous
  std::uint32_t cluster_count;             ///< clusters of this mesh
  std::uint32_t first_node;                ///< BVH nodes of this mesh are contiguous, the root is the first
  std::uint32_t node_count;                ///< nodes of this mesh
};
static_assert(sizeof(MeshRecord) == 200);

/// How the alpha of a material is used.
enum class AlphaMode : std::uint32_t { kOpaque = 0, kMask = 1, kBlend = 2 };

/// What a renderer needs at once; the whole material is in kScene under source_index.
struct MaterialRecord {
  StringRef name;                    ///< as in the source
  std::uint32_t source_index;        ///< index in the glTF's materials; kNone for the default material
  AlphaMode alpha_mode;              ///< how alpha is used
  float base_color[4];               ///< r g b a, linear
  float alpha_cutoff;                ///< for kMask
  std::uint32_t double_sided;        ///< 0 or 1
  std::uint32_t base_color_texture;  ///< glTF texture index; kNone without
  std::uint32_t base_color_uv_set;   ///< TEXCOORD_n; kNone without
};
static_assert(sizeof(MaterialRecord) == 48);

constexpr std::uint32_t kInstanceMirrored = 1u;  ///< determinant < 0: flip culling
constexpr std::uint32_t kInstanceSingular = 2u;  ///< singular or not finite: reported and not drawn

/// A mesh, drawn with a transform.
struct InstanceRecord {
  double transform[12];    ///< mesh space to world, row-major 3×4
  double scale;            ///< largest singular value of the 3×3 part, rounded up
  std::uint32_t mesh;      ///< into kMeshes
  std::uint32_t node;      ///< index of the glTF node
  std::uint32_t flags;     ///< kInstance…
  std::uint32_t reserved;  ///< zero
  StringRef name;          ///< of the node
};
static_assert(sizeof(InstanceRecord) == 128);

// ------------------------------------------------------------------------------------------------------- the LOD DAG

constexpr std::uint16_t kGroupTerminal =
    1u;                                    ///< nothing coarser replaces its members: they are roots, error is infinite
constexpr std::uint16_t kGroupStuck = 2u;  ///< terminal, and not because the top was reached
/// Never terminal. Its pieces (leaves, blades) are replaced by fewer ones that cover as much of a picture: `error` is
/// the pixel size from which on they do (docs/reference/format.md, "Aggregates"), not a distance between surfaces.
constexpr std::uint16_t kGroupAggregate = 4u;

/// Why a group could not be simplified further.
enum class StuckReason : std::uint16_t {
  kNotStuck = 0,
  kLocked = 1,      ///< too much of it is shared with other groups
  kFlips = 2,       ///< every collapse left would turn a triangle over
  kSeams = 3,       ///< attribute seams or material borders
  kComponents = 4,  ///< loose pieces that share no vertex
  kTooSmall = 5,    ///< nothing left to remove
  kTopology = 6,    ///< every collapse left would break the link condition
  kBorder = 7,      ///< it would not be stuck if the open borders of its mesh were not locked (build --lock-borders)
};

/// A set of neighbouring clusters (its members) that are replaced together by coarser clusters. To a member this is its
/// coarser group, to a replacement its own group: both read the same error and sphere.
struct GroupRecord {
  float center[3];  ///< LOD sphere, mesh space relative to MeshRecord::origin
  float radius;     ///< of the LOD sphere, object units
  float error;  ///< selection error, object units, growing along the DAG except from 0 to 0; kInfiniteError if terminal
  float quadric_error;     ///< the quadric's own estimate, object units, never falling along the DAG; kInfiniteError if
                           ///< terminal
  float deviation;         ///< two-sided distance of this group alone to the source, quantization included and without
                           ///< the margin that `error` has; kInfiniteError if terminal or not measured
  float normal_deviation;  ///< shading normals against the source's, RMS over a group in degrees, never falling along
                           ///< the DAG; kInfiniteError if terminal or not measured
  float uv_deviation;      ///< UVs against the source's, UV units, 95% of a group is within it; the same rules
  std::uint32_t first_cluster;  ///< members, contiguous
  std::uint32_t mesh;           ///< into kMeshes
  std::uint32_t page;           ///< that holds the members
  std::uint16_t cluster_count;  ///< at least 1
  std::uint16_t level;          ///< largest level of a member
  std::uint16_t flags;          ///< kGroup…
  StuckReason stuck_reason;     ///< kNotStuck unless kGroupStuck is set
};
static_assert(sizeof(GroupRecord) == 56);

/// A cluster (meshlet). Drawn if and only if its own group passes (or it has none) and its coarser group does not (I5).
struct ClusterRecord {
  std::int16_t center[3];    ///< culling sphere, units of 2^sphere_log2 of the mesh, relative to its origin
  std::uint16_t radius;      ///< of the culling sphere, same units
  std::int8_t cone_axis[3];  ///< axis of the normal cone, times 127
  /// All triangles face away from an eye that looks along the unit vector v (from the eye to the surface, mesh space)
  /// if dot(v, cone_axis / 127) >= cone_cutoff / 127; rounded up. 127: never cull. Not for double-sided materials.
  std::int8_t cone_cutoff;
  std::uint32_t own_group;        ///< the group it was made from; kNone at level 0
  std::uint32_t coarser_group;    ///< the group that replaces it: the group it is a member of
  std::uint8_t vertices_less_1;   ///< number of vertices, less 1; as in the page
  std::uint8_t triangles_less_1;  ///< number of triangles, less 1
  std::uint16_t level;            ///< 0 the source

  /// 1 to kMaxClusterVertices.
  [[nodiscard]] constexpr std::uint32_t vertex_count() const { return vertices_less_1 + 1U; }
  /// 1 to kMaxClusterTriangles.
  [[nodiscard]] constexpr std::uint32_t triangle_count() const { return triangles_less_1 + 1U; }
};
static_assert(sizeof(ClusterRecord) == 24);
constexpr std::int32_t kMinSphereLog2 = -126;  ///< 2^sphere_log2 and spheres in it are normal floats
constexpr std::int32_t kMaxSphereLog2 = 104;   ///< see kMinSphereLog2

/// BVH over the groups of a mesh. Sphere and error bound those of everything below, so a node that passes has nothing
/// to draw below it.
struct NodeRecord {
  float center[3];            ///< of its sphere, relative to MeshRecord::origin
  float radius;               ///< of its sphere, object units
  float error;                ///< largest group error below; kInfiniteError above a terminal group
  std::uint32_t first;        ///< first child node (children are contiguous), or the group id if child_count is 0
  std::uint32_t child_count;  ///< 0 = leaf
};
static_assert(sizeof(NodeRecord) == 28);

// ------------------------------------------------------------------------------------------------------------ promises

/// What a cut at t pixels promises to be within t pixels of: see docs/reference/selection.md, "What is promised".
enum class Promise : std::uint32_t {
  kPosition = 0,    ///< positions: GroupRecord::error
  kTexels = 1,      ///< positions and texture coordinates together
  kAppearance = 2,  ///< and shading normals
};

constexpr std::uint32_t kPromisesTexels = 1u;      ///< PromiseMeshRecord::promises: texel errors are there, always
constexpr std::uint32_t kPromisesAppearance = 2u;  ///< appearance errors too

/// A surface point is x = (p, uv_object[k] · uv_k for each stored set k, normal_object · n): all are object units, and
/// the distance of two points is Euclidean. texels leaves n out, position all but p.
struct PromiseMeshRecord {
  std::uint32_t promises;          ///< kPromises…, the same in all meshes
  float normal_object;             ///< object units of a unit normal; 0: normals are not part
  float uv_object[kMaxUvSets][2];  ///< object units of a UV unit, along u and along v; 0 both: the set is not part
  float level0_texels;             ///< how far quantization alone moves the surface so at most, object units
  float level0_appearance;         ///< the same; 0 without kPromisesAppearance
};
static_assert(sizeof(PromiseMeshRecord) == 48);

/// Per group, what takes the place of GroupRecord::error: the same rules, and never below it.
struct PromiseGroupRecord {
  float texel_error;       ///< object units
  float appearance_error;  ///< object units, never below texel_error; 0 without kPromisesAppearance
};
static_assert(sizeof(PromiseGroupRecord) == 8);

// --------------------------------------------------------------------------------------------------------------- pages

/// A page of kPageData: the unit of loading.
struct PageRecord {
  std::uint64_t offset;         ///< from the start of the file
  std::uint32_t stored_bytes;   ///< in the file
  std::uint32_t bytes;          ///< decoded, at most kMaxPageBytes
  Codec codec;                  ///< of the stored bytes
  std::uint32_t first_group;    ///< pages hold whole groups, contiguous
  std::uint32_t group_count;    ///< groups of this page
  std::uint32_t first_cluster;  ///< clusters of a page are contiguous
  std::uint32_t cluster_count;  ///< clusters of this page
  std::uint32_t
      first_dependency;  ///< into kPageDeps: pages that hold the coarser clusters made from this page's groups
  std::uint32_t dependency_count;  ///< pages that it depends on
  std::uint32_t reserved;          ///< zero
  std::uint64_t checksum;          ///< XXH3-64 of the stored bytes
  std::uint64_t decoded_checksum;  ///< XXH3-64 of the decoded bytes
};
static_assert(sizeof(PageRecord) == 64);

/// How much a page matters, for readers that have no groups yet: with the rule of selection, the sphere and the largest
/// error give no less than the projected error of any of its groups, up to rounding: 1e-5 of it.
struct PageHintRecord {
  float center[3];            ///< of a sphere that contains the LOD spheres of the page's groups, so all it may draw
  float radius;               ///< object units; kInfiniteError: all of space
  float largest_error;        ///< of the page's groups; kInfiniteError: one is terminal, keep the page always
  float smallest_error;       ///< of the page's groups
  std::uint32_t reserved[2];  ///< zero
};
static_assert(sizeof(PageHintRecord) == 32);

/// A decoded page is an array of u32 words, read as it lies by CPU and GPU:
///   PageHeader · cluster heads, kHeadWords (+ 1 where normals are stored) words each · each cluster's data · one zero
///   word.
/// With the zero word, any field can be read from two words without checking for the page's end.
struct PageHeader {
  std::uint32_t first_cluster;  ///< id of the first cluster
  std::uint32_t cluster_count;  ///< clusters in the page
};
static_assert(sizeof(PageHeader) == 8);

/// A field of a packed head: `bits` bits from bit `shift` (0 the lowest) of word `word`. Signed: two's complement.
struct BitField {
  std::uint8_t word;   ///< counted from the start of the head or range
  std::uint8_t shift;  ///< lowest bit
  std::uint8_t bits;   ///< width
  bool is_signed;      ///< two's complement
  /// Ones in the place of the field, moved to bit 0.
  [[nodiscard]] constexpr std::uint32_t mask() const { return bits == 32 ? 0xFFFFFFFFu : (1u << bits) - 1u; }
};

/// The value of a field, sign-extended if it is signed.
[[nodiscard]] constexpr std::int32_t get_field(const std::uint32_t* words, BitField field) {
  const std::uint32_t value = words[field.word] >> field.shift & field.mask();
  const std::uint32_t sign = field.is_signed ? 1u << (field.bits - 1u) : 0u;
  return static_cast<std::int32_t>((value ^ sign) - sign);
}
/// The bits that do not fit are cut off. \pre the field's bits are zero
constexpr void put_field(std::uint32_t* words, BitField field, std::int32_t value) {
  words[field.word] |= (static_cast<std::uint32_t>(value) & field.mask()) << field.shift;
}

/// The head of a cluster. Unnamed bits are zero.
///   raw position r[axis]    `bits[axis]` bits of the stream
///   u, v                    the raw values of the two axes that are not `shear_axis`, in the order x y z
///   position[axis]          minimum[axis] + r[axis], and for shear_axis + ((shear_u · u + shear_v · v) >> kShearShift)
/// All arithmetic here and below is modulo 2^32, >> is arithmetic.
constexpr std::uint32_t kHeadWords = 5;          ///< of a cluster without stored normals
constexpr std::uint32_t kNormalHeadWords = 1;    ///< more with
constexpr std::uint32_t kShearShift = 7;         ///< products of a shear are shifted right by this
constexpr std::uint32_t kMaxNormalScale = 8191;  ///< the largest MeshRecord::normal_scale
namespace head {
inline constexpr BitField kVerticesLess1{0, 0, 8, false};   ///< number of vertices, less 1
inline constexpr BitField kTrianglesLess1{0, 8, 8, false};  ///< number of triangles, less 1
inline constexpr BitField kDataWord{0, 16, 16,
                                    false};  ///< where the cluster's data starts, words from the page's start
inline constexpr BitField kMinimum[3] = {
    {1, 0, 24, true}, {2, 0, 24, true}, {3, 0, 24, true}};  ///< smallest x, y, z, grid units
inline constexpr BitField kBits[3] = {{1, 24, 5, false}, {2, 24, 5, false}, {3, 24, 5, false}};  ///< 0 … 24
inline constexpr BitField kChart{1, 29, 3, false};  ///< of normals: 2 · axis + (pole on the negative side); 0 without
inline constexpr BitField kShearAxis{2, 29, 2, false};        ///< 0 … 2
inline constexpr BitField kShearU{4, 0, 8, true};             ///< by the first other axis
inline constexpr BitField kShearV{4, 8, 8, true};             ///< by the second other axis
inline constexpr BitField kStripsLess1{4, 16, 8, false};      ///< number of strips, less 1
inline constexpr BitField kReferenceBits{4, 24, 4, false};    ///< 1 … 8
inline constexpr BitField kNormalBitsA{4, 28, 4, false};      ///< 0 … 14; 0 without normals
inline constexpr BitField kNormalMinimumA{5, 0, 14, false};   ///< the word is there only where normals are stored
inline constexpr BitField kNormalMinimumB{5, 14, 14, false};  ///< see kNormalMinimumA
inline constexpr BitField kNormalBitsB{5, 28, 4, false};      ///< 0 … 14
}  // namespace head

/// A cluster's data, without gaps: material ranges (words), UV ranges of set 0, 1, … (words), colour range (words),
/// then one bit stream, then zero bits up to a whole word. Bit k of the stream is bit k mod 32 of word k / 32; fields
/// lie lowest bit first. In the stream, in this order:
///   positions    vertex by vertex: x y z
///   normals      vertex by vertex: a b
///   UVs          set by set, range by range, vertex by vertex: u v
///   colours      vertex by vertex: r g b a
///   topology     see Strips

/// Only where MeshRecord::material is kNone. Triangles are sorted by material; ranges follow until all are covered.
namespace material_range {
constexpr std::uint32_t kWords = 1;                         ///< of a range
inline constexpr BitField kTrianglesLess1{0, 0, 8, false};  ///< number of triangles, less 1
inline constexpr BitField kMaterial{0, 8, 24, false};       ///< into kMaterials
}  // namespace material_range

/// Vertices are in islands that lie one after the other; each range has its own box and its own fit. Ranges follow
/// until all vertices are covered. With the raw position values r:
///   u = minimum_u + (bits_u bits of the stream) + ((u0 · r[x] + u1 · r[y] + u2 · r[z]) >> shift_u), v the same;
/// the last term and its two words are there only where has_fit is 1.
namespace uv_range {
constexpr std::uint32_t kWords = 3;                        ///< of a range without a fit
constexpr std::uint32_t kFitWords = 2;                     ///< more where has_fit is 1
inline constexpr BitField kVerticesLess1{0, 0, 8, false};  ///< number of vertices, less 1
inline constexpr BitField kBitsU{0, 8, 5, false};          ///< 0 … 25
inline constexpr BitField kBitsV{0, 13, 5, false};         ///< 0 … 25
inline constexpr BitField kShiftU{0, 18, 5, false};        ///< of the fit of u
inline constexpr BitField kShiftV{0, 23, 5, false};        ///< of the fit of v
inline constexpr BitField kHasFit{0, 28, 1, false};        ///< 1: the two words of the fit follow
inline constexpr BitField kMinimumU{1, 0, 32, true};       ///< smallest u
inline constexpr BitField kMinimumV{2, 0, 32, true};       ///< smallest v
inline constexpr BitField kFitU[3] = {
    {3, 0, 10, true}, {3, 10, 10, true}, {3, 20, 10, true}};  ///< slopes of u by x, y, z
inline constexpr BitField kFitV[3] = {
    {4, 0, 10, true}, {4, 10, 10, true}, {4, 20, 10, true}};  ///< slopes of v by x, y, z
}  // namespace uv_range

/// Only where has_color is 1. value = minimum + (bits of the stream).
namespace color_range {
constexpr std::uint32_t kWords = 2;  ///< of the range
inline constexpr BitField kMinimum[4] = {
    {0, 0, 8, false}, {0, 8, 8, false}, {0, 16, 8, false}, {0, 24, 8, false}};  ///< smallest r, g, b, a
inline constexpr BitField kBits[4] = {
    {1, 0, 4, false}, {1, 4, 4, false}, {1, 8, 4, false}, {1, 12, 4, false}};  ///< 0 … 8
}  // namespace color_range

/// Normals: the pole of the chart is the axis kChart / 2, on its negative side where kChart is odd. With the other two
/// axes in cyclic order (x: y z, y: z x, z: x y), a' = a - M, b' = b - M with a and b = minimum + stream bits,
/// C = M - |a'| - |b'|:  C >= 0: (A, B) = (a', b'); else A = (M - |b'|) · sign(a'), B = (M - |a'|) · sign(b'),
/// sign(0) = 1. The pole's coordinate is C, or -C on the negative side; the first other axis has A, the second B.

/// Strips. A cluster's T triangles are dealt to strips, S = T + 2 · strips *slots* name their vertices. In the stream:
///   T bits        turn[t]: 0 left, 1 right; 0 for the first triangle of a strip
///   S bits        fresh[s]: 1 the next vertex that was not named before, 0 a reference
///   strips - 1    first triangle of strip 1, 2, …: bit_width(T - 1) bits each, ascending
///   references    for each slot with fresh = 0, in order: kReferenceBits bits d; vertex = (fresh ones before it) - 1 -
///   d
/// Triangle t of strip k (from 0) has its last corner in slot n(t) = t + 2 · k + 2. With t0 the first triangle of k:
///   turn[t] = 0:  q = n(t) - 1;  p = n(r) - 1 for the last r in (t0, t) with turn[r] = 1, else n(t0) - 2
///   turn[t] = 1:  p = n(t) - 1;  q = n(r) - 1 for the last r in [t0, t) with turn[r] = 0
/// and is (p, q, n(t)), counter-clockwise.

enum class BlobKind : std::uint32_t { kImage = 1, kBuffer = 2 };

/// An image or buffer of the source, as it was.
struct BlobRecord {
  StringRef name;              ///< image name or URI base name
  StringRef mime_type;         ///< such as "image/png"
  std::uint64_t offset;        ///< from the start of the file
  std::uint64_t bytes;         ///< length
  BlobKind kind;               ///< image or buffer
  std::uint32_t source_index;  ///< index in the glTF's images or in kScene's buffers
  std::uint64_t checksum;      ///< XXH3-64
};
static_assert(sizeof(BlobRecord) == 48);

static_assert(std::is_trivially_copyable_v<MeshRecord> && std::is_trivially_copyable_v<GroupRecord> &&
              std::is_trivially_copyable_v<ClusterRecord>);

/// Integers of a vertex, see MeshRecord.
[[nodiscard]] constexpr std::uint32_t channel_count(const MeshRecord& mesh) {
  return 3U + (mesh.normal_mode == NormalMode::kStored ? 3U : 0U) + 2U * mesh.uv_set_count + 4U * mesh.has_color;
}
/// A cluster's culling sphere, mesh space relative to MeshRecord::origin; exact in float.
struct CullSphere {
  float center[3];  ///< relative to MeshRecord::origin, object units
  float radius;     ///< object units
};
/// The culling sphere of a cluster.
[[nodiscard]] constexpr CullSphere cull_sphere(const MeshRecord& mesh, const ClusterRecord& cluster) {
  const auto unit = std::bit_cast<float>(static_cast<std::uint32_t>(mesh.sphere_log2 + 127) << 23U);  // 2^sphere_log2
  return {{unit * static_cast<float>(cluster.center[0]), unit * static_cast<float>(cluster.center[1]),
           unit * static_cast<float>(cluster.center[2])},
          unit * static_cast<float>(cluster.radius)};
}
/// Words of a cluster's head.
[[nodiscard]] constexpr std::uint32_t head_words(const MeshRecord& mesh) {
  return kHeadWords + (mesh.normal_mode == NormalMode::kStored ? kNormalHeadWords : 0U);
}

}  // namespace meshlode::format

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
