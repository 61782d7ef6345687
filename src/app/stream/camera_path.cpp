// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stream/camera_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/stream/words.h"
#include "base/printable.h"
#include "base/random.h"

namespace meshlode::app {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Result<PathRow> parse_row(std::string_view line, const std::string& where) {
  const auto fail = [&](const std::string& detail) { return Error{ErrorCode::kInvalid, where, detail}; };
  std::vector<std::string_view> cells = split_cells(line);
  PathRow row;
  row.fovy = kUsualFovyDegrees * kDegree;
  if (cells.back() == "cut") {
    row.is_cut = true;
    cells.pop_back();
  }
  if (cells.size() != 7 && cells.size() != 8) {
    return fail("expected t,ex,ey,ez,tx,ty,tz[,fovy][,cut]" + got_text(line));
  }
  double numbers[8] = {};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto number = parse_number(cells[i]);
    if (!number) return fail("expected a number of at most 1e15" + got_text(cells[i]));
    numbers[i] = *number;
  }
  row.seconds = numbers[0];
  row.eye = {numbers[1], numbers[2], numbers[3]};
  row.target = {numbers[4], numbers[5], numbers[6]};
  if (row.eye == row.target) return fail("eye and target are the same point");
  if (cells.size() == 8) {
    if (!(numbers[7] > 0.0 && numbers[7] < 180.0)) return fail("the field of view is between 0 and 180 degrees");
    row.fovy = numbers[7] * kDegree;
  }
  return row;
}

PathFrame frame_between(const PathRow& a, const PathRow& b, double seconds) {
  const bool moves = !b.is_cut && b.seconds > a.seconds;
  const double share = !moves ? 0.0 : std::clamp((seconds - a.seconds) / (b.seconds - a.seconds), 0.0, 1.0);
  PathFrame frame;
  frame.eye = a.eye + share * (b.eye - a.eye);
  frame.target = a.target + share * (b.target - a.target);
  frame.fovy = a.fovy + share * (b.fovy - a.fovy);
  if (frame.eye == frame.target) frame.target.z -= 1.0;  // where the two cross on the way
  return frame;
}

PathRow row_of(double seconds, const Vec3d& eye, const Vec3d& target) {
  return {seconds, eye, target, kUsualFovyDegrees * kDegree, false};
}

std::vector<PathRow> fly_path(const StreamScene& scene) {
  const Vec3d center = 0.5 * (scene.box.low + scene.box.high);
  const double radius = std::max(0.5 * glm::length(scene.box.size()), scene.object_radius * 1e-6);
  const auto around = [&](double turn, double distance) {
    const double angle = 2.0 * std::numbers::pi * turn;
    return center + radius * distance * Vec3d(0.9 * std::sin(angle), std::sqrt(1.0 - 0.81), 0.9 * std::cos(angle));
  };
  std::vector<PathRow> rows;
  constexpr int kSteps = 60;
  for (int i = 0; i <= kSteps; ++i) {  // nearer by the same factor from step to step
    const double share = static_cast<double>(i) / kSteps;
    rows.push_back(row_of(5.0 * share, around(0.0, 20.0 * std::pow(1.3 / 20.0, share)), center));
  }
  for (int i = 1; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    rows.push_back(row_of(5.0 + 5.0 * share, around(share, 1.3), center));
  }
  return rows;
}

std::vector<PathRow> walk_path(const StreamScene& scene) {
  const double radius = scene.object_radius;
  const Vec3d size = scene.box.size(), center = 0.5 * (scene.box.low + scene.box.high);
  const Vec3d ahead = size.x >= size.z ? Vec3d(1.0, 0.0, 0.0) : Vec3d(0.0, 0.0, 1.0);
  const double half = 0.5 * std::max(size.x, size.z) + radius;
  const double seconds = std::min(10.0, 2.0 * half / (2.5 * radius));
  Vec3d eye = center - half * ahead;
  eye.y = scene.box.high.y + 0.2 * radius;
  const Vec3d look = radius * (ahead - Vec3d(0.0, 0.45, 0.0));  // 24 degrees down
  const Vec3d end = eye + ahead * (2.5 * radius * seconds);
  return {row_of(0.0, eye, eye + look), row_of(seconds, end, end + look)};
}

std::vector<PathRow> turn_path(const StreamScene& scene) {
  const double radius = scene.object_radius;
  Vec3d eye = 0.5 * (scene.box.low + scene.box.high);
  eye.y = scene.box.high.y + 0.2 * radius;
  std::vector<PathRow> rows;
  constexpr int kSteps = 60;
  for (int i = -1; i <= kSteps; ++i) {
    const double turn = std::max(0, i) / static_cast<double>(kSteps), angle = 2.0 * std::numbers::pi * turn;
    const Vec3d look(std::sin(angle), -0.45, std::cos(angle));
    rows.push_back(row_of(i < 0 ? 0.0 : 0.5 + turn, eye, eye + radius * look));
  }
  return rows;
}

std::vector<PathRow> teleport_path(const StreamScene& scene) {
  const double radius = scene.object_radius;
  SplitMix64 random(1);
  std::vector<PathRow> rows;
  const Vec3d low = scene.box.low - Vec3d(radius, 0.0, radius), high = scene.box.high + Vec3d(radius, 0.0, radius);
  constexpr int kPlaces = 10;
  for (int i = 0; i < kPlaces; ++i) {
    const double x = random.between(low.x, high.x), z = random.between(low.z, high.z), up = random.between(0.1, 1.0);
    const double a = random.between(scene.box.low.x, scene.box.high.x),
                 b = random.between(scene.box.low.z, scene.box.high.z);
    const Vec3d eye(x, scene.box.high.y + up * radius, z), target(a, 0.5 * (scene.box.low.y + scene.box.high.y), b);
    rows.push_back(row_of(i, eye, target));
    rows.back().is_cut = i > 0;
  }
  rows.push_back(rows.back());
  rows.back().seconds = kPlaces;
  rows.back().is_cut = false;
  return rows;
}

}  // namespace

Result<std::vector<PathRow>> parse_path(std::string_view text, const std::string& where) {
  std::vector<PathRow> rows;
  LineReader lines(text);
  bool is_first = true;
  while (const auto line = lines.next()) {
    const bool is_heading = is_first && line->starts_with('t');
    is_first = false;
    if (is_heading) continue;
    const std::string place = where + ", line " + std::to_string(lines.number());
    if (rows.size() == kMostFrames) return Error{ErrorCode::kInvalid, place, "is the 100,001st row"};
    const Result<PathRow> row = parse_row(*line, place);
    if (!row) return row.error();
    if (!rows.empty() && !(row->seconds > rows.back().seconds)) {
      return Error{ErrorCode::kInvalid, place, "its time is not after that of the row before"};
    }
    rows.push_back(*row);
  }
  if (rows.empty()) return Error{ErrorCode::kInvalid, where, "has no row"};
  return rows;
}

Result<std::vector<PathFrame>> sample_path(std::span<const PathRow> rows, std::uint32_t fps, const std::string& where) {
  const double length = rows.back().seconds - rows.front().seconds;
  const double count = std::floor(length * fps + 1e-6) + 1.0;
  if (!(count <= kMostFrames)) return Error{ErrorCode::kInvalid, where, "the path has more than 100,000 frames"};
  std::vector<PathFrame> frames(static_cast<std::size_t>(count));
  std::size_t row = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double seconds = rows.front().seconds + static_cast<double>(i) / fps;
    bool is_jump = i == 0;
    while (row + 1 < rows.size() && rows[row + 1].seconds <= seconds + 1e-9) is_jump |= rows[++row].is_cut;
    frames[i] = frame_between(rows[row], rows[std::min(row + 1, rows.size() - 1)], seconds);
    frames[i].time_us = static_cast<std::int64_t>(i * std::uint64_t{1000000} / fps);
    frames[i].is_jump = is_jump;
  }
  return frames;
}

std::vector<PathRow> builtin_path(BuiltinPath path, const StreamScene& scene) {
  switch (path) {
    case BuiltinPath::kFly: return fly_path(scene);
    case BuiltinPath::kWalk: return walk_path(scene);
    case BuiltinPath::kTurn: return turn_path(scene);
    case BuiltinPath::kTeleport: break;
  }
  return teleport_path(scene);
}

}  // namespace meshlode::app
