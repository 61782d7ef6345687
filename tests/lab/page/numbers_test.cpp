// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/numbers.h"

#include <limits>

#include <gtest/gtest.h>

namespace meshlode::lab::page {
namespace {

TEST(Numbers, HaveAsManyDigitsAsAreAskedFor) {
  EXPECT_EQ(number_text(0.0), "0");
  EXPECT_EQ(number_text(1.0 / 3.0), "0.333");
  EXPECT_EQ(number_text(-12.5, 2), "-12");
  EXPECT_EQ(number_text(99999.0), "100000") << "rounded up to the next power";
  EXPECT_EQ(number_text(0.00012), "0.00012");
  EXPECT_EQ(number_text(1.3e-6), "1.3e-6");
  EXPECT_EQ(number_text(2e-5), "2e-5");
  EXPECT_EQ(number_text(1.2345e9, 4), "1.234e9") << "a tie goes to the even digit";
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "infinite");
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN()), "-");
  EXPECT_EQ(number_text(std::numeric_limits<double>::max()), "1.8e308");
}

TEST(Numbers, HaveTheUnitThatReadsBest) {
  EXPECT_EQ(amount_text(0.0832, "seconds"), "83.2 ms");
  EXPECT_EQ(amount_text(2e-6, "seconds"), "2 µs");
  EXPECT_EQ(amount_text(90.0, "seconds"), "90 s");
  EXPECT_EQ(amount_text(300.0, "seconds"), "5 min");
  EXPECT_EQ(amount_text(0.0, "seconds"), "0 s");
  EXPECT_EQ(amount_text(1.25e6, "bytes"), "1.25 MB");
  EXPECT_EQ(amount_text(999.0, "bytes"), "999 B");
  EXPECT_EQ(amount_text(0.0, "bytes"), "0 B");
  EXPECT_EQ(amount_text(1234567.0, "triangles"), "1,234,567");
  EXPECT_EQ(amount_text(-3.0, "triangles"), "-3");
  EXPECT_EQ(amount_text(38.25, "dB"), "38.2 dB");
  EXPECT_EQ(amount_text(1e-4, "share"), "0.0001");
}

TEST(Numbers, SayAChangeAsPeopleDo) {
  EXPECT_EQ(change_text(2.0, 2.0), "same");
  EXPECT_EQ(change_text(2.0, 2.25), "+12%");
  EXPECT_EQ(change_text(2.0, 1.5), "-25%");
  EXPECT_EQ(change_text(1.0, 5.0), "×5");
  EXPECT_EQ(change_text(5.0, 1.0), "÷5");
  EXPECT_EQ(change_text(5.0, 0.0), "-100%");
  EXPECT_EQ(change_text(0.0, 1.0), "-");
  EXPECT_EQ(change_text(-1.0, 1.0), "-");
}

TEST(Numbers, CoordinatesAreShort) {
  EXPECT_EQ(coordinate(12.0), "12");
  EXPECT_EQ(coordinate(12.345), "12.35");
  EXPECT_EQ(coordinate(-0.001), "0");
  EXPECT_EQ(coordinate(std::numeric_limits<double>::infinity()), "0");
}

TEST(Numbers, DecimalsAreTheNearestDoubles) {
  EXPECT_EQ(decimal(3, -1), 0.3);
  EXPECT_EQ(decimal(-7, -5), -7e-5);
  EXPECT_EQ(decimal(1, 22), 1e22);
}

}  // namespace
}  // namespace meshlode::lab::page
