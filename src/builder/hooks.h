// SPDX-License-Identifier: GPL-3.0-or-later
// What a study may put in the place of the builder's own ways. Only src/lab fills it: a build that nobody studies has
// none.
#pragma once

#include <string>

#include "builder/hierarchy/enclosing_ball.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

struct BuildHooks {
  std::string record;  ///< one line of JSON: settings.experimental of META, and what caches know the hooks by
  std::string words;   ///< the same for a reader, among the asset's decisions

  SimplifyGroup simplify_group = builder::simplify_group;
  bool heeds_all_options = true;  ///< simplify_group keeps topology and locks borders where asked; else that is refused
  EnclosingBall enclosing_ball = builder::enclosing_ball;
  bool separates_needles = true;  ///< PrepareOptions::separates_needles
};

}  // namespace meshlode::builder
