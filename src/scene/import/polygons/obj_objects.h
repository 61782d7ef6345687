// SPDX-License-Identifier: GPL-3.0-or-later
// Which objects of an OBJ become meshes of their own: those that share no position with another.
#pragma once

#include <string>
#include <vector>

#include "scene/import/polygons/polygon_soup.h"

namespace meshlode::scene {

/// One line of `left_out`: so many of `noun` ("object"), why, and the first names.
void leave_out_names(const std::vector<std::string>& names, const char* noun, const char* why,
                     std::vector<LeftOut>& left_out);

/// Takes soup.polygon_objects away from the polygons of objects that touch what is not theirs: they stay in one mesh,
/// without a crack between them. Positions are the same where their coordinates are equal.
/// \param names of the objects; says in `left_out` which of them no mesh has
void separate_objects(PolygonSoup& soup, const std::vector<std::string>& names, std::vector<LeftOut>& left_out);

}  // namespace meshlode::scene
