// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/pictures.h"

#include <algorithm>
#include <string>
#include <vector>

#include "app/page/text_forms.h"
#include "lab/page/charts.h"
#include "lab/page/numbers.h"

namespace meshlode::lab::page {

namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes* find_picture(const ReportData& data, const std::string& path) {
  const auto found = path.empty() ? data.pictures.end() : data.pictures.find(path);
  return found == data.pictures.end() ? nullptr : &found->second;
}

std::string data_uri(const Bytes& png) {
  return "data:image/png;base64," + app::encode_base64(png);
}

/// A point and its picture in one view.
struct Shown {
  const Point* point;
  const CutPicture* picture;
};

std::vector<Shown> pictures_of(const ReportData& data, const View& view) {
  std::vector<const Point*> points = notable_points(data, data.points.size());
  for (const Point& point : data.points) {
    // Those of the same asset too: they draw another cut of it.
    if (std::find(points.begin(), points.end(), &point) == points.end()) points.push_back(&point);
  }
  std::vector<Shown> shown;
  for (const Point* point : points) {
    for (const CutPicture& picture : point->pictures) {
      if (picture.view == view.name && find_picture(data, picture.picture) != nullptr)
        shown.push_back({point, &picture});
    }
  }
  return shown;
}

std::string figures_of(const CutPicture& picture) {
  return amount_text(static_cast<double>(picture.triangles), "triangles") + " triangles; mean FLIP " +
         number_text(picture.flip_mean) + ", PSNR " +
         (picture.psnr ? number_text(*picture.psnr) + " dB" : "infinite: the same picture");
}

void write_cut(Markup& html, const ReportData& data, const View& view, const Shown& shown) {
  const Bytes* const heat = find_picture(data, shown.picture->heat);
  html.open("figure", {{"class", "cut"}, {"data-point", shown.point->id}, {"data-label", shown.point->label}});
  html.empty("img", {{"class", "over"},
                     {"alt", "View " + view.name + ", " + shown.point->label},
                     {"src", data_uri(*find_picture(data, shown.picture->picture))}});
  if (heat != nullptr) {
    html.empty("img", {{"class", "heat"},
                       {"alt", "Where " + shown.point->label + " differs in view " + view.name},
                       {"src", data_uri(*heat)}});
  }
  html.open("figcaption").name(shown.point->label).text(": " + figures_of(*shown.picture) + ". ");
  html.element("code", shown.point->draw_command).close();
  html.close().line();
}

std::size_t size_of(const ReportData& data, const Shown& shown) {
  const Bytes* const heat = find_picture(data, shown.picture->heat);
  return find_picture(data, shown.picture->picture)->size() + (heat != nullptr ? heat->size() : 0);
}

}  // namespace

PictureCount write_pictures(Markup& html, const ReportData& data, std::size_t most_bytes) {
  PictureCount count;
  std::size_t taken = 0;
  for (const View& view : data.views) {
    const Bytes* const full = find_picture(data, view.picture);
    if (full == nullptr) continue;
    const std::vector<Shown> all = pictures_of(data, view);
    html.open("h3").text("View ").name(view.name).close().line();
    html.open("div", {{"class", "stage"}, {"data-view", view.name}}).line();
    html.open("figure", {{"class", "full"}});
    html.empty("img", {{"alt", "View " + view.name + ", full resolution of the baseline"}, {"src", data_uri(*full)}});
    html.element("figcaption", "Full resolution of the baseline").close().line();
    taken += full->size();
    for (const Shown& shown : all) {
      const std::size_t size = size_of(data, shown);
      if (size > most_bytes - std::min(taken, most_bytes)) {
        ++count.left_out;
        continue;
      }
      taken += size;
      ++count.shown;
      write_cut(html, data, view, shown);
    }
    html.close().line();
  }
  return count;
}

}  // namespace meshlode::lab::page
