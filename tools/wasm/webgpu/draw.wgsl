// SPDX-License-Identifier: MIT
// Draws the list of select.wgsl: an instance of the indirect draw per cluster, a corner of a triangle per vertex, decoded from the page.

struct List { vertex_count: u32, instance_count: u32, first_vertex: u32, first_instance: u32, items: array<vec2u> }
struct Material { base_color: vec4f, is_double_sided: u32, unused: array<u32, 3> }

@group(0) @binding(0) var<storage, read> words: array<u32>;  // slots of pages
@group(0) @binding(1) var<storage, read> groups: array<u32>;
@group(0) @binding(2) var<storage, read> clusters: array<u32>;
@group(0) @binding(3) var<storage, read> meshes: array<Mesh>;
@group(0) @binding(4) var<storage, read> instances: array<Instance>;
@group(0) @binding(5) var<storage, read> pages: array<vec2u>;  // first cluster; first word of its slot, LODE_NONE: not resident
@group(0) @binding(6) var<storage, read> list: List;
@group(0) @binding(7) var<storage, read> materials: array<Material>;

fn lode_word(i: u32) -> u32 { return words[i]; }

/// What shade() is given. Directions are of the world.
struct Surface {
  @builtin(position) position: vec4f,
  @location(0) from_eye: vec3f,
  @location(1) normal: vec3f,  // 0 where none is stored
  @location(2) uv: vec2f,      // of the first stored set
  @location(3) color: vec4f,   // of the vertices, linear
  @location(4) @interpolate(flat) material: u32,
  @location(5) @interpolate(flat) cluster: u32,
  @location(6) @interpolate(flat) instance: u32,  // of the asset
  @location(7) @interpolate(flat) is_mirrored: u32,
}

@vertex
fn decode(@builtin(vertex_index) corner: u32, @builtin(instance_index) item: u32) -> Surface {
  var out: Surface;
  let i = list.items[item].x;
  let cluster = list.items[item].y;
  let mesh = meshes[instances[i].mesh];
  let page = pages[groups[14u * clusters[6u * cluster + 4u] + 11u]];
  let triangle = corner / 3u;
  if (page.y == LODE_NONE) { return out; }
  let c = lode_read_cluster(LodeMesh(mesh.normal_scale, mesh.uv_set_count, mesh.has_color, mesh.material), page.y, cluster - page.x);
  if (triangle >= c.triangle_count) { return out; }  // all three corners: nothing is drawn
  let slots = lode_triangle_slots(c, triangle);
  let v = lode_slot(c, slots[corner % 3u]);
  let raw = lode_raw_position(c, v);
  let at = vec4f(vec3f(lode_position(c, raw)) * mesh.step, 1.0);
  let w = instances[i].world;
  out.position = instances[i].clip * at;
  out.from_eye = vec3f(dot(w[0], at), dot(w[1], at), dot(w[2], at));
  if (mesh.normal_scale != 0u) {
    let n = vec3f(lode_normal(c, v));
    out.normal = vec3f(dot(cross(w[1].xyz, w[2].xyz), n), dot(cross(w[2].xyz, w[0].xyz), n), dot(cross(w[0].xyz, w[1].xyz), n));
    out.normal = normalize(out.normal) * select(1.0, -1.0, instances[i].is_mirrored != 0u);
  }
  if (mesh.uv_set_count != 0u) { out.uv = vec2f(lode_uv(c, 0u, v, raw)) * mesh.uv_step; }
  out.color = vec4f(1.0);
  if (mesh.has_color != 0u) { out.color = vec4f(lode_color(c, v)) / 255.0; }
  out.material = lode_material(c, triangle);
  out.cluster = cluster;
  out.instance = instances[i].id;
  out.is_mirrored = instances[i].is_mirrored;
  return out;
}

@fragment
fn paint(in: Surface, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
  // Derivatives before anything ends an invocation.
  let flat_normal = normalize(cross(dpdx(in.from_eye), dpdy(in.from_eye)));
  var surface = in;
  let is_seen_from_front = is_front != (in.is_mirrored != 0u);
  if (all(in.normal == vec3f(0.0))) { surface.normal = flat_normal * sign(-dot(flat_normal, in.from_eye)); }
  else { surface.normal = normalize(in.normal) * select(-1.0, 1.0, is_seen_from_front); }
  let color = shade(surface, materials[in.material].base_color * in.color);
  if (!is_seen_from_front && materials[in.material].is_double_sided == 0u) { discard; }
  return color;
}
