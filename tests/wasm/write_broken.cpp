// SPDX-License-Identifier: GPL-3.0-or-later
// write_broken ASSET FOLDER COUNT: the asset COUNT times, each with one to four bytes of it changed and its checksums
// written anew, so that what is behind them is reached; every section is hit as often as any other, however small.
// FOLDER/0 and so on.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "run/read/asset.h"
#include "support/reseal.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes broken(const meshlode::run::Asset& asset, std::mt19937& random) {
  Bytes bytes(asset.bytes().begin(), asset.bytes().end());
  const auto below = [&](std::uint64_t count) { return static_cast<std::size_t>(random() % count); };
  for (std::size_t left = 1 + below(4); left > 0; --left) {
    const meshlode::format::SectionEntry& section = asset.sections()[below(asset.sections().size())];
    const bool is_header = section.bytes == 0 || below(8) == 0;
    const std::size_t begin = is_header ? 0 : static_cast<std::size_t>(section.offset);
    const std::size_t reach = is_header ? sizeof(meshlode::format::FileHeader) + asset.sections().size_bytes()
                                        : static_cast<std::size_t>(section.bytes);
    std::uint8_t& byte = bytes[begin + below(reach)];
    byte = below(3) == 0 ? std::uint8_t{0xFF} : static_cast<std::uint8_t>(byte ^ (1U << below(8)));
  }
  meshlode::test::reseal(bytes);
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  std::ifstream in(argv[1], std::ios::binary);
  const auto asset = meshlode::run::Asset::from_vector(Bytes(std::istreambuf_iterator<char>(in), {}));
  if (!asset) return 2;
  std::mt19937 random(2025);
  for (int k = 0; k < std::atoi(argv[3]); ++k) {
    const Bytes bytes = broken(*asset, random);
    std::ofstream out(std::string(argv[2]) + "/" + std::to_string(k), std::ios::binary);
    if (!out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) return 2;
  }
  return 0;
}
