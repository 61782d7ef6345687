#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# bare_root_test.sh CPACK BUILD_FOLDER SOURCE: the packages where nothing else is. In a bare Debian 12 the program
# is installed and used, and with the packages for developers the examples of
# docs/reference/api.md and a stranger's project are built and run.
set -euo pipefail
cpack=$1 build=$2 source=$3
skip() { echo "SKIPPED: $*"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "needs root"
for tool in debootstrap unshare chroot file dpkg-shlibdeps; do
  command -v "$tool" >/dev/null || skip "no $tool"
done
# Mounts are this process's own, and end with it.
if [ -z "${MESHLODE_OWN_MOUNTS:-}" ]; then
  unshare --mount true 2>/dev/null || skip "may not mount"
  MESHLODE_OWN_MOUNTS=yes exec unshare --mount --propagation private "$0" "$@"
fi
fail() { echo "FAILED: $*"; exit 1; }
work=$(mktemp -d /var/tmp/meshlode-packages.XXXXXX)
chmod 755 "$work"
root=$work/root
trap 'umount -l "$root/proc" "$root/dev" 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT

echo "== packages"
"$cpack" --config "$build/CPackConfig.cmake" -B "$work/debs" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

echo "== a bare Debian 12"
sources() { find /etc/apt -name '*.list' -o -name '*.sources'; }
mirror=$(sources | xargs -r grep -hE "^(URIs:|deb )" | sed -E "s/^(URIs:|deb) +(\[[^]]*\] +)?([^ ]+).*/\3/; 1!d" || true)
[ -n "$mirror" ] || skip "apt knows no mirror"
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$work/log" 2>&1 || skip "no Debian from $mirror: $(tail -n 1 "$work/log")"
# What the machine knows about mirrors and proxies; docker's own image has as much.
rm -f "$root/etc/apt/sources.list"
cp -r /etc/apt/sources.list /etc/apt/sources.list.d /etc/apt/apt.conf.d "$root/etc/apt/" 2>/dev/null || true
cp -r /usr/share/keyrings/. "$root/usr/share/keyrings/" 2>/dev/null || true
cp /etc/resolv.conf /etc/hosts "$root/etc/" 2>/dev/null || true
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev" && mount --make-rslave "$root/dev"
folder=/
inside() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" chroot "$root" /bin/sh -ec "cd $folder && $1" </dev/null
}

echo "== the program"
mkdir -p "$root/packages" "$root/work"
cp "$work/debs"/*.deb "$root/packages/"
inside "apt-get update && apt-get install -y --no-install-recommends /packages/meshlode_*.deb" >"$work/log" 2>&1 ||
  { cat "$work/log"; fail "the package of the program does not install"; }
folder=/work
cp "$source/data/crystal.glb" "$root$folder/"
inside "meshlode --version"
inside "meshlode build --quiet crystal.glb -o crystal.lode --codec none"
inside "meshlode repack crystal.lode -o strips.lode --codec strips"
inside "meshlode build --quiet crystal.glb -o built.lode --codec strips && cmp built.lode strips.lode"
inside "meshlode validate strips.lode && meshlode verify strips.lode --source crystal.glb --quick --quiet"

echo "== programs against libmeshlode-dev"
mkdir -p "$root/examples"
cp -r "$source/tests/api"/{example.cpp,c_example.c,c_build_example.c} "$source/tests/install/consumer" "$root/examples/"
inside "apt-get update && apt-get install -y --no-install-recommends /packages/*.deb g++ cmake make" >"$work/log" 2>&1 ||
  { cat "$work/log"; fail "the packages do not install"; }
folder=/examples
# The lines of docs/guides/packages.md themselves.
while read -r line; do
  echo "$line"
  inside "$line"
done < <(grep -E '^(c\+\+|cc) ' "$source/docs/guides/packages.md")
inside "./example example.lode"
inside "./c_example example.lode"
inside "./c_build_example"
inside "ldd ./c_example" | grep -F libmeshlode.so.0 || fail "the C example does not use libmeshlode.so.0"
inside "cmake -S consumer -B b >/dev/null && cmake --build b" >"$work/log" 2>&1 || { cat "$work/log"; fail "the consumer"; }
inside "b/use_build triangle.lode && b/use_runtime triangle.lode && b/use_c triangle.lode"

echo "== and gone again"
inside "apt-get purge -y meshlode libmeshlode0 libmeshlode-dev" >"$work/log" 2>&1 || { cat "$work/log"; fail "purge"; }
left=$(inside "find /usr /etc /var -name '*meshlode*' -not -path '/var/log/*'")
[ -z "$left" ] || fail "left behind: $left"
echo "PASSED"
