// SPDX-License-Identifier: MIT
// The bytes of a .lode asset, version 0. docs/format.md is the normative text; this header is the same thing as structs.
//
// Everything is little-endian. Every struct here is copied as it lies in the file: sizes are asserted, there is no
// implicit padding, and reserved fields are written as zero and ignored on reading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(__GNUC__) && !defined(__clang__)  // GCC warns although scoped enumerators shadow nothing
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#endif

namespace meshlode::format {

constexpr std::uint32_t four_cc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24;
}

constexpr std::uint32_t kMagic = four_cc('L', 'O', 'D', 'E');
constexpr std::uint32_t kVersion = 0;
constexpr std::uint32_t kNone = 0xFFFFFFFFu;  ///< "no such id"

/// A root's coarser error: it never passes. Written as null in JSON.
constexpr float kInfiniteError = std::numeric_limits<float>::max();

constexpr std::uint32_t kMaxClusterTriangles = 256;  ///< hard cap of the format (I2); the default build uses 128
constexpr std::uint32_t kMaxClusterVertices = 256;   ///< hard cap of the format (I2)
constexpr std::uint32_t kMaxPageBytes = 128 * 1024;  ///< decoded bytes of a page at most
constexpr std::uint32_t kMaxUvSets = 4;
constexpr std::uint32_t kBvhWidth = 8;               ///< children of a BVH node at most
constexpr std::uint32_t kSectionAlignment = 16;      ///< file offsets of sections and pages are multiples of this

// ---------------------------------------------------------------------------------------------------------------- file

struct FileHeader {
  std::uint32_t magic;                 ///< kMagic
  std::uint32_t version;               ///< kVersion
  std::uint32_t header_bytes;          ///< sizeof(FileHeader); a later version may be longer
  std::uint32_t section_count;
  std::uint64_t file_bytes;            ///< size of the whole file
  std::uint64_t section_table_offset;  ///< from the start of the file
  std::uint8_t content_hash[16];       ///< XXH3-128 over the decoded content, see docs/format.md
  std::uint32_t section_entry_bytes;   ///< stride of the section table
  std::uint32_t flags;                 ///< zero
  std::uint64_t header_checksum;       ///< XXH3-64 of the header with this field zero, then of the section table
};
static_assert(sizeof(FileHeader) == 64);

/// Section ids. A reader skips ids it does not know unless kSectionRequired is set.
enum class SectionId : std::uint32_t {
  kMeta = four_cc('M', 'E', 'T', 'A'),       ///< JSON text: source, settings, plan, drops (UTF-8, no terminator)
  kScene = four_cc('S', 'C', 'N', 'E'),      ///< JSON text: the glTF scene graph, materials, textures as they were
  kStrings = four_cc('S', 'T', 'R', 'S'),    ///< UTF-8 bytes that StringRef points into
  kMeshes = four_cc('M', 'E', 'S', 'H'),     ///< MeshRecord[]
  kMaterials = four_cc('M', 'A', 'T', 'L'),  ///< MaterialRecord[]
  kInstances = four_cc('I', 'N', 'S', 'T'),  ///< InstanceRecord[]
  kGroups = four_cc('G', 'R', 'U', 'P'),     ///< GroupRecord[]
  kClusters = four_cc('C', 'L', 'U', 'S'),   ///< ClusterRecord[]
  kNodes = four_cc('N', 'O', 'D', 'E'),      ///< NodeRecord[]
  kPages = four_cc('P', 'A', 'G', 'T'),      ///< PageRecord[]
  kPageDeps = four_cc('P', 'D', 'E', 'P'),   ///< u32[]: page ids
  kPageData = four_cc('P', 'A', 'G', 'E'),   ///< the pages' stored bytes
  kBlobs = four_cc('B', 'L', 'B', 'T'),      ///< BlobRecord[]
  kBlobData = four_cc('B', 'L', 'O', 'B'),   ///< images and animation data as they were
};

constexpr std::uint32_t kSectionRequired = 1u;  ///< SectionEntry::flags: a reader that does not know the id must refuse

struct SectionEntry {
  std::uint32_t id;            ///< SectionId
  std::uint32_t version;       ///< of this section's layout; 0
  std::uint32_t flags;         ///< kSectionRequired
  std::uint32_t codec;         ///< Codec of the section as a whole; kNone here (pages carry their own)
  std::uint64_t offset;        ///< from the start of the file, a multiple of kSectionAlignment
  std::uint64_t bytes;         ///< stored
  std::uint64_t decoded_bytes; ///< after the codec
  std::uint64_t checksum;      ///< XXH3-64 of the stored bytes; 0 for kPageData, whose pages carry their own
  std::uint32_t record_bytes;  ///< stride of a table; 0 for text and raw bytes
  std::uint32_t record_count;
  std::uint64_t reserved;
};
static_assert(sizeof(SectionEntry) == 64);

/// Disk codec of a page. Values are stable.
enum class Codec : std::uint32_t { kNone = 0, kLz4 = 1, kZstd = 2, kDraco = 3 };

struct StringRef {
  std::uint32_t offset;  ///< into kStrings
  std::uint32_t bytes;
};
static_assert(sizeof(StringRef) == 8);

// -------------------------------------------------------------------------------------------------------------- meshes

enum class ErrorTier : std::uint32_t { kQem = 0, kMeasured = 1, kCertified = 2 };

/// How shading normals are had.
enum class NormalMode : std::uint32_t {
  kNone = 0,    ///< left out by option: a renderer may use the geometric normal
  kStored = 1,  ///< octahedral, per vertex
  kFlat = 2,    ///< the geometric normal of each triangle is the shading normal: nothing is stored
};

/// position_object = origin + step · q, with q a signed integer of at most 24 bits and step = mantissa · 2^log2.
struct Grid {
  std::int32_t log2;
  std::uint32_t mantissa;  ///< a small odd integer, 1 when the budget is free to choose
};
static_assert(sizeof(Grid) == 8);

/// uv = step · (channel integer), step = 2^log2; |channel integer| < 2^24, so that a float holds it exactly.
struct UvGrid {
  std::int32_t log2;
  std::int32_t reserved;
};
static_assert(sizeof(UvGrid) == 8);

/// Channels of a vertex, in this order, each present or absent for the whole mesh:
///   position x y z · normal a b (octahedral) · uv0 u v · … uv3 u v · colour r g b a
/// MeshRecord::channel_count = 3 + 2·(normal_mode == kStored) + 2·uv_set_count + 4·has_color.
struct MeshRecord {
  StringRef name;
  double origin[3];                 ///< mesh space, object units
  Grid grid;
  std::int32_t bounds_min[3];       ///< of level 0, grid units
  std::int32_t bounds_max[3];
  double diagonal;                  ///< of the source's bounding box, object units; errors relative to it
  float level0_deviation;           ///< how far quantization alone moves the surface at most, object units
  ErrorTier error_tier;
  NormalMode normal_mode;
  std::uint32_t normal_bits;        ///< per octahedral axis: values 0 … 2^bits - 2, see docs/format.md
  std::uint32_t uv_set_count;
  std::uint32_t has_color;          ///< 0 or 1; channels are c · 255 rounded, linear as in the source
  UvGrid uv_grid[kMaxUvSets];
  std::uint8_t uv_set_source[kMaxUvSets];  ///< the TEXCOORD_n that stored set k was
  std::uint32_t channel_count;
  std::uint64_t source_triangles;   ///< after triangulation, before anything was dropped
  std::uint64_t source_vertices;
  std::uint64_t dropped_degenerate;
  std::uint64_t dropped_duplicate;
  std::uint64_t dropped_repaired;   ///< by --repair: non-finite positions, indices out of range
  std::uint64_t grid_collapsed;     ///< triangles of level 0 that have zero area after quantization; they stay
  std::uint32_t first_group;        ///< groups of this mesh are contiguous, coarse to fine
  std::uint32_t group_count;
  std::uint32_t first_cluster;      ///< clusters of this mesh are contiguous
  std::uint32_t cluster_count;
  std::uint32_t first_node;         ///< BVH nodes of this mesh are contiguous, the root is the first
  std::uint32_t node_count;
  std::uint32_t level_count;
  std::uint32_t reserved;
};
static_assert(sizeof(MeshRecord) == 216);

enum class AlphaMode : std::uint32_t { kOpaque = 0, kMask = 1, kBlend = 2 };

/// What a renderer needs at once; everything else of the material is in kScene under the same index.
struct MaterialRecord {
  StringRef name;
  std::uint32_t source_index;  ///< index in the glTF's materials; kNone for the default material
  AlphaMode alpha_mode;
  float base_color[4];
  float alpha_cutoff;
  std::uint32_t double_sided;  ///< 0 or 1
  std::uint32_t base_color_texture;  ///< glTF texture index; kNone without
  std::uint32_t base_color_uv_set;   ///< TEXCOORD_n; kNone without
};
static_assert(sizeof(MaterialRecord) == 48);

constexpr std::uint32_t kInstanceMirrored = 1u;  ///< determinant < 0: flip culling
constexpr std::uint32_t kInstanceSingular = 2u;  ///< singular or not finite: reported and not drawn

struct InstanceRecord {
  double transform[12];  ///< mesh space to world, row-major 3×4
  double scale;          ///< largest singular value of the 3×3 part, rounded up
  std::uint32_t mesh;
  std::uint32_t node;    ///< index of the glTF node
  std::uint32_t flags;   ///< kInstance…
  std::uint32_t reserved;
  StringRef name;
};
static_assert(sizeof(InstanceRecord) == 128);

// ------------------------------------------------------------------------------------------------------- the LOD DAG

constexpr std::uint16_t kGroupTerminal = 1u;  ///< nothing coarser replaces its members: they are roots, error is infinite
constexpr std::uint16_t kGroupStuck = 2u;     ///< terminal, and not because the top was reached

/// Why a group could not be simplified further.
enum class StuckReason : std::uint32_t {
  kNotStuck = 0,
  kLocked = 1,       ///< too much of it is shared with other groups
  kFlips = 2,        ///< every collapse left would turn a triangle over
  kSeams = 3,        ///< attribute seams or material borders
  kComponents = 4,   ///< loose pieces that share no vertex
  kTooSmall = 5,     ///< nothing left to remove
  kTopology = 6,     ///< every collapse left would break the link condition
};

/// A group: clusters that are replaced together. Its error and sphere are the `coarser` values of its members and the
/// `own` values of the clusters made from it: the same stored bits.
struct GroupRecord {
  float center[3];             ///< LOD sphere, mesh space relative to MeshRecord::origin
  float radius;
  float error;                 ///< selection error, object units, strictly growing along the DAG; kInfiniteError if terminal
  float quadric_error;         ///< the quadric's own estimate, object units
  float deviation;             ///< two-sided distance to the source, quantization included; kInfiniteError if not measured
  float normal_deviation;      ///< shading normals against the source's, largest angle in degrees, never falling along
                               ///< the DAG; kInfiniteError if terminal or not measured
  std::uint32_t first_cluster; ///< members, contiguous
  std::uint32_t cluster_count;
  std::uint32_t mesh;
  std::uint32_t page;
  std::uint16_t level;         ///< largest level of a member
  std::uint16_t flags;         ///< kGroup…
  StuckReason stuck_reason;
  float uv_deviation;          ///< UVs against the source's, largest distance over all sets in UV units; the same rules
  std::uint32_t reserved;
};
static_assert(sizeof(GroupRecord) == 64);

/// A cluster (meshlet). Drawn iff its own group's error passes (or it has none) and its coarser group's does not (I5).
struct ClusterRecord {
  float center[3];               ///< culling sphere, mesh space relative to MeshRecord::origin
  float radius;
  std::int8_t cone_axis[3];      ///< normal cone, /127
  std::int8_t cone_cutoff;       ///< /127, rounded up: back-facing iff dot(view, axis) >= cutoff; 127 = never culled
  std::uint32_t own_group;       ///< the group it was made from; kNone at level 0
  std::uint32_t coarser_group;   ///< the group that replaces it: the group it is a member of
  std::uint16_t vertex_count;    ///< 1 … kMaxClusterVertices
  std::uint16_t triangle_count;  ///< 1 … kMaxClusterTriangles
  std::uint16_t level;
  std::uint16_t flags;           ///< zero
  std::uint32_t reserved;
};
static_assert(sizeof(ClusterRecord) == 40);

/// BVH over the groups of a mesh. Sphere and error bound those of everything below, so a node that passes has nothing
/// to draw below it.
struct NodeRecord {
  float center[3];
  float radius;
  float error;               ///< largest group error below; kInfiniteError above a terminal group
  std::uint32_t first;       ///< first child node (children are contiguous), or the group id where child_count == 0
  std::uint32_t child_count; ///< 0 = leaf
  std::uint32_t reserved;
};
static_assert(sizeof(NodeRecord) == 32);

// --------------------------------------------------------------------------------------------------------------- pages

struct PageRecord {
  std::uint64_t offset;        ///< from the start of the file
  std::uint32_t stored_bytes;
  std::uint32_t bytes;         ///< decoded, at most kMaxPageBytes
  Codec codec;
  std::uint32_t first_group;   ///< pages hold whole groups, contiguous
  std::uint32_t group_count;
  std::uint32_t first_cluster;
  std::uint32_t cluster_count;
  std::uint32_t first_dependency;  ///< into kPageDeps: pages that hold the coarser clusters made from this page's groups
  std::uint32_t dependency_count;
  std::uint32_t reserved;
  std::uint64_t checksum;          ///< XXH3-64 of the stored bytes
  std::uint64_t decoded_checksum;  ///< XXH3-64 of the decoded bytes
};
static_assert(sizeof(PageRecord) == 64);

/// Start of a decoded page; u32 offsets[cluster_count] follow (bytes from the page's start, multiples of 4).
struct PageHeader {
  std::uint32_t first_cluster;
  std::uint32_t cluster_count;
};
static_assert(sizeof(PageHeader) == 8);

/// Start of a cluster in a page; Channel[channel_count], MaterialRange[material_range_count], then the two streams.
struct PageCluster {
  std::uint16_t vertex_count;
  std::uint16_t triangle_count;
  std::uint16_t channel_count;
  std::uint16_t material_range_count;
  std::uint32_t vertex_bits;      ///< bits of a vertex = sum over channels
  std::uint32_t vertex_offset;    ///< of the vertex bit stream, bytes from the page's start, multiple of 4
  std::uint32_t triangle_offset;  ///< of the triangles: 3 × u8 local vertex indices each, multiple of 4
};
static_assert(sizeof(PageCluster) == 20);

/// value = minimum + (bits-wide unsigned integer). Vertex i starts at bit i · vertex_bits of the stream; bit k of the
/// stream is bit k mod 8 of byte k / 8. Channels follow each other in the mesh's channel order.
struct Channel {
  std::int32_t minimum;
  std::uint32_t bits;  ///< 0 … 25
};
static_assert(sizeof(Channel) == 8);

/// Triangles of a cluster are sorted by material; the ranges cover them in order.
struct MaterialRange {
  std::uint32_t material;        ///< into kMaterials
  std::uint32_t triangle_count;  ///< at least 1
};
static_assert(sizeof(MaterialRange) == 8);

enum class BlobKind : std::uint32_t { kImage = 1, kBuffer = 2 };

struct BlobRecord {
  StringRef name;            ///< image name or URI base name
  StringRef mime_type;
  std::uint64_t offset;      ///< from the start of the file
  std::uint64_t bytes;
  BlobKind kind;
  std::uint32_t source_index;  ///< index in the glTF's images or in kScene's buffers
  std::uint64_t checksum;      ///< XXH3-64
};
static_assert(sizeof(BlobRecord) == 48);

static_assert(std::is_trivially_copyable_v<MeshRecord> && std::is_trivially_copyable_v<GroupRecord>);

}  // namespace meshlode::format

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
