# SPDX-License-Identifier: GPL-3.0-or-later
# sweep: with one round nothing is as good by a spread that nobody measured; text, JSON and page say the same.
cp "$DATA/city.glb" a.glb
"$MESHLODE" sweep a.glb -o report --rounds 1 --samples 200 --knobs preset,codec --jobs 1 \
  --want 'build min; deviation<=1, bytes min; time min' 2>/dev/null >said
echo "exit $?"
# Times and bytes are those of a machine and a version.
head -n 1 said | sed -E 's/, [0-9]+ s:/, N s:/'
grep '^build min' said
grep -o '^deviation<=1, bytes min: file_bytes [0-9.]* [kM]B, ' said | sed -E 's/[0-9.]+ [kM]B/N kB/'
grep -oE '^time min: build_user_seconds [0-9.]+ (s|ms), ' said | sed -E 's/[0-9.]+ (s|ms)/N s/'
grep -o 'a spread of 25% either way is assumed of what was measured once' said
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <report/sweep.json
# Nothing of the wall time was compared: neither the answers nor a table claim anything.
tr -d ' \n' <report/sweep.json | grep -o '"want":"buildmin".*"why":"not[^"]*"' | sed -E 's/.*("point":.*"as_good":\[\]).*/\1/'
tr -d ' \n' <report/sweep.json | grep -oE '"build_wall_seconds":\{"value":[^}]*\}' | sed -E 's/[0-9.]+(e-?[0-9]+)?/N/g' | sort -u
tr -d ' \n' <report/sweep.json | grep -oE '"build_user_seconds":\{"value":[^}]*\}' | sed -E 's/[0-9.]+(e-?[0-9]+)?/N/g' | sort -u
grep -o 'nothing could be compared' report/index.html
grep -c 'so as good.*build_wall' report/index.html
grep -o 'not compared' report/index.html | sort -u
# One point, of one point; a knob that the scene gives nothing to turn.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >t.obj
"$MESHLODE" sweep t.obj -o bare --rounds 1 --samples 200 --knobs normal-error --jobs 1 --want 'bytes min' 2>/dev/null |
  sed -E 's/, [0-9]+ s:/, N s:/; s/[0-9.]+ (B|kB),/N B,/'
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <bare/sweep.json
tr -d '\n' <bare/sweep.json | grep -oE '"knobs_left_out": *\[[^]]*\]' | tr -s ' '
# Two rounds have a spread.
"$MESHLODE" sweep a.glb -o report --rounds 2 --samples 200 --knobs preset,codec --jobs 1 --want 'build min' 2>/dev/null >said
grep -c 'not compared' said
