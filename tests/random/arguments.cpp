// SPDX-License-Identifier: GPL-3.0-or-later
#include "arguments.h"

#include <charconv>
#include <cstdio>
#include <sstream>

namespace meshlode::test {

namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

bool parse(std::string_view text, std::uint64_t& value) {
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
}

bool parse(int argc, char** argv, Arguments& arguments) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--")) {
      arguments.positional.emplace_back(word);
      continue;
    }
    if (word == "--verbose") {
      arguments.verbose = true;
      continue;
    }
    if (word == "--started") {
      arguments.is_started = true;
      continue;
    }
    if (word == "--surgery") {
      arguments.harm = Harm::kSurgery;
      continue;
    }
    if (word == "--layers") {
      arguments.harm = Harm::kLayers;
      continue;
    }
    if (word == "--without-deviation") {
      arguments.depth = Depth::kVerifyWithoutDeviation;
      continue;
    }
    if (++i == argc) return false;
    const std::string value = argv[i];
    std::uint64_t whole = 0;
    const bool is_whole = parse(value, whole);
    if (word == "--program")
      arguments.program = value;
    else if (word == "--shrink-into")
      arguments.shrink_into = value;
    else if (word == "--rule")
      arguments.rule = value;
    else if (word == "--with")
      arguments.with = words_of(value);
    else if (!is_whole)
      return false;  // NOLINT(bugprone-branch-clone): what follows needs a number
    else if (word == "--jobs")
      arguments.jobs = whole;
    else if (word == "--samples")
      arguments.samples = whole;
    else if (word == "--max-triangles")
      arguments.max_triangles = whole;
    else if (word == "--max-refused")
      arguments.max_refused_percent = whole;
    else if (word == "--seconds")
      arguments.cpu_seconds = static_cast<double>(whole);
    else if (word == "--shrink-seconds")
      arguments.shrink_seconds = static_cast<double>(whole);
    else
      return false;
  }
  return !arguments.positional.empty();
}

int usage() {
  std::fputs(
      "usage: random_scenes run FIRST COUNT [--jobs N] [--max-triangles N] [--max-refused PERCENT]\n"
      "                     [--shrink-into FOLDER] [--verbose] [--without-deviation] [--samples N] [--surgery | "
      "--layers]\n"
      "                     [--with 'OPTION...']   build all of them with these, and with no other of their options\n"
      "                     [--started]   steps are forks of one process a job, which is quicker under sanitizers\n"
      "       random_scenes seeds SEED... [the same]\n"
      "       random_scenes soak FIRST MINUTES [the same]\n"
      "       random_scenes replay FOLDER [--jobs N] [--verbose]\n"
      "       random_scenes pieces TRIANGLES\n"
      "       random_scenes write SEED OUT.glb [--surgery | --layers]\n"
      "       random_scenes shrink SEED OUT.glb --rule ID [--shrink-seconds N] [--surgery | --layers]\n"
      "all:   [--program MESHLODE] [--seconds N]   processor time that a step may take\n",
      stderr);
  return 1;
}

}  // namespace meshlode::test
