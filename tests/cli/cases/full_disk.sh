# SPDX-License-Identifier: GPL-3.0-or-later
# A full disk, a read-only folder, a limit on file sizes: exit 2, one line, no temporary file, and the old file as it was.
mkdir full readonly
# In a mount namespace of its own, which takes its mounts with it; in a chroot, which cannot have one, root mounts here.
apart=()
for way in "unshare -m" "unshare -rm" env; do
  # shellcheck disable=SC2086
  $way sh -c 'mount -t tmpfs none full && umount full' 2>/dev/null && { read -ra apart <<<"$way"; break; }
done
[ ${#apart[@]} -ne 0 ] || skip "no file system can be mounted here"
cp "$DATA/city.glb" a.glb
code build --quiet a.glb -o a.lode
export MESHLODE
export -f code files
"${apart[@]}" bash -uc '
  trap "umount full readonly" EXIT
  mount -t tmpfs -o size=16k none full
  echo old >full/old.out
  for output in full/new.out full/old.out; do
    code build --quiet a.glb -o "$output"
    code render a.lode -o "$output" --size 640x480
    code extract a.lode --error 0 -o "$output"
    code extract a.lode --lods 2 -o "$output"
  done
  code build --quiet a.glb -O full/below
  head -c 10k /dev/zero >full/fill
  code build --quiet a.glb -o b.lode --report full/report.json
  cat full/old.out
  rm full/fill
  mount -t tmpfs none readonly; echo old >readonly/old.lode; mount -o remount,ro readonly
  code build --quiet a.glb -o readonly/new.lode
  code build --quiet a.glb -o readonly/old.lode
  code build --quiet a.glb -O readonly/below
  code build --quiet a.glb -o c.lode --report readonly/report.json
  code render a.lode -o readonly/new.png --size 16x16
  code extract a.lode --error 0 -o readonly/new.glb
  code verify a.lode --source a.glb --gpu --out-dir readonly --cuts 1 --cameras 1
  cat readonly/old.lode
  files'
