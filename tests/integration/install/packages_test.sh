#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# packages_test.sh BUILD: the Debian packages of this build. They install on a bare Debian 12 (debootstrap, as root, with
# a mirror), run and replay the crane there, complete, show a manual page, and leave nothing when they are purged. Where
# that system cannot be made, their contents alone are checked, and the crane runs from the unpacked folder.
set -euo pipefail
build=$1
scratch=$(mktemp -d)
mounts=()
clean() {
  local mount
  for mount in "${mounts[@]}"; do umount --lazy "$mount"; done
  rm -rf --one-file-system "$scratch"
}
trap clean EXIT
fail() {
  echo "$*" >&2
  exit 1
}
command -v dpkg-shlibdeps > /dev/null || { echo "SKIPPED: there is no dpkg-shlibdeps (package dpkg-dev)"; exit; }

# ---- contents
cd "$build"
cpack -G DEB -B "$scratch/packages" > "$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
# `uninstall` would remove the files of an installed package
compgen -G 'install_manifest_*.txt' && fail "cpack leaves the list of its staged files"
version=$("$build/bin/slewring" --version --json | sed -n 's/.*"version": "\(.*\)".*/\1/p')
declare -A names=([slewring]=slewring_${version}_$(dpkg --print-architecture) \
                  [libslewring-client-dev]=libslewring-client-dev_${version}_$(dpkg --print-architecture) \
                  [slewring-doc]=slewring-doc_${version}_all)
for package in "${!names[@]}"; do
  file=$scratch/packages/${names[$package]}.deb
  [ -f "$file" ] || fail "there is no ${names[$package]}.deb: $(ls "$scratch/packages")"
  dpkg-deb --contents "$file" > "$scratch/contents"
  awk '$2 != "root/root" {print; exit 1}' "$scratch/contents" || fail "$package: files of another owner"
  awk '{print substr($6, 1, 6)}' "$scratch/contents" | grep -vxE '\./|\./usr/?' && fail "$package: files outside of /usr"
  for part in copyright changelog.gz; do
    grep -q " ./usr/share/doc/$package/$part$" "$scratch/contents" || fail "$package: no $part"
  done
  for field in Maintainer Description Section; do
    [ -n "$(dpkg-deb --field "$file" $field)" ] || fail "$package: no field $field"
  done
  dpkg-deb --extract "$file" "$scratch/unpacked"
done
depends=$(dpkg-deb --field "$scratch/packages/${names[slewring]}.deb" Depends)
for library in libc6 libddsc0debian libfmt9 libyaml libsundials libassimp5; do
  grep -q "$library" <<< "$depends" || fail "slewring does not depend on $library: $depends"
done
[ -z "$(dpkg-deb --field "$scratch/packages/${names[slewring-doc]}.deb" Depends)" ] || fail "slewring-doc has dependencies"

# ---- the program, wherever it was unpacked
crane='run truck_crane.yaml --pace free --duration 0.5s --domain'
(cd "$scratch" && unpacked/usr/bin/slewring $crane 97 --out "$scratch/runs" > /dev/null) || fail "unpacked: no crane"

# ---- a bare system
if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap > /dev/null; then
  echo "without a bare system: that needs root and debootstrap"
  exit
fi
bare=$scratch/bare
mirror=$(sed -n 's/^deb \(\[[^]]*\] \)\?\([^ ]*debian\/\?\) .*/\2/p; s/^URIs: \([^ ]*debian\/\?\)$/\1/p' \
           /etc/apt/sources.list /etc/apt/sources.list.d/* 2> /dev/null | head -1) || true  # one of them may be missing
if ! debootstrap --variant=minbase bookworm "$bare" ${mirror:+"$mirror"} > "$scratch/log" 2>&1; then
  tail -3 "$scratch/log"
  echo "without a bare system: debootstrap cannot make one here"
  exit
fi
mount -t proc proc "$bare/proc"
mounts=("$bare/proc")
cp "$scratch/packages/"*.deb "$bare/root/"
inside() { chroot "$bare" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
before=$(inside find / -xdev -path '*slewring*' -not -path '/root/*')
inside sh -c 'apt-get install -y --no-install-recommends man-db /root/*.deb' > "$scratch/log" 2>&1 ||
  { tail -20 "$scratch/log"; fail "the packages cannot be installed"; }
inside sh -c "cd /root && slewring $crane 98 --no-record" > "$scratch/log" 2>&1 || { cat "$scratch/log"; fail "no crane"; }
inside sh -c "cd /root && slewring $crane 98 && slewring replay runs/* --verify && slewring plot runs/* -o a.svg" \
  > "$scratch/log" 2>&1 || { cat "$scratch/log"; fail "no replay or plot"; }
grep -q 'equal bit for bit' "$scratch/log" || fail "the replay does not verify"
offered=$(inside slewring --complete run truck_crane_c)
grep -q truck_crane_contact.yaml <<< "$offered" || fail "no completion of scenes: $offered"
inside bash -c 'source /usr/share/bash-completion/completions/slewring; complete -p slewring' > /dev/null ||
  fail "no completion in bash"
[ -f "$bare/usr/share/man/man1/slewring-run.1" ] || fail "no manual page"
inside sh -c 'apt-get purge -y slewring libslewring-client-dev slewring-doc' > "$scratch/log" 2>&1 || fail "no purge"
left=$(inside find / -xdev -path '*slewring*' -not -path '/root/*')
[ "$left" = "$before" ] || fail "left behind: $left"
echo "installed, run and removed on a bare system"
