// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/sample_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "base/json_writer.h"

namespace meshlode::lab::page {

namespace {

struct MadeUpKnob {
  const char *name, *title, *option;
  std::vector<const char*> values;
  std::size_t usual;
};

const std::vector<MadeUpKnob>& made_up_knobs() {
  static const std::vector<MadeUpKnob> knobs = {
      {"preset", "preset", "--preset", {"fast", "balanced", "best"}, 1},
      {"error", "error tier", "--error", {"qem", "measured", "certified"}, 1},
      {"position_error", "position budget", "--position-error", {"1e-5", "3e-5", "1e-4", "3e-4"}, 2},
      {"normal_error", "normal budget", "--normal-error", {"0.25", "0.5", "1"}, 1},
      {"codec", "codec", "--codec", {"none", "lz4", "zstd", "strips", "draco"}, 2},
      {"cluster", "cluster size", "--cluster-triangles", {"64", "128", "256"}, 1},
      {"quadrics", "quadrics", "--care", {"double", "float"}, 0},
      {"pixel_error", "pixel error", "--pixel-error", {"0.5", "1", "2", "4"}, 1},
  };
  return knobs;
}

struct MadeUpMetric {
  const char *key, *title, *unit, *group;
  bool is_less_better, is_timed;
  double usual, slope;  ///< by how much the place of a knob's value moves it
};

constexpr std::array kMadeUpMetrics = {
    MadeUpMetric{"build_user_seconds", "build, processor time", "seconds", "build", true, true, 8.5, 0.31},
    MadeUpMetric{"build_peak_bytes", "build, peak memory", "bytes", "build", true, true, 3.1e8, 0.05},
    MadeUpMetric{"file_bytes", "file", "bytes", "size", true, false, 7.2e5, 0.17},
    MadeUpMetric{"decoded_bytes", "geometry in memory", "bytes", "size", true, false, 1.4e6, 0.09},
    MadeUpMetric{"deviation", "deviation, largest", "share", "accuracy", true, false, 9e-5, -0.6},
    MadeUpMetric{"normal_rms", "normals, RMS", "degrees", "accuracy", true, false, 0.31, -0.2},
    MadeUpMetric{"triangles_at_max", "triangles at largest deviation 0.001", "triangles", "triangles", true, false,
                 9100.0, -0.04},
    MadeUpMetric{"load_seconds", "load", "seconds", "load", true, true, 0.0021, 0.02},
    MadeUpMetric{"psnr", "PSNR", "dB", "picture", false, false, 38.0, 0.05},
    MadeUpMetric{"flip", "FLIP, mean", "", "picture", true, false, 0.021, -0.3},
};

/// One value of each knob, as places in their lists.
struct MadeUpPoint {
  std::string id, label;
  std::vector<std::size_t> places;
  std::vector<std::size_t> changed;
};

std::vector<MadeUpPoint> made_up_points() {
  const auto& knobs = made_up_knobs();
  MadeUpPoint base{"p0", "baseline", {}, {}};
  for (const MadeUpKnob& knob : knobs) base.places.push_back(knob.usual);
  std::vector<MadeUpPoint> points = {base};
  const auto add = [&](const std::vector<std::pair<std::size_t, std::size_t>>& turned) {
    MadeUpPoint point = base;
    point.id = "p" + std::to_string(points.size());
    point.label.clear();
    for (const auto& [knob, place] : turned) {
      point.places[knob] = place;
      point.changed.push_back(knob);
      point.label +=
          (point.label.empty() ? "" : ", ") + std::string(knobs[knob].title) + " " + knobs[knob].values[place];
    }
    points.push_back(point);
  };
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    for (std::size_t place = 0; place < knobs[k].values.size(); ++place) {
      if (place != knobs[k].usual) add({{k, place}});
    }
  }
  add({{0, 2}, {2, 0}});
  add({{4, 3}, {2, 3}});
  return points;
}

/// A number in [-1, 1] that looks like chance.
double wobble(std::size_t a, std::size_t b) {
  return std::sin(12.9898 * static_cast<double>(a + 1) + 78.233 * static_cast<double>(b + 1));
}

double made_up_figure(std::size_t number, const MadeUpPoint& point, std::size_t metric) {
  double steps = 0.0;
  for (const std::size_t k : point.changed) {
    steps += (static_cast<double>(point.places[k]) - static_cast<double>(made_up_knobs()[k].usual)) *
             (1.0 + 0.7 * wobble(k, metric));
  }
  return kMadeUpMetrics[metric].usual * std::exp(kMadeUpMetrics[metric].slope * steps) *
         (1.0 + 0.02 * wobble(number, metric));
}

void write_figures(JsonWriter& w, std::size_t number, const MadeUpPoint& point) {
  w.key("figures");
  w.begin_object();
  for (std::size_t m = 0; m < kMadeUpMetrics.size(); ++m) {
    const double value = made_up_figure(number, point, m);
    w.key(kMadeUpMetrics[m].key);
    w.begin_object();
    const bool is_count =
        std::string_view(kMadeUpMetrics[m].unit) == "bytes" || std::string_view(kMadeUpMetrics[m].unit) == "triangles";
    w.field("value", is_count ? std::floor(value) : value);
    if (kMadeUpMetrics[m].is_timed) {
      w.field("min", value * 0.97);
      w.field("max", value * 1.04);
      w.field("n", 3);
      w.field("range_low", value * 0.97);
      w.field("range_high", value * 1.04);
    }
    w.end_object();
  }
  w.end_object();
}

void write_asset(JsonWriter& w, std::size_t number, const MadeUpPoint& point) {
  static constexpr std::array<std::pair<const char*, double>, 9> kShares = {{{"PAGE", 0.81},
                                                                             {"CLUS", 0.07},
                                                                             {"GRPS", 0.05},
                                                                             {"NODE", 0.03},
                                                                             {"META", 0.02},
                                                                             {"STRS", 0.01},
                                                                             {"MATL", 0.005},
                                                                             {"INST", 0.004},
                                                                             {"PDEP", 0.001}}};
  w.key("asset");
  w.begin_object();
  w.key("sections");
  w.begin_array();
  for (const auto& [name, share] : kShares) {
    const double bytes = std::floor(share * made_up_figure(number, point, 2));
    w.begin_object();
    w.field("name", name);
    w.field("bytes", static_cast<std::uint64_t>(bytes));
    w.field("bytes_decoded", static_cast<std::uint64_t>(bytes * 1.9));
    w.end_object();
  }
  w.end_array();
  w.end_object();
}

void write_cuts(JsonWriter& w, std::size_t number, const MadeUpPoint& point) {
  static constexpr std::array kReach = {2.4, 0.83, 0.31};  // true over stored, of each tier
  w.key("cuts");
  w.begin_array();
  for (std::size_t i = 0; i < 9; ++i) {
    const double stored = 1e-5 * std::exp(0.9 * static_cast<double>(i));
    w.begin_object();
    w.field("threshold", stored * 1.1);
    w.field("triangles", static_cast<std::uint64_t>(69000.0 / std::pow(1.0 + stored * 4e4, 0.8)));
    w.field("stored", stored);
    w.field("max", stored * kReach[point.places[1]] * (1.0 + 0.17 * wobble(number, i + 20)));
    w.field("rms", stored * 0.2);
    w.end_object();
  }
  w.end_array();
  w.key("equal");
  w.begin_array();
  for (std::size_t i = 0; i < 7; ++i) {
    const double deviation = 1e-4 * std::pow(10.0, 0.4 * static_cast<double>(i));
    w.begin_object();
    w.field("figure", "max");
    w.field("x", deviation);
    w.field("triangles",
            static_cast<std::uint64_t>(made_up_figure(number, point, 6) * std::pow(1e-3 / deviation, 0.8)));
    w.field("threshold", deviation);
    w.end_object();
  }
  w.end_array();
}

void write_picture(JsonWriter& w, std::size_t number, const MadeUpPoint& point) {
  w.key("pictures");
  w.begin_array();
  if (number < 3) {
    w.begin_object();
    w.field("view", "front");
    w.field("triangles", static_cast<std::uint64_t>(made_up_figure(number, point, 6)));
    w.field("clusters", 90);
    w.field("psnr", made_up_figure(number, point, 8));
    w.field("flip_mean", made_up_figure(number, point, 9));
    w.field("flip_median", 0.03);
    w.field("flip_max", 0.6);
    w.field("picture", "pictures/" + point.id + ".png");
    w.field("heat", "pictures/" + point.id + "-heat.png");
    w.end_object();
  }
  w.end_array();
}

void write_point(JsonWriter& w, std::size_t number, const MadeUpPoint& point) {
  const auto& knobs = made_up_knobs();
  w.begin_object();
  w.field("id", point.id);
  w.field("label", point.label);
  w.field("why", point.changed.empty() ? "baseline" : point.changed.size() == 1 ? "one_factor" : "corner");
  w.field("experimental", point.places[6] == 1);
  std::string command = "meshlode build made-up.glb -o p.lode";
  for (const std::size_t k : point.changed)
    command += std::string(" ") + knobs[k].option + " " + knobs[k].values[point.places[k]];
  w.field("command", command);
  w.field("draw_command", "meshlode render p.lode -o p.png --pixel-error 1");
  w.field("status", "done");
  w.key("error");
  w.null();
  w.field("content_hash", "hash-" + point.id);
  w.key("same_asset_as");
  w.null();
  w.key("settings");
  w.begin_object();
  for (std::size_t k = 0; k < knobs.size(); ++k) w.field(knobs[k].name, knobs[k].values[point.places[k]]);
  w.end_object();
  w.key("changed");
  w.begin_array();
  for (const std::size_t k : point.changed) w.value(knobs[k].name);
  w.end_array();
  write_figures(w, number, point);
  write_asset(w, number, point);
  write_cuts(w, number, point);
  write_picture(w, number, point);
  w.key("dominated_by");
  w.begin_array();
  if (number % 4 == 3) w.value("p0");
  w.end_array();
  w.end_object();
}

void write_head(JsonWriter& w, const std::string& scene) {
  w.field("sweep_version", 1);
  w.key("scene");
  w.begin_object();
  w.field("file", scene);
  w.field("hash", "0123456789abcdef0123456789abcdef");
  w.field("meshes", 3);
  w.field("instances", 5);
  w.field("triangles", 69451);
  w.field("vertices", 35947);
  w.end_object();
  w.key("program");
  w.begin_object();
  w.field("version", "0.0.0");
  w.field("id", "made up");
  w.end_object();
  w.key("machine");
  w.begin_object();
  w.field("name", "a machine that was made up");
  w.field("threads", 2);
  w.field("memory_bytes", std::uint64_t{8} << 30);
  w.field("system", "Made-up OS 1.0");
  w.key("vulkan");
  w.null();
  w.field("vulkan_reason", "this sweep was made up");
  w.end_object();
  w.field("command", "meshlode sweep made-up.glb -o report --budget 5m");
  w.field("budget_seconds", 300);
  w.field("spent_seconds", 287.5);
  w.field("rounds", 3);
  w.field("complete", true);
  w.field("samples", 200000);
  w.field("seed", 1);
  w.field("baseline", "p0");
}

/// A fault in six meshes and one of the scene.
void write_doctor(JsonWriter& w) {
  w.key("doctor");
  w.begin_object();
  w.field("command", "meshlode doctor made-up.glb");
  w.key("faults");
  w.begin_array();
  for (const bool is_of_scene : {false, true}) {
    w.begin_object();
    w.field("id", is_of_scene ? "undrawn-meshes" : "needles");
    w.field("title", is_of_scene ? "meshes that no node draws" : "triangles much longer than high");
    w.field("severity", is_of_scene ? "low" : "high");
    w.field("share", is_of_scene ? 0.0 : 0.34);
    w.field("count", is_of_scene ? 1 : 6000);
    w.field("remedy", is_of_scene ? "delete them" : "remesh");
    if (!is_of_scene) w.field("hard_case", "needles");
    w.key("places");
    w.begin_array();
    for (int i = 0; i < (is_of_scene ? 1 : 6); ++i) {
      w.begin_object();
      w.field("where", is_of_scene ? "scene" : "mesh " + std::to_string(i) + " 'made up'");
      w.field("detail", is_of_scene ? "mesh 2" : "1,000 triangles");
      w.key("costs");
      w.begin_array();
      w.begin_object();
      w.field("kind", "bytes");
      w.field("amount", 1234.0);
      w.field("unit", "asset bytes");
      w.end_object();
      w.end_array();
      w.end_object();
    }
    w.end_array();
    w.end_object();
  }
  w.end_array();
  w.end_object();
}

void write_axes(JsonWriter& w) {
  w.key("knobs");
  w.begin_array();
  for (const MadeUpKnob& knob : made_up_knobs()) {
    w.begin_object();
    w.field("name", knob.name);
    w.field("title", knob.title);
    w.field("option", knob.option);
    w.field("unit", "");
    w.field("usual", knob.values[knob.usual]);
    w.key("values");
    w.begin_array();
    for (const char* value : knob.values) w.value(value);
    w.end_array();
    w.end_object();
  }
  w.end_array();
  w.key("metrics");
  w.begin_array();
  for (const MadeUpMetric& metric : kMadeUpMetrics) {
    w.begin_object();
    w.field("key", metric.key);
    w.field("title", metric.title);
    w.field("unit", metric.unit);
    w.field("better", metric.is_less_better ? "less" : "more");
    w.field("group", metric.group);
    w.field("timed", metric.is_timed);
    w.field("description", "made up by a formula");
    w.end_object();
  }
  w.end_array();
  w.key("views");
  w.begin_array();
  w.begin_object();
  w.field("name", "front");
  w.field("picture", "pictures/full.png");
  w.end_object();
  w.end_array();
}

/// Points that no other beats in both figures, by ascending x.
void write_frontier(JsonWriter& w, const std::vector<MadeUpPoint>& points, std::size_t x, std::size_t y) {
  std::map<double, std::string> best;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool is_beaten = false;
    for (std::size_t j = 0; j < points.size(); ++j) {
      is_beaten |= made_up_figure(j, points[j], x) < made_up_figure(i, points[i], x) &&
                   made_up_figure(j, points[j], y) < made_up_figure(i, points[i], y);
    }
    if (!is_beaten) best[made_up_figure(i, points[i], x)] = points[i].id;
  }
  w.begin_object();
  w.field("x", kMadeUpMetrics[x].key);
  w.field("y", kMadeUpMetrics[y].key);
  w.key("points");
  w.begin_array();
  for (const auto& [value, id] : best) w.value(id);
  w.end_array();
  w.end_object();
}

void write_answers(JsonWriter& w, const std::vector<MadeUpPoint>& points) {
  w.key("frontiers");
  w.begin_array();
  write_frontier(w, points, 0, 4);
  write_frontier(w, points, 2, 4);
  w.end_array();
  w.key("recommendations");
  w.begin_array();
  for (const bool is_kept : {true, false}) {
    w.begin_object();
    w.field("want", is_kept ? "deviation<=1e-4, bytes min" : "deviation<=1e-9, time min");
    w.field("goal", is_kept ? "file_bytes" : "build_user_seconds");
    w.key("point");
    is_kept ? w.value("p2") : w.null();
    w.key("command");
    is_kept ? w.value("meshlode build made-up.glb -o made-up.lode --preset best") : w.null();
    w.key("value");
    is_kept ? w.value(700000.0) : w.null();
    w.key("as_good");
    w.begin_array();
    if (is_kept) w.value("p0");
    w.end_array();
    w.key("not_compared");
    w.begin_array();
    w.end_array();
    w.field("why", is_kept ? "It was made up to be the smallest of those within the bound." : "The least was 3e-6.");
    w.end_object();
  }
  w.end_array();
  w.key("left_out");
  w.begin_array();
  w.begin_object();
  w.field("label", "preset best, codec draco");
  w.field("reason", "budget");
  w.field("command", "meshlode build made-up.glb -o p.lode --preset best --codec draco");
  w.field("estimated_seconds", 41.0);
  w.end_object();
  w.end_array();
}

// --- PNG, with deflate's stored blocks: no library needed ---

using Bytes = std::vector<std::uint8_t>;

void put_32(Bytes& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::uint32_t crc_of(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void put_chunk(Bytes& out, std::string_view kind, const Bytes& body) {
  put_32(out, static_cast<std::uint32_t>(body.size()));
  Bytes checked(kind.begin(), kind.end());
  checked.insert(checked.end(), body.begin(), body.end());
  out.insert(out.end(), checked.begin(), checked.end());
  put_32(out, crc_of(checked));
}

Bytes png_of(std::uint32_t width, std::uint32_t height, const Bytes& rgb) {
  Bytes raw;
  for (std::uint32_t y = 0; y < height; ++y) {
    raw.push_back(0);
    raw.insert(raw.end(), rgb.begin() + 3 * width * y, rgb.begin() + 3 * width * (y + 1));
  }
  Bytes packed = {0x78, 0x01};
  std::uint32_t a = 1, b = 0;
  for (std::size_t begin = 0; begin < raw.size(); begin += 65535) {
    const std::size_t size = std::min<std::size_t>(65535, raw.size() - begin);
    packed.push_back(begin + size == raw.size() ? 1 : 0);
    for (const std::size_t value : {size, size ^ 0xFFFFU}) {
      packed.push_back(static_cast<std::uint8_t>(value & 0xFF));
      packed.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFF));
    }
    packed.insert(packed.end(), raw.begin() + static_cast<std::ptrdiff_t>(begin),
                  raw.begin() + static_cast<std::ptrdiff_t>(begin + size));
  }
  for (const std::uint8_t byte : raw) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  put_32(packed, b << 16 | a);
  Bytes out = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  Bytes head;
  put_32(head, width);
  put_32(head, height);
  head.insert(head.end(), {8, 2, 0, 0, 0});
  put_chunk(out, "IHDR", head);
  put_chunk(out, "IDAT", packed);
  put_chunk(out, "IEND", {});
  return out;
}

/// A shaded polygon of so many corners: a disc where there are many.
Bytes shade(int corners) {
  constexpr std::uint32_t kWidth = 160, kHeight = 120;
  Bytes rgb;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const double dx = static_cast<double>(x) - 80.0, dy = static_cast<double>(y) - 60.0;
      const double sector = 6.283185307179586 / corners, angle = std::atan2(dy, dx) + 6.283185307179586;
      const double folded = angle - sector * (std::floor(angle / sector) + 0.5);
      const bool is_inside = std::hypot(dx, dy) * std::cos(folded) < 50.0 * std::cos(sector / 2.0);
      const auto light = static_cast<std::uint8_t>(is_inside ? 150.0 - dx - dy * 0.5 : 24.0);
      rgb.insert(rgb.end(), {light, static_cast<std::uint8_t>(light * 3 / 4), static_cast<std::uint8_t>(light / 2)});
    }
  }
  return rgb;
}

}  // namespace

std::string made_up_sweep(const std::string& scene) {
  const std::vector<MadeUpPoint> points = made_up_points();
  JsonWriter w;
  w.begin_object();
  write_head(w, scene);
  write_doctor(w);
  write_axes(w);
  w.key("points");
  w.begin_array();
  for (std::size_t i = 0; i < points.size(); ++i) write_point(w, i, points[i]);
  w.end_array();
  write_answers(w, points);
  w.end_object();
  return w.text();
}

std::map<std::string, std::vector<std::uint8_t>> made_up_pictures() {
  std::map<std::string, Bytes> pictures;
  const Bytes full = shade(60);
  pictures["pictures/full.png"] = png_of(160, 120, full);
  for (int i = 0; i < 3; ++i) {
    const Bytes cut = shade(6 + 3 * i);
    Bytes heat(cut.size());
    for (std::size_t k = 0; k < cut.size(); ++k) heat[k] = static_cast<std::uint8_t>(cut[k] != full[k] ? 220 : 4);
    pictures["pictures/p" + std::to_string(i) + ".png"] = png_of(160, 120, cut);
    pictures["pictures/p" + std::to_string(i) + "-heat.png"] = png_of(160, 120, heat);
  }
  return pictures;
}

}  // namespace meshlode::lab::page
