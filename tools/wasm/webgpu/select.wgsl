// SPDX-License-Identifier: MIT
// The selection of src/run/select/resident.h. A group is reached if it does not pass, its page is resident and every group is reached
// that holds a cluster made from it; a cluster is drawn if its coarser group is reached and its own is not. reach() runs once per
// level, from coarse to fine. Each group of an instance is tested once, so that no rounding can open the cut.

struct Select { level: u32, level_stride: u32, instance_count: u32, is_culled: u32, zero: u32 }
struct Draw { vertex_count: u32, instance_count: atomic<u32>, first_vertex: u32, first_instance: u32, items: array<vec2u> }

@group(0) @binding(0) var<uniform> run: Select;
@group(0) @binding(1) var<storage, read> groups: array<u32>;    // GroupRecord, 14 words
@group(0) @binding(2) var<storage, read> clusters: array<u32>;  // ClusterRecord, 6 words
@group(0) @binding(3) var<storage, read> meshes: array<Mesh>;
@group(0) @binding(4) var<storage, read> levels: array<u32>;  // per mesh and level: its first group
@group(0) @binding(5) var<storage, read> instances: array<Instance>;
@group(0) @binding(6) var<storage, read> pages: array<vec2u>;
@group(0) @binding(7) var<storage, read_write> states: array<atomic<u32>>;  // per instance and group
@group(0) @binding(8) var<storage, read_write> draw: Draw;

const BLOCKED = 1u;  // a coarser group is not reached
const REACHED = 2u;
const INFINITE_ERROR = 3.4028234663852886e38f;
const ERROR_CAP = 4611686018427387904.0f;

fn group_float(group: u32, word: u32) -> f32 { return bitcast<f32>(groups[14u * group + word]); }

// A product or a sum as it is rounded. WGSL lets a compiler fuse and reorder operations, but not across a value that it does not know.
fn rounded(value: f32) -> f32 { return bitcast<f32>(bitcast<u32>(value) ^ run.zero); }
fn sum_of(a: f32, b: f32, c: f32) -> f32 { return rounded(rounded(rounded(a) + rounded(b)) + rounded(c)); }
fn row(at: vec4f, c: vec3f) -> f32 { return sum_of(at.x * c.x, at.y * c.y, at.z * c.z) + at.w; }

// metric_passes() of <meshlode/metric.h>
fn passes(i: u32, group: u32) -> bool {
  let error = group_float(group, 4u);
  if (!(error < INFINITE_ERROR)) { return false; }
  let e = min(rounded(error * instances[i].error_scale), ERROR_CAP);
  if (e <= instances[i].near_distance) { return true; }
  let reach = rounded(e + rounded(group_float(group, 3u) * instances[i].scale));
  let center = vec3f(group_float(group, 0u), group_float(group, 1u), group_float(group, 2u));
  let x = rounded(row(instances[i].view[0], center));
  let y = rounded(row(instances[i].view[1], center));
  let z = rounded(row(instances[i].view[2], center));
  return rounded(reach * reach) <= sum_of(x * x, y * y, z * z);
}

// Beyond all doubt: the bounds are those of src/draw/gpu/shaders/cull.glsl.
fn is_outside(i: u32, cluster: u32) -> bool {
  let at = 6u * cluster;
  let unit = meshes[instances[i].mesh].sphere_unit;
  let xy = extractBits(vec2i(bitcast<i32>(clusters[at])), 0u, 16u).x;
  let center = unit * vec3f(f32(xy), f32(bitcast<i32>(clusters[at]) >> 16u), f32(extractBits(bitcast<i32>(clusters[at + 1u]), 0u, 16u)));
  let radius = unit * f32(clusters[at + 1u] >> 16u);
  let m = transpose(instances[i].clip);
  for (var k = 0u; k < 5u; k++) {
    let plane = m[3] + select(0.0, select(1.0, -1.0, (k & 1u) == 1u), k < 4u) * m[(k >> 1u) & 1u];
    let slack = 4e-6 * (dot(abs(m[3].xyz) + abs(m[(k >> 1u) & 1u].xyz), abs(center)) + abs(m[3].w) + abs(m[(k >> 1u) & 1u].w));
    if (dot(plane.xyz, center) + plane.w < -(length(plane.xyz) * radius * 1.0001 + slack)) { return true; }
  }
  return false;
}

@compute @workgroup_size(64)
fn reach(@builtin(global_invocation_id) id: vec3u) {
  let i = id.y + 65535u * id.z;
  if (i >= run.instance_count) { return; }
  let at = instances[i].mesh * run.level_stride + run.level;
  let group = levels[at] + id.x;
  if (group >= levels[at - 1u]) { return; }  // levels[0] of a mesh is its end
  let state = instances[i].first_state + group - meshes[instances[i].mesh].first_group;
  if (atomicLoad(&states[state]) != BLOCKED && pages[groups[14u * group + 11u]].y != LODE_NONE && !passes(i, group)) {
    atomicStore(&states[state], REACHED);
    return;
  }
  let first = groups[14u * group + 9u];
  for (var c = first; c < first + (groups[14u * group + 12u] & 0xFFFFu); c++) {
    let own = clusters[6u * c + 3u];
    if (own != LODE_NONE) { atomicStore(&states[instances[i].first_state + own - meshes[instances[i].mesh].first_group], BLOCKED); }
  }
}

@compute @workgroup_size(64)
fn collect(@builtin(global_invocation_id) id: vec3u) {
  let i = id.y + 65535u * id.z;
  if (i >= run.instance_count) { return; }
  let mesh = instances[i].mesh;
  if (id.x >= meshes[mesh].group_count) { return; }
  if (atomicLoad(&states[instances[i].first_state + id.x]) != REACHED) { return; }
  let group = meshes[mesh].first_group + id.x;
  let first = groups[14u * group + 9u];
  for (var c = first; c < first + (groups[14u * group + 12u] & 0xFFFFu); c++) {
    let own = clusters[6u * c + 3u];
    if (own != LODE_NONE && atomicLoad(&states[instances[i].first_state + own - meshes[mesh].first_group]) == REACHED) { continue; }
    if (run.is_culled != 0u && is_outside(i, c)) { continue; }
    draw.items[atomicAdd(&draw.instance_count, 1u)] = vec2u(i, c);
  }
}
