# SPDX-License-Identifier: GPL-3.0-or-later
# Another tier without a build: the bytes of a build with that tier, from every tier to every other.
for scene in ${SCENES:-city foliage rock}; do
  cp "$DATA/$scene.glb" .
  for tier in qem measured certified; do
    "$MESHLODE" build --quiet "$scene.glb" -o "$scene.$tier.lode" --error-tier "$tier" || echo "no build: $scene $tier"
  done
  for from in qem measured certified; do
    for to in qem measured certified; do
      "$MESHLODE" measure --quiet "$scene.$from.lode" --source "$scene.glb" --error-tier "$to" -o out.lode ||
        echo "failed: $scene, $from to $to"
      cmp out.lode "$scene.$to.lode" || echo "other bytes: $scene, $from to $to"
      rm -f out.lode
    done
  done
done
rm -f city.* crystal.* terrain.*
# Aggregates, a codec, settings of a mesh, threads.
same() { # options of the build
  for tier in qem certified; do
    "$MESHLODE" build --quiet "$scene" -o "$tier.lode" --error-tier "$tier" "$@" || echo "no build: $*"
  done
  "$MESHLODE" measure --quiet qem.lode --source "$scene" --error-tier certified -o out.lode --jobs 1 &&
    cmp out.lode certified.lode && code validate --quiet out.lode
  rm -f out.lode qem.lode certified.lode
}
scene=foliage.glb
same --aggregate auto --codec none
scene=rock.glb
same --codec strips --lock-borders --grid 0.01
same --preset fast --attributes all --normal-error 2
"$MESHLODE" measure rock.qem.lode --source rock.glb -o out.lode | sed 's/[0-9a-f]\{32\}/HASH/'
cmp out.lode rock.measured.lode
code verify --quiet --quick out.lode --source rock.glb
rm out.lode

run measure rock.qem.lode
run measure rock.qem.lode --source rock.glb
run measure rock.qem.lode --source rock.glb -o c.lode --error-tier best
run measure rock.qem.lode --source rock.glb -o c.glb
run measure rock.glb --source rock.qem.lode -o c.lode
run measure rock.qem.lode --source missing.glb -o c.lode
run measure missing.lode --source rock.glb -o c.lode
# Over what it reads.
run measure rock.qem.lode --source rock.glb -o rock.qem.lode
ln -s rock.qem.lode link
run measure rock.qem.lode --source rock.glb -o link
cp rock.glb source.lode
run measure rock.qem.lode --source source.lode -o source.lode
# Another scene, a changed one, and one that is forced.
for tier in qem certified; do
  run measure rock.qem.lode --source foliage.glb -o c.lode --error-tier $tier
  run measure rock.qem.lode --source foliage.glb -o c.lode --error-tier $tier --force
done
run measure --quiet foliage.qem.lode --source foliage.glb -o c.lode --repair
rm c.lode
cp rock.glb other.glb
printf '\077' | dd of=other.glb bs=1 seek=300003 conv=notrunc status=none  # of the image
run measure rock.qem.lode --source other.glb -o c.lode | sed 's/([0-9a-f]*)/(HASH)/g'
code measure --quiet rock.qem.lode --source other.glb -o c.lode --force
cmp c.lode rock.measured.lode
rm c.lode
# More than positions is promised.
code build --quiet rock.glb -o texels.lode --promise texels
run measure texels.lode --source rock.glb -o c.lode
# Damage: refused, or a byte that nothing reads.
for size in 0 1 127 128 1000 5000 20000; do
  head -c "$size" rock.qem.lode >short.lode
  code measure --quiet short.lode --source rock.glb -o c.lode
done
last=$(($(wc -c <rock.qem.lode) - 1)) refused=0
for i in $(seq 0 19); do
  cp rock.qem.lode changed.lode
  at=$((i * last / 19))
  byte=$(od -An -tu1 -j $at -N 1 rock.qem.lode)
  printf "\\$(printf %o $((byte ^ 16)))" | dd of=changed.lode bs=1 seek=$at conv=notrunc status=none
  "$MESHLODE" measure --quiet changed.lode --source rock.glb -o c.lode 2>../stderr
  case $? in
    0) rm c.lode ;;
    3) refused=$((refused + 1)) ;;
    *) echo "byte $at: $(cat ../stderr)" ;;
  esac
done
[ $refused -ge 15 ] && echo "changed bytes: refused"
rm changed.lode
run measure rock.qem.lode --source rock.glb -o no/such/c.lode --max-decoded 0x
files
