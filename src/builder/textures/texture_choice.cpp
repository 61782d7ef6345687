// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/textures/texture_choice.h"

#include <charconv>

namespace meshlode::builder {

namespace {

std::optional<std::uint32_t> parse_texture_number(std::string_view text, std::uint32_t most) {
  std::uint32_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && rest == text.data() + text.size();
  if (!is_number || value < 1 || value > most) return std::nullopt;
  return value;
}

}  // namespace

std::optional<TextureChoice> parse_texture_choice(std::string_view text) {
  constexpr std::string_view kResize = "resize:", kWebp = "webp", kWebpOf = "webp:";
  constexpr std::uint32_t kMostQuality = 100;
  TextureChoice choice;
  if (text == "keep") return choice;
  while (true) {
    const std::string_view word = text.substr(0, text.find(','));
    std::optional<std::uint32_t> number;
    std::uint32_t* field = nullptr;
    if (word.starts_with(kResize)) {
      number = parse_texture_number(word.substr(kResize.size()), kMostTextureSide);
      field = &choice.longest_side;
    } else if (word == kWebp) {
      number = kUsualWebpQuality;
      field = &choice.webp_quality;
    } else if (word.starts_with(kWebpOf)) {
      number = parse_texture_number(word.substr(kWebpOf.size()), kMostQuality);
      field = &choice.webp_quality;
    }
    if (!number || *field != 0) return std::nullopt;
    *field = *number;
    if (word.size() == text.size()) return choice;
    text.remove_prefix(word.size() + 1);
  }
}

std::string texture_word(const TextureChoice& choice) {
  if (choice.is_keep()) return "keep";
  std::string word;
  if (choice.longest_side != 0) word = "resize:" + std::to_string(choice.longest_side);
  if (choice.webp_quality != 0) word += (word.empty() ? "webp:" : ",webp:") + std::to_string(choice.webp_quality);
  return word;
}

}  // namespace meshlode::builder
