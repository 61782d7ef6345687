#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# install_test.sh CMAKE BUILD_FOLDER COMPILER CONSUMER: installs to a temporary prefix, builds and runs the consumer there,
# and looks at what its two programs need at run time.
set -euo pipefail
cmake=$1 build=$2 compiler=$3 consumer=$4
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work/prefix" >/dev/null
"$work/prefix/bin/meshlode" --version
for file in man/man1/meshlode.1 man/man1/meshlode-build.1 bash-completion/completions/meshlode \
            zsh/site-functions/_meshlode fish/vendor_completions.d/meshlode.fish; do
  [ -s "$work/prefix/share/$file" ] || { echo "FAILED: share/$file is not installed"; exit 1; }
done
"$cmake" -S "$consumer" -B "$work/consumer" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$compiler" >/dev/null
"$cmake" --build "$work/consumer"
"$work/consumer/use_build" "$work/triangle.lode"
"$work/consumer/use_runtime" "$work/triangle.lode"

"$work/consumer/use_c" "$work/triangle.lode"

# The same by pkg-config, whose files find their own prefix.
if command -v pkg-config >/dev/null; then
  PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name meshlode.pc)")
  export PKG_CONFIG_PATH
  version=$(sed -n 's/^#define MESHLODE_VERSION_[A-Z]* \([0-9]*\) .*/\1/p' "$work/prefix/include/meshlode/version.h" | paste -sd .)
  [ "$(pkg-config --modversion meshlode)" = "$version" ] || { echo "FAILED: pkg-config has another version than $version"; exit 1; }
  # shellcheck disable=SC2046
  "$compiler" -std=c++20 "$consumer/use_build.cpp" -o "$work/by_pkg_config" $(pkg-config --cflags --libs meshlode-build)
  LD_LIBRARY_PATH=$(pkg-config --variable=libdir meshlode) "$work/by_pkg_config" "$work/again.lode"
  cmp "$work/triangle.lode" "$work/again.lode"
fi

# Shaders: complete in the prefix, equal to the SPIR-V beside, and documented.
shaders=$work/prefix/include/meshlode/gpu
compile() { glslc --target-env=vulkan1.3 -O -I "$work/prefix/include" "$@" -o "$work/shader.spv" || { echo "FAILED: $*"; exit 1; }; }
compiled=0
for spirv in "$shaders"/*.spv; do
  name=$(basename "$spirv" .spv) stage=${spirv%.spv}; stage=${stage##*.}
  case $name in
    hardware*.frag) source=hardware.frag ;;
    *) source=${name/_mask/} ;;
  esac
  flags=()
  [[ $name != *_mask* ]] || flags+=(-DALPHA_MASK)
  [[ $name != hardware_mesh* ]] || flags+=(-DMESH_SHADER)
  compile "${flags[@]}" "$shaders/$source"
  cmp "$work/shader.spv" "$spirv" || { echo "FAILED: $stage $name is not what its source becomes"; exit 1; }
  compiled=$((compiled + 1))
done
if [ -e "$shaders/raster.comp.spv" ]; then
  [ "$compiled" -eq 18 ] || { echo "FAILED: $compiled shaders"; exit 1; }
  for source in "$shaders"/*.comp "$shaders"/hardware.*[a-z]; do
    [[ $source == *.spv ]] || [ -e "$source.spv" ] || { echo "FAILED: $source has no SPIR-V"; exit 1; }
  done
fi
document=$consumer/../../../docs/reference/shaders.md
{
  sed -n 's/^layout(constant_id = [0-9]*) const uint \(k[A-Za-z]*\).*/\1/p' "$shaders"/*.comp "$shaders"/*.glsl "$shaders"/hardware.*[a-z]
  sed -n '/^struct GpuFrame/,$ s/^  GPU_POINTER([A-Za-z]*) \([a-z_]*\);.*/\1/p' "$shaders/frame.h"
} | LC_ALL=C sort -u >"$work/names"
[ "$(wc -l <"$work/names")" -gt 30 ] || { echo "FAILED: the shaders' bindings are not found"; exit 1; }
while read -r name; do
  grep -q "\`$name\`" "$document" || { echo "FAILED: $name is not in docs/reference/shaders.md"; exit 1; }
done <"$work/names"
echo "$compiled shaders compile to what is installed; $(wc -l <"$work/names") names of bindings are documented"

needed() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\].*/\1/p' | LC_ALL=C sort; }
allowed='^(libc|libm|libstdc\+\+|libgcc_s|ld-linux-x86-64)\.so'
if needed "$work/consumer/use_runtime" | grep -Ev "$allowed"; then
  echo "FAILED: meshlode::runtime needs the libraries above"; exit 1
fi
# Its own symbols too: no oneTBB, no METIS, no JSON left open for someone else to provide.
runtime=$(find "$work/prefix" -name 'libmeshlode_runtime.a')
if nm -C --undefined-only "$runtime" | grep -E ' U (tbb::|METIS_|nlohmann|draco::|CGAL|OpenMesh)'; then
  echo "FAILED: meshlode::runtime leaves the symbols above to others"; exit 1
fi
# The C library has its C++ runtime inside, and shows nothing but its own functions.
c_library=$(find "$work/prefix" -name 'libmeshlode.so')
if needed "$c_library" | grep -Ev '^(libc|libm|ld-linux-x86-64)\.so'; then
  echo "FAILED: meshlode::c needs the libraries above"; exit 1
fi
if nm -D --defined-only "$c_library" | grep -v ' [AT] meshlode_'; then
  echo "FAILED: meshlode::c shows the symbols above"; exit 1
fi
# What only studies want is in no library (src/lab).
if needed "$(find "$work/prefix" -name 'libmeshlode_build.so')" | grep OpenMesh; then
  echo "FAILED: meshlode::build needs the library above"; exit 1
fi
echo "meshlode::c needs $(needed "$c_library" | tr '\n' ' ')"
echo "PASSED: use_runtime needs $(needed "$work/consumer/use_runtime" | tr '\n' ' ')"
