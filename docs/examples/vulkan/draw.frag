// SPDX-License-Identifier: MIT
// A colour per cluster, lit; never as dark as the background.
#version 460
layout(location = 0) in vec3 normal;
layout(location = 1) flat in uint cluster;
layout(location = 0) out vec4 color;

void main() {
  const vec3 hue = vec3((uvec3(cluster) * uvec3(37u, 61u, 85u)) % 160u + 96u) / 255.0;
  const float light = normal == vec3(0.0) ? 1.0 : 0.55 + 0.45 * dot(normalize(normal), normalize(vec3(0.4, 0.8, 0.5)));
  color = vec4(max(hue * light, vec3(0.15)), 1.0);
}
