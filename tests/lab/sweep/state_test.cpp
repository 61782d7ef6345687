// SPDX-License-Identifier: GPL-3.0-or-later
// What was measured is there again, whatever happened to the file.
#include "lab/sweep/state.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <unistd.h>

#include "lab/sweep/measurement_json.h"

namespace meshlode::lab {
namespace {

namespace fs = std::filesystem;

Measurement sample(MeasurementKind kind, const std::string& key, std::uint32_t round) {
  Measurement m;
  m.kind = kind;
  m.key = key;
  m.round = round;
  m.seconds = 1.25;
  m.figures = {{"build_user_seconds", 0.1 + round}, {"file_bytes", 12345.0}};
  m.asset = {"00ff", R"({"codec":"none"})", 7, 3, 2, 1, 900, 800, {600, 300}, {{"PAGE", 100, 200}, {"MESH", 8, 8}}};
  m.cuts = {{0.0, 600, 1e-5, 2e-5, 1e-6, 0.5, std::nullopt}, {1e-3, 300, 1e-3, 9e-4, 1e-4, std::nullopt, 0.25}};
  m.equal = {{"max", 1e-3, 320, 9.5e-4}, {"rms", 3e-4, std::nullopt, std::nullopt}};
  m.pictures = {{"near", 600, 7, std::nullopt, 0.0, 0.0, 0.0, "a.png", "b.png"}};
  return m;
}

class SweepState : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sweep-state-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    file_ = folder_ / "state.txt";
    fs::remove(file_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string text() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }

  fs::path folder_, file_;
};

TEST_F(SweepState, ALineIsTheMeasurement) {
  const Measurement m = sample(MeasurementKind::kAsset, "codec=strips\n", 0);
  const std::string line = measurement_line(m);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto back = read_measurement(line);
  ASSERT_TRUE(back);
  EXPECT_EQ(measurement_line(*back), line);
  EXPECT_TRUE(back->is_stored);
  EXPECT_EQ(back->key, m.key);
  EXPECT_EQ(back->cuts[1].uv, 0.25);
  EXPECT_FALSE(back->cuts[0].uv.has_value());
  EXPECT_FALSE(back->equal[1].triangles.has_value());
  EXPECT_EQ(back->asset.sections[0].bytes_decoded, 200U);
}

TEST_F(SweepState, WhatWasAddedIsThereAgain) {
  {
    auto state = State::open(file_, "a");
    ASSERT_TRUE(state);
    EXPECT_EQ(state->find(MeasurementKind::kBuild, "", 1), nullptr);
    ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "", 1)));
    ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "", 2)));
    EXPECT_FALSE(state->find(MeasurementKind::kBuild, "", 2)->is_stored);
  }
  const auto again = State::open(file_, "a");
  ASSERT_TRUE(again);
  ASSERT_NE(again->find(MeasurementKind::kBuild, "", 2), nullptr);
  EXPECT_TRUE(again->find(MeasurementKind::kBuild, "", 2)->is_stored);
  EXPECT_EQ(again->find(MeasurementKind::kBuild, "", 2)->figures.at("build_user_seconds"), 2.1);
  EXPECT_EQ(again->find(MeasurementKind::kBuild, "", 3), nullptr);
  EXPECT_EQ(again->find(MeasurementKind::kFrames, "", 2), nullptr);
  EXPECT_DOUBLE_EQ(again->spent(), 2.5);
}

TEST_F(SweepState, AnothersMeasurementsAreNotTaken) {
  auto state = State::open(file_, "a");
  ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "", 1)));
  EXPECT_EQ(State::open(file_, "b")->find(MeasurementKind::kBuild, "", 1), nullptr);
  EXPECT_EQ(State::open(file_, "")->find(MeasurementKind::kBuild, "", 1), nullptr);
  auto other = State::open(file_, "b");
  ASSERT_TRUE(other->add(sample(MeasurementKind::kBuild, "", 1)));
  EXPECT_NE(State::open(file_, "a")->find(MeasurementKind::kBuild, "", 1), nullptr) << "both lie side by side";
}

/// Killed at any byte of the last line: the line before is there, and the next one comes out whole.
TEST_F(SweepState, ALineThatIsCutOffIsNotThere) {
  auto state = State::open(file_, "a");
  ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "", 1)));
  const std::size_t first = text().size();
  ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "", 2)));
  const std::string whole = text();
  for (std::size_t length = first; length < whole.size(); length += 7) {
    write(whole.substr(0, length));
    auto cut = State::open(file_, "a");
    ASSERT_TRUE(cut);
    EXPECT_NE(cut->find(MeasurementKind::kBuild, "", 1), nullptr) << length;
    EXPECT_EQ(cut->find(MeasurementKind::kBuild, "", 2), nullptr) << length;
    ASSERT_TRUE(cut->add(sample(MeasurementKind::kBuild, "", 3)));
    const auto after = State::open(file_, "a");
    EXPECT_NE(after->find(MeasurementKind::kBuild, "", 1), nullptr) << length;
    EXPECT_NE(after->find(MeasurementKind::kBuild, "", 3), nullptr) << length;
  }
}

TEST_F(SweepState, AChangedByteLosesItsLineAndNoOther) {
  auto state = State::open(file_, "a");
  for (std::uint32_t round = 1; round <= 3; ++round) {
    ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "", round)));
  }
  const std::string whole = text();
  const std::size_t line = whole.size() / 3;
  for (std::size_t at = line; at < 2 * line - 1; at += 11) {
    std::string broken = whole;
    broken[at] = static_cast<char>(broken[at] ^ 1);
    write(broken);
    const auto after = State::open(file_, "a");
    ASSERT_TRUE(after);
    EXPECT_NE(after->find(MeasurementKind::kBuild, "", 1), nullptr) << at;
    EXPECT_EQ(after->find(MeasurementKind::kBuild, "", 2), nullptr) << at;
    EXPECT_NE(after->find(MeasurementKind::kBuild, "", 3), nullptr) << at;
  }
}

TEST_F(SweepState, HostileLinesAreNone) {
  const std::string line = measurement_line(sample(MeasurementKind::kAsset, "k", 0));
  EXPECT_FALSE(read_measurement(""));
  EXPECT_FALSE(read_measurement("{}"));
  EXPECT_FALSE(read_measurement(std::string(100000, '[')));
  for (std::size_t length = 0; length < line.size(); ++length) EXPECT_FALSE(read_measurement(line.substr(0, length)));
  for (std::size_t at = 0; at < line.size(); ++at) {
    for (const char c : {'"', '{', ']', '-', '9', 'n', '\0'}) {
      std::string changed = line;
      changed[at] = c;
      if (const auto m = read_measurement(changed)) {
        EXPECT_FALSE(measurement_line(*m).empty());
      }
    }
  }
}

TEST_F(SweepState, WhatIsKeptForThisRunIsNotThereInTheNext) {
  {
    auto state = State::open(file_, "print");
    ASSERT_TRUE(state);
    state->keep_for_this_run(sample(MeasurementKind::kBuild, "killed", 1));
    ASSERT_TRUE(state->add(sample(MeasurementKind::kBuild, "done", 1)));
    EXPECT_NE(state->find(MeasurementKind::kBuild, "killed", 1), nullptr);
  }
  const auto again = State::open(file_, "print");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->find(MeasurementKind::kBuild, "killed", 1), nullptr);
  EXPECT_NE(again->find(MeasurementKind::kBuild, "done", 1), nullptr);
}

}  // namespace
}  // namespace meshlode::lab
