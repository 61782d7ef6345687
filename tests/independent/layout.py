# SPDX-License-Identifier: GPL-3.0-or-later
"""The record tables of docs/reference/format.md, typed in."""

TABLES_TEXT = {
    "HEADER": """
0 u8[4] magic
4 u32 version
8 u32 header_bytes
12 u32 section_count
16 u64 file_bytes
24 u64 section_table_offset
32 u8[16] content_hash
48 u32 section_entry_bytes
52 u32 flags
56 u64 header_checksum
size 64""",
    "ENTRY": """
0 u8[4] id
4 u32 version
8 u32 flags
12 u32 codec
16 u64 offset
24 u64 bytes
32 u64 decoded_bytes
40 u64 checksum
48 u32 record_bytes
52 u32 record_count
56 u64 reserved
size 64""",
    "MATL": """
0 str name
8 u32 source_index
12 u32 alpha_mode
16 f32[4] base_color
32 f32 alpha_cutoff
36 u32 double_sided
40 u32 base_color_texture
44 u32 base_color_uv_set
size 48""",
    "INST": """
0 f64[12] transform
96 f64 scale
104 u32 mesh
108 u32 node
112 u32 flags
116 u32 reserved
120 str name
size 128""",
    "BLBT": """
0 str name
8 str mime_type
16 u64 offset
24 u64 bytes
32 u32 kind
36 u32 source_index
40 u64 checksum
size 48""",
    "PAGT": """
0 u64 offset
8 u32 stored_bytes
12 u32 bytes
16 u32 codec
20 u32 first_group
24 u32 group_count
28 u32 first_cluster
32 u32 cluster_count
36 u32 first_dependency
40 u32 dependency_count
44 u32 reserved
48 u64 checksum
56 u64 decoded_checksum
size 64""",
    "MESH": """
0 str name
8 f64[3] origin
32 i32 grid_log2
36 u32 grid_mantissa
40 i32[3] bounds_min
52 i32[3] bounds_max
64 f64 diagonal
72 f32 level0_deviation
76 u32 error_tier
80 u32 normal_mode
84 u32 normal_scale
88 u32 uv_set_count
92 u32 has_color
96 i32[4] uv_log2
112 u8[4] uv_set_source
116 u32 material
120 i32 sphere_log2
124 u32 level_count
128 u64 source_triangles
136 u64 source_vertices
144 u64 dropped_degenerate
152 u64 dropped_duplicate
160 u64 dropped_repaired
168 u64 grid_collapsed
176 u32 first_group
180 u32 group_count
184 u32 first_cluster
188 u32 cluster_count
192 u32 first_node
196 u32 node_count
size 200""",
    "GRUP": """
0 f32[3] center
12 f32 radius
16 f32 error
20 f32 quadric_error
24 f32 deviation
28 f32 normal_deviation
32 f32 uv_deviation
36 u32 first_cluster
40 u32 mesh
44 u32 page
48 u16 cluster_count
50 u16 level
52 u16 flags
54 u16 stuck_reason
size 56""",
    "PRMS": """
0 u32 promises
4 f32 normal_object
8 f32[8] uv_object
40 f32 level0_texels
44 f32 level0_appearance
size 48""",
    "PHNT": """
0 f32[3] center
12 f32 radius
16 f32 largest_error
20 f32 smallest_error
24 u32[2] reserved
size 32""",
    "PRMG": """
0 f32 texel_error
4 f32 appearance_error
size 8""",
    "CLUS": """
0 i16[3] center
6 u16 radius
8 i8[3] cone_axis
11 i8 cone_cutoff
12 u32 own_group
16 u32 coarser_group
20 u8 vertices_less_1
21 u8 triangles_less_1
22 u16 level
size 24""",
    "NODE": """
0 f32[3] center
12 f32 radius
16 f32 error
20 u32 first
24 u32 child_count
size 28""",
}
