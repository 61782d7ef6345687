// SPDX-License-Identifier: MIT
// What select.wgsl and draw.wgsl read; index.js writes it.
struct Mesh {
  normal_scale: u32,  // these four: LodeMesh
  uv_set_count: u32,
  has_color: u32,
  material: u32,
  first_group: u32,
  group_count: u32,
  sphere_unit: f32,  // of clusters' culling spheres
  step: f32,         // of the grid
  uv_step: f32,      // of the first stored set
  unused: array<u32, 3>,
}
struct Instance {
  clip: mat4x4f,            // object units, relative to the mesh's origin, to clip space
  world: array<vec4f, 3>,   // rows: the same to the world, relative to the eye
  view: array<vec4f, 3>,    // these six: MetricView of <meshlode/metric.h>
  scale: f32,
  error_scale: f32,
  near_distance: f32,
  first_state: u32,
  mesh: u32,
  is_mirrored: u32,
  id: u32,  // in the asset
  unused: u32,
}
