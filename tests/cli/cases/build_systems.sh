# SPDX-License-Identifier: GPL-3.0-or-later
# The examples of docs/guides/batches.md for Ninja, Make and a CI job, as they stand there. (CMake's is in tests/install.)
block() { awk -v mark="^\`\`\`$1" '$0 ~ mark { on = 1; next } /^```/ { on = 0 } on' "$REPOSITORY/docs/guides/batches.md"; }
scene() {
  local one='\000\000\200\077' zero='\000\000\000\000'
  printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >"$1.bin"
  printf 'a picture' >"$1.png"
  printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"%s.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"images":[{"uri":"%s.png"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}' \
    "$(basename "$1")" "$(basename "$1")" >"$1.gltf"
}
mkdir ../bin && ln -s "$MESHLODE" ../bin/meshlode
export PATH=$PWD/../bin:$PATH
unset MESHLODE_CACHE MAKEFLAGS MFLAGS

# tries TOOL…: the example at first, again, after one texture changed, went and came back, and after a scene was touched
tries() {
  local name=$1; shift
  # Which assets were built, by the lines that the tool prints
  built() { "$@" 2>&1 | grep -oE '(LODE |-o )assets/[a-z]+\.lode' | sed 's/.* //' | LC_ALL=C sort | uniq | tr '\n' ' '; echo "exit ${PIPESTATUS[0]}"; }
  echo "$name, at first: $(built "$@")"
  echo "$name, again: $(built "$@")"
  sleep 0.05; printf 'A picture' >scenes/tree.png
  echo "$name, one texture changed: $(built "$@")"
  rm scenes/tree.png
  echo "$name, it is gone: $(built "$@")"
  sleep 0.05; printf 'A picture' >scenes/tree.png
  echo "$name, it is back: $(built "$@")"
  sleep 0.05; touch scenes/hut.gltf
  echo "$name, a scene touched: $(built "$@")"
  echo "$name, again: $(built "$@")"
  printf 'broken' >scenes/hut.gltf
  echo "$name, a scene broken: $(built "$@")"
}
for tool in ninja make; do
  mkdir $tool && cd $tool && mkdir scenes assets
  scene scenes/hut; scene scenes/tree
  if [ $tool = ninja ]; then block ninja >build.ninja; else block make >Makefile; fi
  tries $tool $tool
  cd ..
done

# The job's script in a root of its own: a shell, the program and their libraries.
mkdir -p root/bin root/tmp root/proc root/dev root/job/scenes
into_root() { cp --parents $(ldd "$1" | grep -o '/[^ ]*') root; cp "$1" root/bin; }
into_root "$MESHLODE"; into_root "$(readlink -f "$(command -v sh)")"
mv "root/bin/$(basename "$(readlink -f "$(command -v sh)")")" root/bin/sh
mv "root/bin/$(basename "$MESHLODE")" root/bin/meshlode 2>/dev/null
scene root/job/scenes/hut; scene root/job/scenes/tree
{ echo 'cd /job'; block yaml | sed -n '/^  script:/,/^  [a-z]/s/^    - //p'; } >root/script
echo "script: $(grep -c '^meshlode ' root/script) lines"
unshare --user --map-root-user --mount true 2>/dev/null || skip "no user namespaces, in which a bare root could be made"
for turn in first second; do
  unshare --user --map-root-user --mount --pid --fork sh -c \
    'mount -t proc proc root/proc 2>/dev/null || mount --rbind /proc root/proc; exec env -i PATH=/bin /usr/sbin/chroot root /bin/sh -e /script' 2>../stderr
  echo "$turn: exit $?, $(tail -n 1 ../stderr | sed 's/; [0-9,]* triangles.*//')"
done
grep -c '<testcase' root/job/assets.xml
"$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <root/job/assets.json
find root/job -name '*.lode' | LC_ALL=C sort
