// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_report.h"

#include <algorithm>
#include <cstdio>

#include "base/append_format.h"
#include "base/json_writer.h"

namespace meshlode::bench {
namespace {

/// The worse of both directions.
judge::OneWayDrift worse(const judge::OneWayDrift& a, const judge::OneWayDrift& b) {
  return {std::max(a.rms, b.rms), std::max(a.p99, b.p99), std::max(a.max, b.max), a.points + b.points};
}

void add_cut(std::string& out, const MeasuredCut& cut, double diagonal) {
  const judge::CutFigures& f = cut.figures;
  append_format(out, "%9llu  %9.3e %9.3e  %9.3e %9.3e", static_cast<unsigned long long>(f.triangles),
                f.max() / diagonal, f.rms() / diagonal, f.max_to_cut / diagonal, f.max_to_source / diagonal);
  if (cut.stored > 0.0) append_format(out, "  %9.3e %6.3f", cut.stored, f.max() / diagonal / cut.stored);
  if (cut.drift && cut.drift->has_normals()) {
    const judge::OneWayDrift n = worse(cut.drift->normal_a_to_b, cut.drift->normal_b_to_a);
    append_format(out, "  normals %.2f deg rms, %.2f p99, %.1f max", n.rms, n.p99, n.max);
  }
  if (cut.drift && cut.drift->has_uvs()) {
    const judge::OneWayDrift u = worse(cut.drift->uv_a_to_b, cut.drift->uv_b_to_a);
    append_format(out, "  UVs %.2e rms, %.2e p99, %.2e max", u.rms, u.p99, u.max);
  }
  out += "\n";
}

void write_drift(JsonWriter& w, const char* name, const judge::OneWayDrift& there, const judge::OneWayDrift& back) {
  w.key(name);
  w.begin_object();
  const judge::OneWayDrift both = worse(there, back);
  w.field("rms", both.rms);
  w.field("p99", both.p99);
  w.field("max", both.max);
  w.field("rms_to_cut", there.rms);
  w.field("rms_to_source", back.rms);
  w.end_object();
}

void write_cut(JsonWriter& w, const MeasuredCut& cut, double diagonal) {
  w.field("threshold", cut.threshold);
  w.field("triangles", cut.figures.triangles);
  w.field("max", cut.figures.max() / diagonal);
  w.field("rms", cut.figures.rms() / diagonal);
  w.field("max_to_cut", cut.figures.max_to_cut / diagonal);
  w.field("max_to_source", cut.figures.max_to_source / diagonal);
  w.field("rms_to_cut", cut.figures.rms_to_cut / diagonal);
  w.field("rms_to_source", cut.figures.rms_to_source / diagonal);
  w.field("stored", cut.stored);
  if (cut.drift && cut.drift->has_normals()) {
    write_drift(w, "normal_degrees", cut.drift->normal_a_to_b, cut.drift->normal_b_to_a);
  }
  if (cut.drift && cut.drift->has_uvs()) write_drift(w, "uv", cut.drift->uv_a_to_b, cut.drift->uv_b_to_a);
}

}  // namespace

std::string quality_text(const MeshQuality& mesh) {
  std::string out;
  append_format(out, "%s: %llu source triangles, diagonal %.6g, tier %s. Deviations are shares of the diagonal.\n",
                mesh.name.c_str(), static_cast<unsigned long long>(mesh.source_triangles), mesh.diagonal,
                mesh.tier.c_str());
  for (const std::string& note : mesh.notes) out += "  " + note + "\n";
  if (!mesh.cuts.empty()) {
    append_format(out, "  %9s  %9s  %9s %9s  %9s %9s  %9s %6s\n", "threshold", "triangles", "max", "rms", "to cut",
                  "to source", "stored", "true/");
    std::vector<double> ratios;
    for (const MeasuredCut& cut : mesh.cuts) {
      append_format(out, "  %9.3e  ", cut.threshold);
      add_cut(out, cut, mesh.diagonal);
      if (cut.stored > 0.0) ratios.push_back(cut.figures.max() / mesh.diagonal / cut.stored);
    }
    std::sort(ratios.begin(), ratios.end());
    if (!ratios.empty()) {
      append_format(out, "  true/stored: median %.3f, largest %.3f over %zu cuts, %td above 1\n",
                    ratios[ratios.size() / 2], ratios.back(), ratios.size(),
                    ratios.end() - std::upper_bound(ratios.begin(), ratios.end(), 1.0));
    }
  }
  for (const EqualDeviation& equal : mesh.equal) {
    append_format(out, "  %s, %s <= %.0e: ", equal.method.c_str(), equal.figure.c_str(), equal.x);
    if (!equal.cut) {
      append_format(out, "none (%.1f s)\n", equal.seconds);
      continue;
    }
    add_cut(out, *equal.cut, mesh.diagonal);
    if (equal.cuts_of_mesh > 0) {
      append_format(out, "      cut at %.6e, %zu of %zu cuts tried, %.1f s\n", equal.cut->threshold,
                    equal.cuts_measured, equal.cuts_of_mesh, equal.seconds);
    } else {
      append_format(out, "      %zu surfaces measured, %.1f s\n", equal.cuts_measured, equal.seconds);
    }
  }
  return out;
}

std::string quality_json(const std::string& scene, const std::string& asset, const std::vector<MeshQuality>& meshes) {
  JsonWriter w;
  w.begin_object();
  w.field("scene", scene);
  w.field("asset", asset);
  w.key("meshes");
  w.begin_array();
  for (const MeshQuality& mesh : meshes) {
    w.begin_object();
    w.field("name", mesh.name);
    w.field("source_triangles", mesh.source_triangles);
    w.field("diagonal", mesh.diagonal);
    w.field("tier", mesh.tier);
    w.key("notes");
    w.begin_array();
    for (const std::string& note : mesh.notes) w.value(note);
    w.end_array();
    w.key("cuts");
    w.begin_array();
    for (const MeasuredCut& cut : mesh.cuts) {
      w.begin_object();
      write_cut(w, cut, mesh.diagonal);
      w.end_object();
    }
    w.end_array();
    w.key("equal_deviation");
    w.begin_array();
    for (const EqualDeviation& equal : mesh.equal) {
      w.begin_object();
      w.field("method", equal.method);
      w.field("figure", equal.figure);
      w.field("x", equal.x);
      w.field("is_found", equal.cut.has_value());
      if (equal.cut) write_cut(w, *equal.cut, mesh.diagonal);
      w.field("cuts_measured", equal.cuts_measured);
      w.field("cuts_of_mesh", equal.cuts_of_mesh);
      w.field("seconds", equal.seconds);
      w.end_object();
    }
    w.end_array();
    w.end_object();
  }
  w.end_array();
  w.end_object();
  return w.text();
}

}  // namespace meshlode::bench
