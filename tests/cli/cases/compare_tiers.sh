# SPDX-License-Identifier: GPL-3.0-or-later
# compare: errors of different tiers are not comparable; their changes and ratios are null, in budgets too.
cp "$DATA/crystal.glb" a.glb
for tier in qem measured; do "$MESHLODE" build --quiet a.glb -o $tier.lode --error-tier $tier; done
"$MESHLODE" build --quiet a.glb -o coarse.lode --position-error 0.01
"$MESHLODE" compare measured.lode qem.lode | grep '^errors'
"$MESHLODE" compare measured.lode qem.lode | grep -E 'error_m(in|ax)' | awk '{print $3, $(NF-1), $NF}' | sort | uniq -c | sed 's/^ *[0-9]* /rows: /'
"$MESHLODE" compare measured.lode coarse.lode | grep -c '^errors'
"$MESHLODE" compare measured.lode qem.lode --format json | "$JSON_CHECK" "$SCHEMAS/compare.schema.json"
"$MESHLODE" compare measured.lode qem.lode --format json | tr -d ' \n' | grep -o '"error_tier":{[^}]*}' | sort -u
"$MESHLODE" compare measured.lode qem.lode --format json | tr -d ' \n' | grep -oE '"error_m(in|ax)":\{[^}]*\}' |
  sed -E 's/.*"change":([^,]*),"ratio":([^}]*)}/\1 \2/' | sort -u
limit() {
  echo "\$ meshlode compare $1 $2 --fail-if $3"
  "$MESHLODE" compare "$1" "$2" --quiet --fail-if "$3" 2>&1
  echo "exit $?"
}
# What nobody knows breaks what bounds it from above, and nothing else.
limit measured.lode qem.lode 'any(meshes).any(by_level).error_max.ratio>1.05'
limit measured.lode qem.lode 'any(meshes).any(by_level).error_max.ratio<1'
limit measured.lode qem.lode 'any(meshes).any(by_level).error_max.change==null'
limit measured.lode qem.lode 'any(meshes).error_tier.comparable==false'
limit measured.lode measured.lode 'any(meshes).any(by_level).error_max.ratio>1.05, any(meshes).error_tier.comparable==false'
