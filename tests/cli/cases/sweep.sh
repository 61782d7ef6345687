# SPDX-License-Identifier: GPL-3.0-or-later
# sweep: a report of a small scene; measured once, it is the same when asked for again; killed, it goes on.
cp "$DATA/crystal.glb" a.glb
code sweep a.glb -o report --quiet --rounds 2 --samples 500 --budget 4s
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <report/sweep.json
cp report/sweep.csv first.csv
code sweep a.glb -o report --quiet --rounds 2 --samples 500 --budget 4s
cmp first.csv report/sweep.csv && echo "the same table"
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <report/sweep.json
ls report
# A picture that is gone is drawn again, and nothing else is measured; what lies in the folder stays.
mkdir report/work
touch report/work/mine
gone=$(ls report/pictures | head -n 1)
rm "report/pictures/$gone"
code sweep a.glb -o report --quiet --rounds 2 --samples 500 --budget 4s
[ -s "report/pictures/$gone" ] && cmp first.csv report/sweep.csv && ls -A report
# What is recommended keeps what was wished.
json sweep sweep a.glb -o report --rounds 2 --samples 500 --budget 4s --want 'deviation<=1, bytes min' --format json
# Killed twice on its way: nothing that was finished is measured again, and the rest is.
mkdir killed
touch killed/sweep-state.txt
for wait in 0.5 1; do
  timeout -s TERM "$wait" "$MESHLODE" sweep a.glb -o killed --quiet --rounds 1 --samples 500 --budget 4s 2>/dev/null
done
cp killed/sweep-state.txt before.txt
code sweep a.glb -o killed --quiet --rounds 1 --samples 500 --budget 4s
head -c "$(stat -c %s before.txt)" killed/sweep-state.txt | cmp - before.txt && echo "nothing was lost"
[ -z "$(cut -d ' ' -f 3- killed/sweep-state.txt | grep -o '"kind":"[a-z]*","key":"[^"]*","round":[0-9]*' | sort | uniq -d)" ] &&
  echo "nothing was measured twice"
run sweep missing.glb -o other
# A folder with other things is no report; a scene's name is no option.
mkdir others
touch others/photo.jpg
run sweep a.glb -o others
ls -A others
cp a.glb ./-a.glb
code sweep -o dash --quiet --rounds 1 --samples 500 --budget 1s --want 'deviation<=1, bytes min' -- -a.glb
grep -o 'meshlode build ./-a.glb' dash/sweep.json | sort -u
