// SPDX-License-Identifier: MIT
// The small vectors of the project. Only + - * / sqrt, floor and fma are used on the way to a byte (I10): never
// glm::acos, glm::pow and the like, whose bits differ between C libraries.
#pragma once

#define GLM_FORCE_CTOR_INIT
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace meshlode {

using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec4f = glm::vec4;
using Vec2d = glm::dvec2;
using Vec3d = glm::dvec3;
using Vec3i = glm::ivec3;
using Mat3d = glm::dmat3;
using Mat4d = glm::dmat4;

}  // namespace meshlode
