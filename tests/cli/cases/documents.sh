# SPDX-License-Identifier: GPL-3.0-or-later
# What README and the tutorials show of the program's output is what it prints.
# shown DOCUMENT: each line of the document's blocks that is no command begins a line of ../said, but for times and for what
# "…" stands for. Blocks with a language are programs and settings.
shown() {
  awk '
    function plain(line) {
      gsub(/, [0-9]+\.[0-9]+ s$/, ", T", line)
      sub(/…$/, "", line)
      sub(/ +$/, "", line)
      return line
    }
    FNR == NR { said[++count] = plain($0); next }
    /^ *```./ { in_program = 1; next }
    /^ *```$/ { if (in_program) in_program = 0; else in_block = !in_block; next }
    !in_block || /^ *(\$ |meshlode [a-z]+( |$)|tools\/|export |mkdir |cp |--|ninja |cmake |first_frame )/ || /^ *…?$/ { next }
    in_block && !/ # / {
      line = plain($0); found = 0; checked++
      for (i = 1; i <= count && !found; i++) found = index(said[i], line) == 1
      if (!found) print "not printed: " line
    }
    END { print (checked > 2 ? "several" : checked) " lines were looked for" }
  ' ../said "$REPOSITORY/$1"
}
mkdir data art art/props
cp "$DATA/rock.glb" "$DATA/crystal.glb" data
cp "$DATA/city.glb" art
cp "$DATA/crystal.glb" "$DATA/rock.glb" art/props
limit='totals.bytes_per_source_triangle>9.5, totals.stuck_groups>0'
{
  "$MESHLODE" build data/rock.glb -o rock.lode
  "$MESHLODE" info rock.lode
  "$MESHLODE" verify rock.lode --source data/rock.glb
  "$MESHLODE" verify rock.lode --source data/crystal.glb
  "$MESHLODE" info rock.lode --quiet --fail-if 'totals.bytes_per_source_triangle>5, any(meshes).stuck_groups>0'
  "$MESHLODE" build data/rock.glb --fail-if 'totals.stuck_group>0'
  for turn in first second; do
    "$MESHLODE" build 'art/**/*.glb' -O assets --cache .meshlode-cache --fail-if "$limit"
  done
  "$MESHLODE" info assets/props/rock.lode
  echo '{"normal-error": 1}' >art/meshlode.json
  "$MESHLODE" build art/ -O assets --cache .meshlode-cache --dry-run
} >../said 2>&1
"$MESHLODE" build art/ -O assets --cache .meshlode-cache --fail-if "$limit" --quiet
echo "with wider normals: exit $?"
for document in README.md docs/tutorials/first-asset.md docs/tutorials/ci.md docs/guides/reading-info.md docs/guides/budgets.md; do
  echo "$document"
  shown "$document"
done
