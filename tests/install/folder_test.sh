#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# folder_test.sh PART BUILD_FOLDER SOURCE: the relocatable folder of tools/package/folder.sh builds data/rock.glb to the bytes of
# the build's own program. PART
#   here   moved, with a space in its path, started by a link and by a relative path; its libraries are its own, with licences
#   roots  in a root that has nothing else, and in a bare Debian 11 (by debootstrap); these need root
#   npm    as the package that npm packs, by npx in an empty folder
set -euo pipefail
part=$1 build=$(cd "$2" && pwd) source=$(cd "$3" && pwd)
skip() { echo "SKIPPED: $*"; exit 77; }
fail() { echo "FAILED: $*"; exit 1; }
command -v dpkg-query >/dev/null || skip "not Debian: no dpkg"
case $part in
  roots)
    [ "$(id -u)" -eq 0 ] || skip "needs root"
    command -v debootstrap >/dev/null || skip "no debootstrap" ;;
  npm) command -v npx >/dev/null || skip "no npx" ;;
esac
work=$(mktemp -d /var/tmp/meshlode-folder.XXXXXX)
chmod 755 "$work"
trap 'rm -rf --one-file-system "$work"' EXIT
"$source/tools/package/folder.sh" "$build" "$work/meshlode"
cp "$source/data/rock.glb" "$work/"
cd "$work"
"$build/meshlode" build --quiet rock.glb -o expected.lode

# use ROOT PROGRAM: builds, verifies and draws there; --gpu ends with 5 where there is no Vulkan loader
use() {
  local root=$1 program=$2 status=0 said
  cp rock.glb "$root/"
  chroot "$root" "$program" build --quiet --cache cache rock.glb -o rock.lode
  cmp expected.lode "$root/rock.lode" || fail "other bytes in $root"
  chroot "$root" "$program" build --cache cache rock.glb -o rock.lode 2>&1 | grep -F "up to date" || fail "not known again in $root"
  chroot "$root" "$program" verify --quiet --quick rock.lode --source rock.glb
  chroot "$root" "$program" render rock.lode -o rock.png --size 64x64
  if [ -e "$build/npm/meshlode.wasm" ]; then chroot "$root" "$program" info rock.lode --html page.html --quiet; fi
  said=$(chroot "$root" "$program" render rock.lode -o gpu.png --gpu 2>&1) || status=$?
  [ $status -eq 5 ] && [[ $said == *"no Vulkan loader"*libvulkan.so.1* ]] || fail "--gpu: exit code $status: $said"
  chroot "$root" "$program" --version | grep '^build id  *[0-9a-f]\{32\}$' || fail "no build id in $root"
}

case $part in
  here)
    mkdir -p "else where/deep"
    mv meshlode "else where/"
    ln -s meshlode/bin/meshlode "else where/link"
    program="else where/meshlode/bin/meshlode"
    "$program" build --quiet rock.glb -o here.lode && cmp expected.lode here.lode
    (cd "else where/deep" && ../link build --quiet ../../rock.glb -o link.lode && cmp ../../expected.lode link.lode)
    PATH="$work/else where/meshlode/bin:$PATH" meshlode build --quiet rock.glb -o path.lode && cmp expected.lode path.lode
    MESHLODE_LIBC=host "$program" build --quiet rock.glb -o host.lode && cmp expected.lode host.lode
    # Libraries of the host want its libc, which the folder does not start: they are left out.
    for name in LD_PRELOAD LD_AUDIT; do
      env "$name=/nowhere/host.so" "$PWD/$program" --version >said 2>&1 || fail "$name stops the program"
      grep -F host.so said && fail "$name reaches the program"
    done
    # What the loader expands.
    for folder in 'a$LIB' 'a:b' 'a;b'; do
      cp -r "else where/meshlode" "$folder"
      said=$("$folder/bin/meshlode" --version 2>&1) && fail "it runs from $folder"
      [[ $said == *"cannot run from a path with"* ]] || fail "$folder: $said"
      rm -r "$folder"
    done
    # It starts itself again, which a program that the kernel knows as its loader finds no other way.
    "$program" sweep rock.glb -o sweep --knobs simplifier --budget 1s >/dev/null
    grep -q '"file_bytes"' sweep/sweep.json || fail "sweep measured nothing"

    # Without its launcher it says so.
    mv "$program" launcher
    folder="$PWD/else where/meshlode"
    said=$("$folder/lib/libc/ld-linux-x86-64.so.2" --library-path "$folder/lib:$folder/lib/libc" "$folder/libexec/meshlode" \
      sweep rock.glb -o none --knobs simplifier --budget 1s 2>&1) && fail "sweep without its launcher succeeds"
    [[ $said == *"$program"* ]] || fail "without a launcher: $said"
    mv launcher "$program"

    folder="else where/meshlode"
    loaded=$("$folder/lib/libc/ld-linux-x86-64.so.2" --list --library-path "$folder/lib:$folder/lib/libc" "$folder/libexec/meshlode")
    echo "$loaded" | grep -F '=>' | grep -vF "=> $folder/lib/" && fail "the libraries above are not the folder's"
    readelf -lW "$folder/bin/meshlode" | grep -q INTERP && fail "the launcher is not static"
    [ "$(find "$folder" -name '*.so*' | wc -l)" -ge 16 ] || fail "too few libraries"
    while read -r package _; do
      [ -s "$folder/licences/libraries/$package.txt" ] || fail "no licence of $package"
    done < <(sed '1,2d' "$folder/licences/LIBRARIES.txt")
    for needed in libc6 libstdc++6 libtbb12 libmetis5 libcgal-dev; do
      grep -q "^$needed [^ ]*, source " "$folder/licences/LIBRARIES.txt" || fail "$needed is not named"
    done
    grep -q '://' "$folder/licences/LIBRARIES.txt" && fail "an address of a package archive"
    # A library that is missing is named.
    mkdir bin && printf '#!/bin/sh\nldd.real "$@"; echo "	libnowhere.so.1 => not found"\n' | sed "s|ldd.real|$(command -v ldd)|" >bin/ldd
    chmod +x bin/ldd
    PATH="$work/bin:$PATH" "$source/tools/package/folder.sh" "$build" "$work/lacking" >said 2>&1 && fail "a library that is missing is left out"
    grep -F libnowhere.so.1 said
    # A folder of somebody else's stays.
    mkdir other && touch other/mine
    "$source/tools/package/folder.sh" "$build" other >/dev/null 2>&1 && fail "another folder was replaced"
    [ -e other/mine ] || fail "another folder was emptied" ;;
  roots)
    echo "== nothing but the folder: no shell, no /proc, no /dev"
    mkdir empty && cp -r meshlode empty/
    use empty /meshlode/bin/meshlode
    sources() { find /etc/apt -name '*.list' -o -name '*.sources'; }
    mirror=$(sources | xargs -r grep -hE "^(URIs:|deb )" | sed -E "s/^(URIs:|deb) +(\[[^]]*\] +)?([^ ]+).*/\3/; 1!d" || true)
    [ -n "$mirror" ] || skip "apt knows no mirror"
    debootstrap --variant=minbase bullseye bullseye "$mirror" >log 2>&1 || skip "no Debian 11 from $mirror: $(tail -n 1 log)"
    echo "== Debian $(cat bullseye/etc/debian_version), $(grep -aom 1 "GNU C Library [^,]*version [0-9.]*[0-9]" bullseye/lib/x86_64-linux-gnu/libc.so.6)"
    mkdir -p bullseye/opt && cp -r meshlode bullseye/opt/
    use bullseye /opt/meshlode/bin/meshlode
    echo "== the container file, but for its base"
    rm -r bullseye/opt/meshlode
    while read -r instruction arguments; do
      echo "$instruction $arguments"
      case $instruction in
        FROM) [ "$arguments" = debian:12-slim ] || fail "a base that this test does not know" ;;
        COPY) cp -r "${arguments% *}" "bullseye${arguments##* }" ;;
        ENV) [[ $arguments == PATH=* ]] && path=${arguments#PATH=} ;;
        WORKDIR) mkdir -p "bullseye$arguments" && cp rock.glb "bullseye$arguments/" && folder=$arguments ;;
        ENTRYPOINT | CMD) declare "$instruction=$(tr -d '[]",' <<<"$arguments")" ;;
        *) fail "an instruction that this test does not know" ;;
      esac
    done < <(grep -v '^#' "$source/.github/Dockerfile")
    inside() { env -i PATH="$path" chroot bullseye /bin/sh -ec "cd $folder && $ENTRYPOINT $1"; }
    inside "$CMD" | grep '^meshlode converts' || fail "no help"
    inside "build --quiet rock.glb -o again.lode" && cmp expected.lode "bullseye$folder/again.lode" ;;
  npm)
    (cd "$work" && npm pack --silent ./meshlode)
    package=$(echo "$work"/meshlode-cli-*.tgz)
    mkdir empty && cp rock.glb empty/
    # The registry is out of reach: the tarball is all that it takes.
    export npm_config_cache=$work/cache npm_config_registry=http://localhost:9/ npm_config_update_notifier=false
    (cd empty && npx --yes --package "$package" meshlode build --quiet rock.glb -o rock.lode)
    cmp expected.lode empty/rock.lode
    npm install --silent --global --prefix "$work/prefix" "$package"
    prefix/bin/meshlode build --quiet rock.glb -o global.lode && cmp expected.lode global.lode
    echo "$(basename "$package"): $(stat -c %s "$package") bytes" ;;
  *) fail "no part $part" ;;
esac
echo "PASSED: $part"
