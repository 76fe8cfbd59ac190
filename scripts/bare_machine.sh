#!/usr/bin/env bash
# Proves the two commands on a bare Debian: makes a root with nothing but Python, make and git, clones the checkout into
# it and runs `make test` and `make run`, as root and as an ordinary user. Needs root and debootstrap.
#
#   scripts/bare_machine.sh [ROOT]          default ROOT: /tmp/volviz-bare; an existing base in ROOT.base is used again
#
#   SUITE   Debian suite (bookworm); with OPTIONS also one of Ubuntu
#   OPTIONS more options of debootstrap, for example "--components=main,universe"
#   MIRROR  Debian mirror (default: the first one in apt's own configuration)
#   BINDS   folders of this machine to show in the root, read-only (for example a folder of wheels)
#   TESTS   arguments for pytest, for a short look ("tests/unit/test_version.py"); default: all tests
#   KEEP    1 leaves the root in place
#
# Configuration of apt and pip, proxies and certificates are those of this machine.
set -euo pipefail

root=${1:-/tmp/volviz-bare}
suite=${SUITE:-bookworm}
tests=${TESTS:-}
checkout=$(cd "$(dirname "$0")/.." && pwd)

first_mirror() {
    {
        cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null | sed -n 's/^deb \(\[[^]]*\] \)\?\([^ ]*\) .*/\2/p'
        cat /etc/apt/sources.list.d/*.sources 2>/dev/null | sed -n 's/^URIs: *\([^ ]*\).*/\1/p'
    } | grep -m1 '/debian/*$'
}

say() { printf '\n== %s\n' "$*"; }

mounts=()
show() {  # show SOURCE TARGET OPTIONS...
    mkdir -p "$2"
    mount "${@:3}" "$1" "$2"
    mounts+=("$2")
}
finish() {
    for ((i = ${#mounts[@]} - 1; i >= 0; i--)); do umount "${mounts[i]}" || umount -l "${mounts[i]}" || true; done
    if [ "${KEEP:-}" != 1 ] && ! grep -q " $root/" /proc/mounts; then rm -rf --one-file-system "$root"; fi
}
trap finish EXIT

[ "$(id -u)" = 0 ] || { echo "scripts/bare_machine.sh needs root (debootstrap and chroot)." >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "debootstrap is missing: apt-get install debootstrap" >&2; exit 2; }
[ ! -e "$root" ] || { echo "$root exists; remove it or name another folder." >&2; exit 2; }

if [ ! -d "$root.base" ]; then
    mirror=${MIRROR:-$(first_mirror)}
    say "debootstrap $suite from $mirror"
    # OPTIONS is a list of words.
    # shellcheck disable=SC2086
    debootstrap --variant=minbase --include=python3,make,git,ca-certificates ${OPTIONS:-} \
        "$suite" "$root.base" "$mirror" >/dev/null
fi
cp -a --reflink=auto "$root.base" "$root"

say "Configuration of apt, pip, names and certificates"
cp -a /etc/apt/apt.conf.d/*prox* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
cp -L /etc/pip.conf "$root/etc/" 2>/dev/null || true
cp -a /usr/local/share/ca-certificates/. "$root/usr/local/share/ca-certificates/"
chroot "$root" update-ca-certificates >/dev/null 2>&1

show proc "$root/proc" -t proc
show tmpfs "$root/dev/shm" -t tmpfs
for folder in ${BINDS:-}; do show "$folder" "$root$folder" --bind -o ro; done

# Nothing of this machine's environment but proxies, pip's settings and the file of certificates.
settings=(LANG=C.UTF-8 TERM=dumb PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
while IFS='=' read -r name value; do settings+=("$name=$value"); done < <(env | grep -iE '^(https?_proxy|no_proxy|PIP_[A-Z_]+|SSL_CERT_FILE)=' || true)

within() { chroot "$root" env -i "${settings[@]}" HOME=/root bash -c "$1"; }
offline() { unshare --net chroot "$root" env -i "${settings[@]}" HOME=/root bash -c "$1"; }
as_user() { chroot --userspec=1000:1000 "$root" env -i "${settings[@]}" HOME=/home/newcomer bash -c "$1"; }
failed=()
step() {  # step NAME COMMAND...: run, time and note the outcome; go on in any case
    say "$1"
    local start=$SECONDS status=0
    "${@:2}" || status=$?
    echo "-- status $status after $((SECONDS - start)) s"
    [ "$status" = 0 ] || failed+=("$1")
}
refused() {  # refused COMMAND...: succeeds when the command stops with make's status 2
    local status=0
    "$@" || status=$?
    [ "$status" = 2 ]
}

git clone -q --no-hardlinks "$checkout" "$root/root/volviz"
chroot "$root" useradd -m -u 1000 newcomer
git clone -q --no-hardlinks "$checkout" "$root/home/newcomer/volviz"
chroot "$root" chown -R 1000:1000 /home/newcomer

step "An ordinary user without sudo: make test prints the command and stops" refused as_user 'cd ~/volviz && make test'
step "An ordinary user without sudo: make run prints the command and stops" refused as_user 'cd ~/volviz && make run'
step "root: make run (no display), the first time; it installs only what drawing needs" \
    within 'cd /root/volviz && make run && ls -l out'
step "root: make test, the first time" within "cd /root/volviz && make test ARGS='$tests'"
step "root: make test, the second time, without network" offline "cd /root/volviz && make test ARGS='$tests'"
step "An ordinary user, once the libraries are there: make run" as_user 'cd ~/volviz && make run && ls -l out'
step "An ordinary user, once the libraries are there: make test" as_user "cd ~/volviz && make test ARGS='$tests'"

if [ ${#failed[@]} -gt 0 ]; then
    printf '\nFailed: %s\n' "${failed[@]}" >&2
    exit 1
fi
say "The bare machine passes."
