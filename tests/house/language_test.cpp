// SPDX-License-Identifier: GPL-3.0-or-later
// The language of public texts: phrases that a reader outside of this project stumbles over, and sentences that are too
// long. What was measured and tried (docs/log) and what a test writes (hard-cases.md) is exempt.
#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

struct Phrase {
  const char* pattern;
  const char* instead;
};

// Each was a habit of these texts.
constexpr Phrase kPhrases[] = {
    {"\\bcomma by comma\\b", "comma-separated"},
    {"\\b(is|are|was|be) told\\b", "is reported, is listed"},
    {"\\bbe had\\b", "available"},
    {"\\baloud\\b", "with a message"},
    {"\\bby the clock\\b", "for a fixed time"},
    {"\\bthousand million\\b", "billion"},
    {"\\bone behind the other\\b", "consecutive"},
    {"\\bwhoever\\b", "callers, anyone who"},
    {"\\bhundredths (faster|quicker|slower)\\b", "percent"},
    {"\\bpass(es|ed)? over\\b", "ignore"},
    {"\\bmend(ed|s|ing)?\\b", "fix"},
    {"\\b(bytes|bits|triangles|vertices|floats|lines?|rows?|roots?|cuts|clusters|points|seconds|passes|samples?|"
     "threads|pages|numbers|grid) an? (triangle|vertex|cluster|mesh|file|line|page|pixel|asset|scene|level|group|cut|"
     "point|frame|node|material|side|axis|corner|job|shard|setting)\\b(?! "
     "(is|are|has|can|may|without|covers|names)\\b)",
     "per, not a"},
    {"(^|- |[.;:] )Of (a|an|the|these|those|what|its|each) [a-z]+ (it|they|that|which|the|only|all)\\b",
     "subject first"},
    {"\\b(is|are) no (code|fault|failure|finding|pattern|part|number|bound|triangle|manifold|aggregate|tests?|knob)\\b",
     "is not a"},
};

/// Prose alone: comments, code and addresses of links left out; a paragraph, an item and a row of a table each on a
/// line.
std::vector<std::string> paragraphs(const std::string& text) {
  std::vector<std::string> out;
  bool in_code = false, in_comment = false, is_open = false;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string line = text.substr(start, end - start);
    start = end + 1;
    if (line.starts_with("```")) in_code = !in_code;
    in_comment = in_comment || line.starts_with("<!--");
    const bool is_prose = !in_code && !in_comment && !line.starts_with("```") && !line.starts_with("    ");
    if (line.find("-->") != std::string::npos) in_comment = false;
    const std::size_t first = line.find_first_not_of(" \t");
    if (!is_prose || first == std::string::npos) {
      is_open = false;
      continue;
    }
    line = line.substr(first);
    const bool begins = line.starts_with("- ") || line.starts_with("|") || line.starts_with("#") ||
                        (line[0] >= '1' && line[0] <= '9' && line.find(". ") < 3);
    if (begins || !is_open) {
      out.push_back(line);
    } else {
      out.back() += " " + line;
    }
    is_open = !line.starts_with("|") && !line.starts_with("#");
  }
  static const std::regex code("`[^`]*`"), address("\\]\\([^)]*\\)");
  for (std::string& paragraph : out) {
    paragraph = std::regex_replace(std::regex_replace(paragraph, code, "X"), address, "]");
  }
  return out;
}

bool is_exempt(const std::string& path) {
  return path.find("docs/log/") != std::string::npos || path.ends_with("hard-cases.md");
}

std::vector<SourceFile> pages() {
  std::vector<SourceFile> files;
  for (SourceFile& file : read_tree({"docs"}, {".md"})) {
    if (!is_exempt(file.path.generic_string())) files.push_back(std::move(file));
  }
  for (const char* name : {"README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"})
    files.push_back(read_file(name));
  return files;
}

/// The comments of a header, as paragraphs.
std::vector<std::string> comments(const std::string& text) {
  static const std::regex marker("^ *(///<?|//|/\\*\\*<?|\\*/?)? ?");
  std::string prose;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string line = text.substr(start, end - start);
    start = end + 1;
    const std::size_t at = std::min({line.find("//"), line.find("/*"), line.find(" * ")});
    prose += at == std::string::npos ? "\n" : std::regex_replace(line.substr(at), marker, "") + "\n";
  }
  return paragraphs(prose);
}

std::vector<std::string> findings(const std::vector<std::string>& texts) {
  static const std::vector<std::regex> patterns = [] {
    std::vector<std::regex> made;
    for (const Phrase& phrase : kPhrases) made.emplace_back(phrase.pattern, std::regex::ECMAScript);
    return made;
  }();
  std::vector<std::string> found;
  for (const std::string& text : texts) {
    for (std::size_t i = 0; i < patterns.size(); ++i) {
      std::smatch match;
      if (!std::regex_search(text, match, patterns[i])) continue;
      found.push_back("'" + match.str() + "' in \"" + text.substr(0, 120) + "\"; say: " + kPhrases[i].instead);
    }
  }
  return found;
}

/// Words of each sentence of prose; tables and headings have none.
std::vector<std::size_t> sentence_lengths(const std::vector<std::string>& texts) {
  std::vector<std::size_t> lengths;
  for (const std::string& text : texts) {
    if (text.starts_with("|") || text.starts_with("#")) continue;
    std::size_t words = 0;
    std::size_t start = 0;
    while (start < text.size()) {
      const std::size_t end = std::min(text.find(' ', start), text.size());
      const std::string word = text.substr(start, end - start);
      start = end + 1;
      if (std::any_of(word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) != 0; })) ++words;
      const bool ends = !word.empty() && std::string(".!?:").find(word.back()) != std::string::npos;
      if ((ends || start >= text.size()) && words > 0) {
        if (words > 2) lengths.push_back(words);  // "Or:" and numbers of items are no sentences
        words = 0;
      }
    }
  }
  return lengths;
}

double mean(const std::vector<std::size_t>& lengths) {
  double sum = 0.0;
  for (const std::size_t length : lengths) sum += static_cast<double>(length);
  return lengths.empty() ? 0.0 : sum / static_cast<double>(lengths.size());
}

TEST(Language, PagesHaveNoneOfThePhrases) {
  std::size_t count = 0;
  for (const SourceFile& file : pages()) {
    for (const std::string& finding : findings(paragraphs(file.text))) ADD_FAILURE() << file.path << ": " << finding;
    ++count;
  }
  EXPECT_GT(count, 40U);
}

TEST(Language, PublicHeadersHaveNoneOfThePhrases) {
  std::size_t count = 0;
  for (const SourceFile& file : read_tree({"include"}, {".h"})) {
    for (const std::string& finding : findings(comments(file.text))) ADD_FAILURE() << file.path << ": " << finding;
    ++count;
  }
  EXPECT_GT(count, 5U);
}

// 25 words is what plain language guides allow at most; here it bounds the mean of a page.
TEST(Language, SentencesAreShortInTheMeanOfAPage) {
  for (const SourceFile& file : pages()) {
    const std::string path = file.path.generic_string();
    const bool is_guide = path.find("docs/") == std::string::npos || path.find("reference/") == std::string::npos;
    if (!is_guide) continue;
    EXPECT_LE(mean(sentence_lengths(paragraphs(file.text))), 25.0) << path;
  }
}

TEST(Language, TheChecksFindWhatTheyLookFor) {
  const auto count = [](const char* text) { return findings(paragraphs(text)).size(); };
  EXPECT_EQ(count("Names, comma by comma."), 1U);
  EXPECT_EQ(count("What is left out is told."), 1U);
  EXPECT_EQ(count("It takes 15 bytes a\ntriangle."), 1U);
  EXPECT_EQ(count("- Of a mesh that is closed nothing is said."), 1U);
  EXPECT_EQ(count("It takes 15 bytes per triangle. There is no limit."), 0U);
  EXPECT_EQ(count("```\nis told\n```\n<!-- is told -->\n`is told`"), 0U);
  EXPECT_EQ(findings(comments("int a;  ///< 3 floats a vertex\nint b;  // a grid")).size(), 1U);
  EXPECT_EQ(sentence_lengths(paragraphs("# A heading\nOne two three. One two\nthree four! | no\n\n| a | table |\n")),
            (std::vector<std::size_t>{3, 4}));
}

}  // namespace
}  // namespace meshlode::house
