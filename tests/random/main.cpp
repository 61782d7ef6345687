// SPDX-License-Identifier: GPL-3.0-or-later
// random_scenes: scenes nobody chose, through the program.
//   run FIRST COUNT        each seed is built, validated, verified and decoded; exit 6 where one fails
//   seeds SEED...          the same for the seeds named
//   soak FIRST MINUTES     the same for seeds from FIRST on, until the time is over
//   replay FOLDER          the same for the GLBs of a folder, with the build options of NAME.options beside them
//   pieces TRIANGLES       what each kind of piece costs alone, at so many triangles and at four times as many
//   write SEED OUT.glb     the scene and, on stdout, its contents and build options
//   shrink SEED OUT.glb    the smallest scene that still breaks the rule named by --rule
#include <cstdio>

#include "arguments.h"
#include "series.h"
#include "shapes.h"
#include "tally.h"

namespace {

using namespace meshlode::test;

/// Seconds to build 10,000 triangles of each kind, at a size and at four times that: what grows with the square shows.
int time_pieces(const Arguments& arguments, std::uint32_t triangles) {
  const WorkFolder work;
  std::printf("%-18s %28s   %s\n", "seconds a 10,000", "one position, one vertex",
              "texture coordinates of each corner's own");
  for (std::size_t kind = 0; kind < shape_kinds().size(); ++kind) {
    std::printf("%-18s", shape_kinds()[kind].name);
    for (const bool torn : {false, true}) {
      for (const std::uint32_t count : {triangles, 4 * triangles}) {
        const RandomScene scene = scene_of_one_piece(kind, count, torn);
        TrialOptions options{.program = arguments.program, .folder = work.path(), .build_options = {}};
        options.depth = Depth::kBuild;
        options.cpu_seconds = arguments.cpu_seconds;
        const TrialResult result = try_scene(write_glb(scene), options);
        const double seconds = 1e4 * result.build_seconds / static_cast<double>(scene.triangle_count());
        std::printf("   %8.2f at %6llu", seconds, static_cast<unsigned long long>(scene.triangle_count()));
        if (!result.is_clean()) std::printf(" %s", result.refusal ? "refused" : result.rules.begin()->first.c_str());
        std::fflush(stdout);
      }
    }
    std::printf("\n");
  }
  return 0;
}

int dispatch(const Arguments& arguments) {
  const auto& words = arguments.positional;
  std::uint64_t first = 0, count = 0;
  std::vector<std::uint64_t> seeds;
  if (words[0] == "run" && words.size() == 3 && parse(words[1], first) && parse(words[2], count)) {
    for (std::uint64_t i = 0; i < count; ++i) seeds.push_back(first + i);
    return run_seeds(arguments, seeds);
  }
  if (words[0] == "seeds" && words.size() > 1) {
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (!parse(words[i], seeds.emplace_back())) return usage();
    }
    return run_seeds(arguments, seeds);
  }
  if (words[0] == "soak" && words.size() == 3 && parse(words[1], first) && parse(words[2], count) && count > 0 &&
      count <= 10000) {
    return soak(arguments, first, static_cast<double>(count));
  }
  if (words[0] == "replay" && words.size() == 2) return replay(arguments, words[1]);
  if (words[0] == "pieces" && words.size() == 2 && parse(words[1], count) && count > 0 && count <= 1000000) {
    return time_pieces(arguments, static_cast<std::uint32_t>(count));
  }
  if (words.size() != 3 || !parse(words[1], first)) return usage();
  if (words[0] == "write") {
    const RandomScene scene = random_scene(first, arguments.harm);
    std::printf("%s\n%s\n", scene.contents.c_str(), joined(scene.build_options).c_str());
    return write_scene(words[2], scene) ? 0 : 2;
  }
  if (words[0] == "shrink" && !arguments.rule.empty()) {
    const WorkFolder work;
    const RandomScene scene = shrunk(first, arguments.rule, arguments, work.path());
    std::printf("%llu triangles\n%s\n", static_cast<unsigned long long>(scene.triangle_count()),
                joined(scene.build_options).c_str());
    return write_scene(words[2], scene) ? 0 : 2;
  }
  return usage();
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  arguments.program = MESHLODE_PROGRAM;
  if (!parse(argc, argv, arguments)) return usage();
  return dispatch(arguments);
}
