// SPDX-License-Identifier: GPL-3.0-or-later
// A plot in two dimensions as SVG: axes with ticks, series told apart by colour, by the shape of their markers and by
// the dashes of their lines, a legend, spreads as bars. Whatever is a number in it is also in its table.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lab/page/axis.h"
#include "lab/page/markup.h"

namespace meshlode::lab::page {

struct Spread {
  double low = 0.0, high = 0.0;
};

struct PlotPoint {
  double x = 0.0, y = 0.0;
  Spread x_spread, y_spread;  ///< drawn where high is above low
  std::string title;          ///< shown while it is pointed at
  std::string id = {};        ///< of the point of the sweep, so that all marks of one can be found; may be empty
  std::string label = {};     ///< beside it, where there is room
};

enum class Drawn { kMarkers, kLine, kLineAndMarkers, kSteps };

struct Series {
  std::string name;
  std::size_t look = 0;  ///< colour, shape and dashes: any number, those below 40 look different
  Drawn drawn = Drawn::kMarkers;
  std::vector<PlotPoint> points;  ///< those with a coordinate that is not finite are not drawn
  bool is_plain = false;          ///< a line in the colour of the text, for what is no measurement
};

struct Plot {
  std::string id;  ///< letters, digits and '-': unique in a page, and the file's name
  std::string title, description;
  AxisWish x, y;
  std::vector<Series> series;  ///< the first is drawn on top
  bool has_diagonal = false;   ///< where x equals y
};

enum class Standing { kInPage, kAlone };

/// An svg element; alone it is a document of its own, with its colours.
[[nodiscard]] std::string draw_plot(const Plot& plot, Standing standing);

/// The start of an svg element `width` x `height` with its title and description, which the caller closes; alone it has
/// the namespace and its styles.
void open_svg(Markup& svg, const std::string& id, const std::string& title, const std::string& description,
              double width, double height, Standing standing);

/// A marker of the series' look around (x, y).
void draw_marker(Markup& svg, std::size_t look, double x, double y, const PlotPoint* point);

/// How wide a text of the plots' size is, in pixels: near enough to place others beside it.
[[nodiscard]] double text_width(std::string_view text);

}  // namespace meshlode::lab::page
