# SPDX-License-Identifier: GPL-3.0-or-later
# Layers: what plan, doctor and the asset say of gaps, and what turns them off.
printf 'newmtl lower\nKd 1 0 0\nnewmtl upper\nKd 0 0 1\n' >layers.mtl
awk 'BEGIN {
  n = 16
  print "mtllib layers.mtl"
  for (layer = 0; layer < 2; ++layer) for (j = 0; j <= n; ++j) for (i = 0; i <= n; ++i)
    printf "v %.6f %.6f %.6f\n", i / n, j / n, 0.005 * layer + 0.02 * sin(5 * i / n) * cos(4 * j / n)
  for (layer = 0; layer < 2; ++layer) for (j = 0; j < n; ++j) for (i = 0; i < n; ++i) {
    if (i + j == 0) print "usemtl " (layer == 0 ? "lower" : "upper")
    a = layer * (n + 1) * (n + 1) + j * (n + 1) + i + 1
    printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1
  }
}' >layers.obj
run doctor layers.obj
code doctor layers.obj --quiet --fail-on close-layers
json doctor doctor layers.obj --format json
"$MESHLODE" plan layers.obj | grep layers
"$MESHLODE" plan layers.obj --keep-layers off | grep layers
json plan plan layers.obj --format json
code build --quiet layers.obj -o kept.lode
code build --quiet layers.obj -o not.lode --keep-layers off
for name in kept not; do
  "$MESHLODE" info $name.lode | grep -E -o ': layers.*|keep_layers [a-z]*' || echo "$name says nothing"
  code verify --quiet $name.lode --source layers.obj
done
json info info not.lode --format json
cmp -s kept.lode not.lode && echo "no gap was kept"
code build --quiet layers.obj -o no.lode --keep-layers maybe
# Of one colour there is nothing to keep apart.
sed 's/usemtl upper/usemtl lower/' layers.obj >plain.obj
"$MESHLODE" plan plain.obj | grep ': layers' || echo "no gap is looked for"
echo '{"keep-layers": "off"}' >meshlode.json
code build --quiet layers.obj -o file.lode
cmp not.lode file.lode
files
