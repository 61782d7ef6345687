// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/textures/texture_choice.h"

#include <string_view>
#include <utility>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

TEST(TextureChoice, WordsHaveOneForm) {
  for (const auto& [text, word] : {std::pair{"keep", "keep"},
                                   {"webp", "webp:90"},
                                   {"webp:1", "webp:1"},
                                   {"resize:1", "resize:1"},
                                   {"resize:16384,webp:100", "resize:16384,webp:100"},
                                   {"webp,resize:512", "resize:512,webp:90"}}) {
    const auto choice = parse_texture_choice(text);
    ASSERT_TRUE(choice) << text;
    EXPECT_EQ(texture_word(*choice), word);
    EXPECT_EQ(*parse_texture_choice(word), *choice);
  }
}

TEST(TextureChoice, OtherTextIsNone) {
  for (const std::string_view text : {"",
                                      "Keep",
                                      "webp:",
                                      "webp:0",
                                      "webp:101",
                                      "webp:8.5",
                                      "resize",
                                      "resize:",
                                      "resize:0",
                                      "resize:16385",
                                      "resize:-1",
                                      "resize:99999999999999999999",
                                      "keep,webp",
                                      "webp,webp",
                                      "resize:1,resize:2",
                                      "webp,",
                                      ",webp",
                                      "webp:80,",
                                      "resize:1024 ,webp",
                                      "png"}) {
    EXPECT_FALSE(parse_texture_choice(text)) << text;
  }
}

}  // namespace
}  // namespace meshlode::builder
