# SPDX-License-Identifier: GPL-3.0-or-later
# --lock-borders: what says that borders are locked, and that groups which they hold are no fault.
tile() {
  awk -v x0="$1" 'BEGIN {
    n = 48
    for (j = 0; j <= n; ++j) for (i = 0; i <= n; ++i) {
      x = x0 + i / n; y = j / n
      printf "v %.6f %.6f %.6f\n", x, y, 0.12 * sin(5 * x) * cos(4 * y)
    }
    for (j = 0; j < n; ++j) for (i = 0; i < n; ++i) {
      a = j * (n + 1) + i + 1
      printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1
    }
  }' >"$2"
}
tile 0 west.obj
tile 1 east.obj
"$MESHLODE" plan west.obj --lock-borders | grep lock-borders
code build --quiet west.obj east.obj -O out --lock-borders --grid 0.0078125 --fail-if 'totals.stuck_groups>0'
"$MESHLODE" info out/west.lode | grep -E 'lock_borders|borders:|stuck|deviates'
json info info out/west.lode --format json --stuck
run info out/west.lode --quiet --fail-if 'any(meshes).stuck_groups>0'
code info out/west.lode --quiet --fail-if 'any(meshes).stuck_reasons["border"]>0'
"$MESHLODE" doctor out/west.lode | grep -c stuck-
"$MESHLODE" verify out/west.lode --source west.obj --cuts 20 --cameras 3 | grep 'locked borders'
"$MESHLODE" verify --quick out/west.lode --source west.obj | grep 'locked borders'
code extract --quiet --stuck out/west.lode -o stuck.glb
# Single meshes by name, and away with it again on the command line.
echo '{"meshes": {"east": {"lock-borders": true}}}' >meshlode.json
code build --quiet west.obj east.obj -O named --error-tier qem
json info info named/east.lode --format json
for asset in west east; do
  "$MESHLODE" info named/$asset.lode --format json | tr -d ' \n' | grep -o '"lock_borders":[a-z]*' || echo "$asset is free"
done
code verify --quiet named/east.lode --source east.obj --cuts 20 --cameras 3
rm meshlode.json
run study west.obj -o no.lode --lock-borders --simplifier openmesh
files
