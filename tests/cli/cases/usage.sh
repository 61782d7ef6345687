# SPDX-License-Identifier: GPL-3.0-or-later
# Exit 1 with one line on stderr for everything that cannot be a command.
code
code --help
code --version
run frobnicate
run VLIDATE
run --versoin
for verb in build merge plan doctor info compare sweep stream validate verify render extract repack measure report cache completion man; do
  code "$verb" --help
  code "$verb"
  code "$verb" a.lode --no-such-option
done
run build
run build a.glb --no-such-option
run build a.glb --prset fast
run build --prset=fast
run info a.lode --stuk
run info a.lode b.lode
run build a.glb -o a.lode -O out
run build a.glb b.glb -o a.lode
run build a.glb --codec gzip
run build a.glb --jobs many
run build a.glb --jobs -1
run build a.glb --grid 0
run build a.glb --grid nan
run build a.glb --grid 1e-3x
run build a.glb --position-error -1
run build a.glb --position-error 1 --grid 1
run build a.glb --normal-error 0
run build a.glb --uv-error 1pxl
run build a.glb --uv-error 0px
run build a.glb a.glb -O out
run info --format yaml a.lode
run sweep a.glb
run sweep a.glb -o r --budget 5x
run sweep a.glb -o r --want bytes
run sweep a.glb -o r --want 'devation<=1, bytes min'
run build a.glb --cluster-triangles 257
run doctor a.glb --fail-on needle
run doctor a.glb --fail-on ""
files
