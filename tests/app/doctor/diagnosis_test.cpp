// SPDX-License-Identifier: GPL-3.0-or-later
// Diagnoses are put together by id, ranked worst first, and told the same way each time.
#include "app/doctor/diagnosis.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

Diagnosis words_of(const char* id) {
  Diagnosis words;
  words.id = id;
  words.title = "a title";
  words.remedy = "a remedy";
  return words;
}

DiagnosisPlace place_of(std::uint32_t mesh, std::uint64_t count, double share) {
  DiagnosisPlace place;
  place.mesh = mesh;
  place.where = "mesh " + std::to_string(mesh);
  place.count = count;
  place.share = share;
  place.detail = "a detail";
  return place;
}

std::vector<Diagnosis> three() {
  std::vector<Diagnosis> diagnoses;
  add_place(diagnoses, words_of("b"), place_of(0, 5, 0.005));
  add_place(diagnoses, words_of("a"), place_of(0, 1, 0.1));
  add_place(diagnoses, words_of("c"), place_of(1, 2, 0.2));
  add_place(diagnoses, words_of("a"), place_of(2, 7, 0.3));
  rank(diagnoses);
  return diagnoses;
}

TEST(Diagnosis, PlacesOfOneFaultAreAddedUpAndTheWorstIsFirst) {
  const std::vector<Diagnosis> diagnoses = three();
  ASSERT_EQ(diagnoses.size(), 3U);
  EXPECT_EQ(diagnoses[0].id, "a");
  EXPECT_EQ(diagnoses[0].count, 8U);
  EXPECT_DOUBLE_EQ(diagnoses[0].share, 0.4);
  EXPECT_EQ(diagnoses[0].places[0].mesh, 2U);
  EXPECT_EQ(diagnoses[1].id, "c");
  EXPECT_EQ(diagnoses[2].id, "b");
}

TEST(Diagnosis, EqualSharesGoByName) {
  std::vector<Diagnosis> diagnoses;
  for (const char* id : {"c", "a", "b"}) add_place(diagnoses, words_of(id), place_of(0, 1, 0.5));
  rank(diagnoses);
  EXPECT_EQ(diagnoses[0].id + diagnoses[1].id + diagnoses[2].id, "abc");
}

TEST(Diagnosis, SeverityIsAShareOfTheScene) {
  EXPECT_STREQ(severity_of(1.0), "high");
  EXPECT_STREQ(severity_of(0.1), "high");
  EXPECT_STREQ(severity_of(0.099), "medium");
  EXPECT_STREQ(severity_of(0.009), "low");
  EXPECT_STREQ(severity_of(0.0), "low");
}

TEST(Diagnosis, FailsOnWhatWasAskedForAndFound) {
  const std::vector<std::string> known{"a", "b", "c", "d"};
  const auto failures = [&](const char* words) { return find_failures(words, known, three()); };
  EXPECT_EQ(*failures("a"), std::vector<std::string>{"a"});
  EXPECT_TRUE(failures("d")->empty());
  EXPECT_EQ(*failures("d,b,b"), std::vector<std::string>{"b"});
  EXPECT_EQ(*failures("any"), (std::vector<std::string>{"a", "c", "b"}));
  EXPECT_EQ(*failures("high"), (std::vector<std::string>{"a", "c"}));
  EXPECT_EQ(*failures("medium,b"), (std::vector<std::string>{"a", "c", "b"}));
  EXPECT_NE(failures("hihg").error().detail.find("the nearest is high"), std::string::npos);
  for (const char* wrong : {"", "e", "a,e", ",a", "a b", "A", "low"}) {
    const auto result = failures(wrong);
    ASSERT_FALSE(result.ok()) << wrong;
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
  }
}

TEST(Diagnosis, CountsAndNamesInWords) {
  EXPECT_EQ(counted(1, "triangles"), "1 triangle");
  EXPECT_EQ(counted(1, "meshes"), "1 mesh");
  EXPECT_EQ(counted(0, "meshes"), "0 meshes");
  EXPECT_EQ(counted(1234, "edges"), "1,234 edges");
  EXPECT_EQ(counted(1, "vertices"), "1 vertex");
  EXPECT_EQ(mesh_words(3, "a\nb"), "mesh 3 'a?b'");
  EXPECT_EQ(mesh_words(0, ""), "mesh 0");
}

TEST(Diagnosis, TheTextHasEachFaultWithItsPlacesAndItsRemedy) {
  DoctorReport report;
  report.file = "a.glb";
  report.diagnoses = three();
  report.diagnoses[0].places[0].triangles = {{1, 23}};
  report.diagnoses[0].places[0].triangle_count = 2;
  report.diagnoses[0].places[0].costs = {{"time", 1234.0, "triangles"}, {"accuracy", 0.5, "object units"}};
  const std::string text = doctor_text(report);
  for (const char* part : {" 1. a [high, 40%]: a title, 8 in all\n", " 3. b [low, 0.5%]: a title\n", "1:23 …",
                           "remedy: a remedy", "costs time (1,234 triangles), accuracy (0.5 object units)"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
  report.diagnoses.clear();
  EXPECT_NE(doctor_text(report).find("nothing found"), std::string::npos);
}

}  // namespace
}  // namespace meshlode::app
