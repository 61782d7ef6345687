# SPDX-License-Identifier: GPL-3.0-or-later
# sweep: never over what it reads, by whatever link; the state file leads nowhere else.
cp "$DATA/city.glb" scene.glb
cp scene.glb kept.glb
args=(--rounds 1 --samples 200 --knobs strip-effort --quiet --jobs 1)
code sweep scene.glb -o report "${args[@]}"
mkdir report/plots 2>/dev/null
for file in index.html sweep.json sweep.csv sweep-state.txt pictures/mine.png plots/mine.svg; do
  for kind in -s ''; do
    cp -r report linked
    rm -f "linked/$file"
    ln $kind "$PWD/scene.glb" "linked/$file"
    echo "$file is a ${kind:+symbolic }link to the scene"
    run sweep scene.glb -o linked "${args[@]}"
    cmp scene.glb kept.glb && rm -rf linked
  done
done
# The buffer and the image of a glTF are read as well.
mkdir gltf
cat >gltf/a.gltf <<'END'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
 "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
 "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"a.bin","byteLength":36}]}
END
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' >gltf/a.bin
cp gltf/a.bin kept.bin
cp -r report linked
rm linked/sweep.csv
ln -s ../gltf/a.bin linked/sweep.csv
run sweep gltf/a.gltf -o linked "${args[@]}"
cmp gltf/a.bin kept.bin && rm -rf linked
# A state file that is a link is not followed, wherever it leads; nor is a folder.
echo precious >other.txt
for kind in -s ''; do
  cp -r report linked
  rm linked/sweep-state.txt
  ln $kind "$PWD/other.txt" linked/sweep-state.txt
  run sweep scene.glb -o linked "${args[@]}"
  cat other.txt
  rm -rf linked
done
mkdir elsewhere
ln -s nowhere elsewhere/sweep-state.txt
run sweep scene.glb -o elsewhere "${args[@]}"
ls elsewhere
mkdir photos
cp -r report linked
rm -r linked/pictures
ln -s ../photos linked/pictures
run sweep scene.glb -o linked "${args[@]}"
ls photos
# The report's folder itself may be a link.
ln -s report by_link
code sweep scene.glb -o by_link "${args[@]}"
