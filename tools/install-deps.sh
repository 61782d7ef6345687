#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# install-deps.sh [--tests [--GROUP...]]: the Debian 12 packages that building meshlode needs; with --tests also what its tests
# need (a second compiler for the comparison of content hashes, sample models), and by group what tools/test.sh --all=GROUP
# needs beyond that: --browser a browser and npm, --docs the site of the documents, --examples what OpenGL and Vulkan programs need,
# --npm encoders' npm, --packages a bare root and npm, --portability another standard library and
# a compiler for another system, --slurm a scheduler, which the test of tools/cluster starts for itself (a system that starts the
# services of what it installs may start munge's), --wasm Node. Nothing happens where all are there.
set -euo pipefail

packages=(
  g++ cmake ninja-build
  libtbb-dev libglm-dev libxxhash-dev        # base
  nlohmann-json3-dev libtinygltf-dev libdraco-dev libmeshoptimizer-dev  # import
  libmetis-dev libcgal-dev                   # partition, hierarchy and repair
  libopenmesh-dev                            # another simplifier, to compare; an oracle of topology in tests
  libpng-dev libjpeg62-turbo-dev libwebp-dev # image
  libstb-dev libcli11-dev                    # raster, command line
  libvulkan-dev glslc                        # gpu: headers and the shader compiler; the loader is opened at run time
  clang-14 lld-14 wasi-libc libc++-14-dev-wasm32 libc++abi-14-dev-wasm32 libclang-rt-14-dev-wasm32  # the page of info --html
)
if [ "${1:-}" = --tests ]; then
  packages+=(libgtest-dev libclang-rt-14-dev assimp-testmodels
             git clang-format-14 clang-tidy-14             # the form of the sources
             libzstd-dev liblz4-dev                        # pages of earlier development versions
             python3                                       # the independent readers of the format and of glTF
             make                                          # a stranger's project, built by what CMake takes by itself
             zsh fish mandoc man-db                        # readers of completion scripts and of man pages
             mesa-vulkan-drivers vulkan-validationlayers)  # a Vulkan device on any machine, and its judge
fi

for group in "${@:2}"; do
  case $group in
    --docs) packages+=(mkdocs mkdocs-material doxygen) ;;
    --examples) packages+=(libegl-dev libopengl-dev libgl-dev libegl-mesa0 libgl1-mesa-dri pkg-config) ;;
    --npm) command -v npm >/dev/null || packages+=(nodejs npm) ;;  # which may come from elsewhere
    --packages) packages+=(file dpkg-dev debootstrap); command -v npm >/dev/null || packages+=(nodejs npm) ;;
    --portability) packages+=(libc++-14-dev libc++abi-14-dev googletest g++-mingw-w64-x86-64 wine64) ;;
    --wasm) command -v node >/dev/null || packages+=(nodejs) ;;
    --browser) packages+=(chromium fonts-dejavu-core); command -v npm >/dev/null || packages+=(nodejs npm) ;;
    --slurm) packages+=(slurm-wlm munge) ;;
    *) echo "install-deps.sh: no group $group" >&2; exit 1 ;;
  esac
done

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }
missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

sudo=()
if [ "$(id -u)" -ne 0 ]; then sudo=(sudo); fi
echo "installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${sudo[@]}" apt-get update -qq
"${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
