// SPDX-License-Identifier: MIT
// Bindings of vulkan.c, all in set 0: what the structs of that file hold.
struct Instance { mat4 clip; vec4 normal[3]; MetricView view; uint mesh, first_cluster, cluster_count, unused; };
struct Group { vec4 sphere; float error; uint unused[3]; };  // relative to the mesh's origin
struct Cluster { uint own_group, coarser_group, page_word, index_in_page; };
layout(std430, set = 0, binding = 0) readonly buffer Pages { uint words[]; };
layout(std430, set = 0, binding = 1) readonly buffer Instances { Instance instances[]; };
layout(std430, set = 0, binding = 2) readonly buffer Groups { Group groups[]; };
layout(std430, set = 0, binding = 3) readonly buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = 4) readonly buffer Meshes { uvec4 meshes[]; };
