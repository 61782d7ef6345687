// SPDX-License-Identifier: GPL-3.0-or-later
// Surgery on good surfaces: cut, moved, mirrored, capped, turned, transplanted, torn and glued again, as editors,
// scanners and converters leave them. No math library but sqrt, floor and ldexp: a seed gives the same bits with every
// compiler.
#pragma once

#include <span>
#include <string>

#include "shapes.h"

namespace meshlode::test {

/// One kind of operation, on at least one triangle. It keeps every index in range and every point finite, leaves a
/// triangle, and at most doubles them.
struct Operation {
  const char* name;
  void (*apply)(Shape& shape, Dice& dice);
};

[[nodiscard]] std::span<const Operation> surgery_operations();

/// One to six operations, one after the other; only the first is given more than `most` triangles. Their names are
/// appended to `names`. Nothing happens to a shape without triangles.
void operate(Shape& shape, Dice& dice, std::size_t most, std::string& names);

}  // namespace meshlode::test
