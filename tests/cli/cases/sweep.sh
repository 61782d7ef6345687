# SPDX-License-Identifier: GPL-3.0-or-later
# sweep: a report of a small scene; measured once, it is the same when asked for again; killed, it goes on.
cp "$DATA/crystal.glb" a.glb
code sweep a.glb -o report --quiet --rounds 2 --samples 500 --budget 2s
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <report/sweep.json
cp report/sweep.csv first.csv
code sweep a.glb -o report --quiet --rounds 2 --samples 500 --budget 2s
cmp first.csv report/sweep.csv && echo "the same table"
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <report/sweep.json
ls report
# A picture that is gone is drawn again, and nothing else is measured; what lies in the folder stays.
mkdir report/work
touch report/work/mine
gone=$(ls report/pictures | head -n 1)
rm "report/pictures/$gone"
code sweep a.glb -o report --quiet --rounds 2 --samples 500 --budget 2s
[ -s "report/pictures/$gone" ] && cmp first.csv report/sweep.csv && ls -A report
# So are all where nothing more may be measured.
cp "$DATA/city.glb" city.glb
code sweep city.glb -o short --quiet --rounds 1 --samples 200 --budget 1s
ls short/pictures >drawn.txt
rm short/pictures/*
code sweep city.glb -o short --quiet --rounds 1 --samples 200 --budget 1s
ls short/pictures | cmp - drawn.txt && echo "drawn again"
# At the time that it took first: the plan is made by it, and would be another.
grep -o '"kind":"draw","key":"[^"]*","round":0,"seconds":[^,]*' short/sweep-state.txt | sort -u | sed 's/,"round".*//' | uniq -d
# What is recommended keeps what was wished.
json sweep sweep a.glb -o report --rounds 2 --samples 500 --budget 2s --want 'deviation<=1, bytes min' --format json
# Killed twice on its way: nothing that was finished is measured again, and the rest is.
mkdir killed
touch killed/sweep-state.txt
for wait in 0.5 1; do
  timeout -s TERM "$wait" "$MESHLODE" sweep a.glb -o killed --quiet --rounds 1 --samples 500 --budget 2s 2>/dev/null
done
cp killed/sweep-state.txt before.txt
code sweep a.glb -o killed --quiet --rounds 1 --samples 500 --budget 2s
head -c "$(stat -c %s before.txt)" killed/sweep-state.txt | cmp - before.txt && echo "nothing was lost"
[ -z "$(cut -d ' ' -f 3- killed/sweep-state.txt | grep -o '"kind":"[a-z]*","key":"[^"]*","round":[0-9]*' | sort | uniq -d)" ] &&
  echo "nothing was measured twice"
run sweep missing.glb -o other
# A folder with other things is no report; a scene's name is no option; what the scene itself calls for is doctor's word.
mkdir others
touch others/photo.jpg
run sweep a.glb -o others
ls -A others
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 2 0\nf 1 2 3\nf 1 2 3\nf 1 3 4\n' >./-a.obj
code sweep -o dash --quiet --rounds 1 --samples 500 --budget 1s --want 'deviation<=1, bytes min' -- -a.obj
grep -o 'meshlode build ./-a.obj' dash/sweep.json | sort -u
"$JSON_CHECK" "$SCHEMAS/sweep.schema.json" <dash/sweep.json
"$MESHLODE" doctor ./-a.obj --format json | tr -d ' \n' | sed 's/.*"faults":\(.*\),"failed_on".*/\1/' >said
tr -d ' \n' <dash/sweep.json | sed 's/.*"faults":\(.*\)},"knobs".*/\1/' | cmp - said && grep -o '"id":"[a-z-]*"' said
grep -o '<strong>triangles without area.*</p>\|hard case <code>.*</code>' dash/index.html
