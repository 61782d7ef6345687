// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/compare_page.h"

#include <string>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

ComparedFile changed(const std::string& name, double flip) {
  ComparedFile file;
  file.name = name;
  file.verdict = "changed";
  PictureChange& picture = file.pictures.emplace_back();
  picture.flip = {flip, flip, flip};
  picture.files = PictureFiles{name + ".1.old.png", name + ".1.new.png", name + ".1.flip.png"};
  return file;
}

TEST(ComparePage, NamesAndMessagesAreText) {
  for (const std::string name : {"<img src=x onerror=pwned()>", "</style><script>pwned()</script>",
                                 "javascript:pwned()", "\" onload=\"pwned()", "@ROWS@"}) {
    ComparedFile file = changed(name, 0.5);
    file.message = name;
    file.text = name;
    const std::string page = compare_page({file}, name);
    EXPECT_EQ(page.find("<img src=x"), std::string::npos);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("\" onload=\""), std::string::npos);
    EXPECT_EQ(page.find("src=\"javascript"), std::string::npos);
    EXPECT_EQ(count_of(page, "</style>"), 1u);
    EXPECT_EQ(count_of(page, "<img "), 3u);
    EXPECT_EQ(count_of(page, "src=\"./"), 3u);
  }
}

TEST(ComparePage, TheLargestDifferenceComesFirstAndEqualFilesHaveNoSection) {
  ComparedFile equal;
  equal.name = "same";
  equal.verdict = "equal";
  ComparedFile gone;
  gone.name = "zlost";
  gone.verdict = "gone";
  const std::string page = compare_page({equal, changed("small", 0.01), gone, changed("large", 0.5)}, "a");
  const std::size_t large = page.find(">large</a>"), small = page.find(">small</a>"), lost = page.find(">zlost</a>");
  ASSERT_NE(large, std::string::npos);
  ASSERT_NE(lost, std::string::npos);
  EXPECT_LT(large, small);
  EXPECT_LT(small, lost);
  EXPECT_LT(lost, page.find("<td>same</td>"));
  EXPECT_EQ(count_of(page, "<section id="), 3u);
  EXPECT_NE(page.find("4 files, 2 changed, 1 equal, 1 gone"), std::string::npos);
}

}  // namespace
}  // namespace meshlode::app
