// SPDX-License-Identifier: GPL-3.0-or-later
// I11: whatever the bytes, import gives an error with its place or a sound scene: no crash, no hang, no allocation that
// the file does not justify. Seeded mutations of valid files: bytes, JSON numbers and words, lengths, chunk headers,
// Draco payloads. Built for sanitizers; MESHLODE_MUTANT_COUNT says how many per run, MESHLODE_MUTANT_SEED where to
// start.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <map>

#include "base/random.h"
#include "gltf_builder.h"
#include "mutant_seeds.h"
#include "support/sanitized.h"

namespace meshlode::testing {
namespace {

/// The same mutants everywhere.
class Random : public SplitMix64 {
 public:
  using SplitMix64::SplitMix64;
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : SplitMix64::below(limit); }
};

void mutate_bytes(std::string& bytes, std::size_t from, std::size_t to, Random& random) {
  if (from >= to) return;
  const std::size_t count = 1 + random.below(4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = from + random.below(to - from);
    switch (random.below(4)) {
      case 0: bytes[at] = static_cast<char>(random.next()); break;
      case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8))); break;
      case 2: bytes[at] = static_cast<char>(random.below(2) == 0 ? 0xFF : 0x00); break;
      default: bytes[at] = static_cast<char>(bytes[at] + 1); break;
    }
  }
}

/// Replaces one number of the text.
void mutate_number(std::string& text, Random& random) {
  std::vector<std::size_t> starts;
  const auto is_digit = [&](std::size_t i) { return text[i] >= '0' && text[i] <= '9'; };
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (is_digit(i) && !is_digit(i - 1)) starts.push_back(i);
  }
  if (starts.empty()) return;
  const std::size_t at = starts[random.below(starts.size())];
  std::size_t end = at;
  while (end < text.size() && is_digit(end)) ++end;
  const std::string choices[] = {"0",
                                 "1",
                                 "2",
                                 "3",
                                 "7",
                                 "255",
                                 "256",
                                 "65535",
                                 "2147483647",
                                 "2147483648",
                                 "4294967295",
                                 "4294967296",
                                 "9007199254740993",
                                 "18446744073709551615",
                                 "-1",
                                 "0.5",
                                 "1e308",
                                 "1e999",
                                 "null",
                                 "true",
                                 "\"x\"",
                                 "[]",
                                 "{}",
                                 "5120",
                                 "5121",
                                 "5126",
                                 std::to_string(random.below(64)),
                                 std::to_string(random.next())};
  text.replace(at, end - at, choices[random.below(std::size(choices))]);
}

/// Copies one piece of the text over another: keys and values land where they do not belong.
void splice(std::string& text, Random& random) {
  if (text.size() < 8) return;
  const std::size_t length = 1 + random.below(std::min<std::size_t>(40, text.size() / 2));
  const std::string piece = text.substr(random.below(text.size() - length), length);
  const std::size_t at = random.below(text.size() - length);
  text.replace(at, random.below(2) == 0 ? length : random.below(length), piece);
}

struct Glb {
  std::string text, bin;
  static Glb split(const std::string& bytes) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, 4);
    return {bytes.substr(20, size), bytes.substr(std::min<std::size_t>(bytes.size(), 28 + size))};
  }
  [[nodiscard]] std::string join() const {
    const auto u32 = [](std::size_t value) {
      const auto v = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    std::string padded = text;
    padded.resize((padded.size() + 3) / 4 * 4, ' ');
    return "glTF" + u32(2) + u32(28 + padded.size() + bin.size()) + u32(padded.size()) + "JSON" + padded +
           u32(bin.size()) + std::string("BIN\0", 4) + bin;
  }
};

std::string mutate(const SeedFile& seed, Random& random) {
  std::string bytes = seed.bytes;
  const bool is_glb = bytes.starts_with("glTF");
  switch (random.below(is_glb ? 8 : 5)) {
    case 0: mutate_bytes(bytes, 0, bytes.size(), random); break;
    case 1: bytes.resize(random.below(bytes.size())); break;
    case 2: {
      const std::size_t at = random.below(bytes.size());
      bytes.insert(at, std::string(1 + random.below(8), static_cast<char>(random.next())));
      break;
    }
    case 3:
    case 4:
      if (is_glb) {
        Glb glb = Glb::split(bytes);
        random.below(2) == 0 ? mutate_number(glb.text, random) : splice(glb.text, random);
        bytes = glb.join();
      } else {
        random.below(2) == 0 ? mutate_number(bytes, random) : splice(bytes, random);
      }
      break;
    case 5: mutate_bytes(bytes, 0, 28, random); break;  // headers and lengths
    default: {                                          // the binary chunk: Draco payloads above all
      const std::size_t start = bytes.size() - Glb::split(bytes).bin.size();
      const bool near_head = random.below(3) == 0;
      mutate_bytes(bytes, start, near_head ? std::min(bytes.size(), start + 48) : bytes.size(), random);
      break;
    }
  }
  return bytes;
}

void expect_sound(const scene::Scene& scene) {
  for (const scene::SourceMesh& mesh : scene.meshes) {
    for (const scene::Primitive& p : mesh.primitives) {
      ASSERT_EQ(p.indices.size() % 3, 0U);
      for (const std::uint32_t i : p.indices) ASSERT_LT(i, p.positions.size());
      for (const Vec3d& v : p.positions) ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
      ASSERT_TRUE(p.normals.empty() || p.normals.size() == p.positions.size());
      for (const Vec3f& n : p.normals) ASSERT_TRUE(std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z));
      for (const auto& set : p.uvs) {
        ASSERT_TRUE(set.empty() || set.size() == p.positions.size());
        for (const Vec2f& t : set) ASSERT_TRUE(std::isfinite(t.x) && std::isfinite(t.y));
      }
      ASSERT_TRUE(p.colors.empty() || p.colors.size() == p.positions.size());
      ASSERT_LT(p.material.value, scene.materials.size());
    }
  }
  for (const scene::SceneInstance& i : scene.instances) ASSERT_LT(i.mesh.value, scene.meshes.size());
}

TEST(ImportMutants, AreRefusedWithAPlaceOrGiveASoundScene) {
  const char* chosen = std::getenv("MESHLODE_MUTANT_SEED");
  const std::uint64_t first = chosen == nullptr ? 1 : std::strtoull(chosen, nullptr, 10);
  const std::vector<SeedFile> seeds = make_seed_files();
  const TempFolder folder;
  std::map<int, int> outcomes;
  double slowest = 0.0;
  for (std::uint64_t m = 0; m < MESHLODE_MUTANT_COUNT; ++m) {
    Random random(first + m);
    const SeedFile& seed = seeds[m % seeds.size()];
    const std::string bytes = mutate(seed, random);
    const auto path = folder.write(seed.name, bytes);
    SCOPED_TRACE("mutant seed " + std::to_string(first + m) + " of " + seed.name);
    const auto start = std::chrono::steady_clock::now();
    const auto scene = scene::import_scene(path, {.repair = random.below(4) == 0});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slowest = std::max(slowest, seconds);
    ASSERT_LT(seconds, 20.0);
    if (scene) {
      ++outcomes[0];
      expect_sound(*scene);
      if (HasFatalFailure()) return;
    } else {
      const Error& error = scene.error();
      ++outcomes[static_cast<int>(error.code)];
      ASSERT_TRUE(error.code == ErrorCode::kIo || error.code == ErrorCode::kInvalid ||
                  error.code == ErrorCode::kUnsupported)
          << error.message();
      ASSERT_NE(error.where.find(seed.name), std::string::npos) << error.message();
      ASSERT_FALSE(error.detail.empty());
    }
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  for (const auto& [code, count] : outcomes) {
    std::cout << "outcome " << code << ": " << count << " mutants\n";
    RecordProperty("outcome_" + std::to_string(code), count);
  }
  std::cout << "slowest " << slowest << " s, largest resident size " << usage.ru_maxrss / 1024 << " MiB\n";
  if (!test::kIsSanitized) {
    EXPECT_LT(usage.ru_maxrss / 1024, 1024);
  }
}

}  // namespace
}  // namespace meshlode::testing
