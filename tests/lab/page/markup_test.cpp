// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/markup.h"

#include <string>

#include <gtest/gtest.h>

#include "app/page/text_forms.h"
#include "lab/page/well_formed.h"

namespace meshlode::lab::page {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";

TEST(Markup, EscapesWhatEndsATextOrAValue) {
  EXPECT_EQ(app::escape_html("</script><img src=x onerror='a(\"b\")'>&amp;"),
            "&lt;/script&gt;&lt;img src=x onerror=&#39;a(&quot;b&quot;)&#39;&gt;&amp;amp;");
  EXPECT_EQ(app::escape_html("Häuschen — 石\n\t"), "Häuschen — 石\n\t");
}

TEST(Markup, LetsNoCharacterInThatXmlForbids) {
  EXPECT_EQ(app::escape_html(std::string("a\0b", 3)), std::string("a") + kReplacement + "b");
  EXPECT_EQ(app::escape_html("\x1B[31m\x7F"), std::string(kReplacement) + "[31m" + kReplacement);
  EXPECT_EQ(app::escape_html("\xFF\xC0\xAF"), std::string(kReplacement) + kReplacement + kReplacement) << "no UTF-8";
  EXPECT_EQ(app::escape_html("\xEF\xBF\xBE"), kReplacement) << "U+FFFE";
  EXPECT_EQ(app::escape_html("\xEF\xBF\xBC"), "\xEF\xBF\xBC") << "U+FFFC is a character";
}

TEST(Markup, LetsNoCharacterInThatTurnTheTextAroundIt) {
  EXPECT_EQ(app::escape_html("gpj\xE2\x80\xAE"
                             "exe"),
            std::string("gpj") + kReplacement + "exe");
  EXPECT_EQ(app::escape_html("\xE2\x81\xA6"), kReplacement) << "U+2066";
  EXPECT_EQ(app::escape_html("\xE2\x80\x94"), "\xE2\x80\x94") << "a dash is none";
}

TEST(Markup, NestsWhatIsOpened) {
  Markup html;
  html.open("p", {{"class", "a\"b"}}).text("1 < 2").empty("br").element("b", "x").close();
  EXPECT_EQ(html.str(), "<p class=\"a&quot;b\">1 &lt; 2<br/><b>x</b></p>");
  EXPECT_EQ(find_fault(html.str()), "");
}

TEST(Markup, TheCheckOfTheTestsFindsFaults) {
  EXPECT_EQ(find_fault("<!DOCTYPE html>\n<a b=\"c&amp;d\">x<e/></a>\n"), "");
  for (const char* broken : {"<a>", "<a></b>", "<a b=c></a>", "<a>&nbsp;</a>", "<a>1 & 2</a>", "<a b=\"<\"/>",
                             "<a/><a/>", "<a b=\"1\" b=\"2\"/>", "<a><b id=\"x\"/><c id=\"x\"/></a>", "<a>\x01</a>",
                             "<a>\xFF</a>", "text<a/>", "<a", "<a b=\"1", "<a>]]></a>"}) {
    EXPECT_NE(find_fault(broken), "") << broken;
  }
}

}  // namespace
}  // namespace meshlode::lab::page
