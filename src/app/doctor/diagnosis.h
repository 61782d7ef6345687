// SPDX-License-Identifier: GPL-3.0-or-later
// What `meshlode doctor` says: faults in words, worst first, as text and as JSON. Where they come from is somebody
// else's: a source (scene/detect/) or an asset (out/doctor/asset_faults.h).
// The JSON's keys are a promise (docs/schemas/doctor.schema.json), and so are ids: --fail-on names them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "base/json_writer.h"

namespace meshlode::app {

struct DiagnosisCost {
  std::string kind;     ///< "bytes", "accuracy" or "time"
  double amount = 0.0;  ///< in `unit`
  std::string unit;     ///< "asset bytes", "source bytes", "object units", "triangles"
};

/// A triangle of a source: indices 3 · triangle … of a primitive of the place's mesh.
struct DiagnosisTriangle {
  std::uint32_t primitive = 0, triangle = 0;
};

/// One mesh that has the fault, or the scene.
struct DiagnosisPlace {
  std::string where;         ///< as mesh_words() has it, "scene", or what was left out
  std::uint32_t mesh = ~0U;  ///< ~0: the scene
  std::uint64_t count = 0;   ///< of what the diagnosis counts
  std::uint64_t triangle_count = 0;
  std::string detail;                        ///< in words what was counted, and the figure that goes with it
  double share = 0.0;                        ///< of the whole scene, 0 … 1, estimated: what it is ranked by
  std::vector<DiagnosisTriangle> triangles;  ///< the first of those concerned
  std::vector<std::uint32_t> groups;         ///< of an asset: the first of its groups that are concerned
  std::vector<DiagnosisCost> costs;          ///< the largest share first
};

/// A fault wherever it is.
struct Diagnosis {
  std::string id;      ///< stable, words with hyphens
  std::string title;   ///< what is counted, in the plural
  std::string remedy;  ///< what to do about it
  std::string
      hard_case;  ///< the case of docs/reference/hard-cases.md that tries it along a parameter; empty: there is none
  std::uint64_t count = 0;
  double share = 0.0;  ///< sum over its places, at most 1
  std::vector<DiagnosisPlace> places;
};

/// From a tenth of the scene "high", from a hundredth "medium", else "low".
[[nodiscard]] const char* severity_of(double share);

/// "mesh 3 'rock'", "mesh 3" where it has no name; without control characters.
[[nodiscard]] std::string mesh_words(std::uint32_t mesh, std::string_view name);

/// "1 triangle", "1,234 triangles": `many` is the word in the plural, with an s, "meshes" or "vertices".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view many);

constexpr const char* kLeftOutId = "left-out";
/// What an import has not handed on, of a source and of an asset alike; it has no share.
void add_left_out(std::vector<Diagnosis>& diagnoses, std::string_view what, std::string_view why);

/// Adds a place to the diagnosis of that id, which is made where there is none yet.
void add_place(std::vector<Diagnosis>& diagnoses, const Diagnosis& words, DiagnosisPlace place);

/// Worst first, places too; of equal shares the smaller id, the earlier mesh.
void rank(std::vector<Diagnosis>& diagnoses);

struct DoctorReport {
  std::string file;
  bool is_asset = false;
  std::uint64_t meshes = 0, triangles = 0;
  std::vector<Diagnosis> diagnoses;    ///< ranked
  std::vector<std::string> failed_on;  ///< ids that --fail-on asked for and that were found
};

[[nodiscard]] std::string doctor_text(const DoctorReport& report);
[[nodiscard]] std::string doctor_json(const DoctorReport& report);
/// The array `faults` of that JSON, for documents that have it too.
void write_diagnoses(JsonWriter& json, const std::vector<Diagnosis>& diagnoses);

/// "high, 34%": severity and share, which is left out where it is 0.
[[nodiscard]] std::string share_text(double share);
/// "bytes (about 1,234 of the asset)".
[[nodiscard]] std::string cost_text(const DiagnosisCost& cost);

/// "a,b": those of the words that were found; "any": whatever was, "medium" and "high": of that severity or a higher
/// one. Errors: kUsage for a word that is none of these and no id of `known`, with the nearest that is.
[[nodiscard]] Result<std::vector<std::string>> find_failures(std::string_view words,
                                                             const std::vector<std::string>& known,
                                                             const std::vector<Diagnosis>& diagnoses);

}  // namespace meshlode::app
