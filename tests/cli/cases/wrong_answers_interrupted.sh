# SPDX-License-Identifier: GPL-3.0-or-later
# A batch that is interrupted or killed has its manifest and its JUnit file: what was built, and the rest as skipped.
mkdir in; cp "$DATA/city.glb" in/a.glb; cp "$DATA/city.glb" in/b.glb; cp "$DATA/crystal.glb" in/c.glb; cp "$DATA/rock.glb" in/d.glb
# The third takes long enough to be caught.
slow=(--preset best --error-tier certified --jobs 1)
# stop SIGNAL ARGS…: a batch that is sent a signal once its manifest tells of two assets
stop() {
  local signal=$1 status; shift
  env "--default-signal=INT" "$MESHLODE" build --quiet in -O out --manifest m.json --junit j.xml "${slow[@]}" "$@" 2>../stderr &
  local child=$!
  for _ in $(seq 1000); do [ "$(grep -cE '"(complete": false|status": "built")' m.json 2>/dev/null)" = 3 ] && break; sleep 0.02; done
  { kill "-$signal" "$child"; wait "$child"; status=$?; } 2>../killed
  echo "$signal $*: exit $status, $(grep -c '^meshlode: ' ../stderr) line(s)"
  "$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <m.json
  grep -E '"(exit_code|complete|status|error|index)"' m.json
  grep -E 'tests=|skipped|failure' j.xml | sed -E 's/time="[^"]*"/time=/g'
}
stop INT
rm m.json j.xml
stop TERM
echo "whole"
code build --quiet in -O out --manifest m.json --junit j.xml --preset fast
grep -E '"(complete|status|error)"' m.json
echo "what an earlier run told is not taken for this one's"
stop KILL
rm -f out/.meshlode-*.tmp
ls out
echo "a shard's manifest is there when the shard is complete, and only then; its JUnit file tells meanwhile"
rm -r out m.json j.xml
"$MESHLODE" build --quiet in -O out --manifest m.json --junit j.xml "${slow[@]}" --shard 1/1 & child=$!
for _ in $(seq 1000); do [ "$(grep -c 'skipped message' j.xml 2>/dev/null)" = 2 ] && break; sleep 0.02; done
{ kill -KILL $child; wait $child; } 2>../killed
grep -c 'interrupted' j.xml
ls m.json 2>/dev/null
code build --quiet in/a.glb in/b.glb -O out --manifest m.json --fail-fast --preset fast
grep -c '"complete": true' m.json
# A file that a scene is made of is not written over, not even for the time being.
printf 'data' >in/p.json
printf '{"asset":{"version":"2.0"},"images":[{"uri":"p.json"}]}' >in/e.gltf
code build --quiet in/a.glb in/e.gltf -O out --manifest in/p.json
cat in/p.json; echo
rm in/e.gltf
# Devices and pipes take one text.
"$MESHLODE" build --quiet in/a.glb in/b.glb -O out --manifest /dev/stdout | grep -c '"complete"'
rm -f out/.meshlode-*.tmp ./.meshlode-*.tmp
