#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs the demo as a newcomer does: in a fresh, minimal Debian in a folder of its own.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/fresh_root_demo.sh [--root FOLDER] [COMMAND]
As root. Makes a minimal Debian bookworm by debootstrap, from the sources that this machine's apt
uses, clones this checkout into it (what is committed) and runs scripts/demo.sh there, then
scripts/check_demo_cost.sh. The exit code is theirs.
  --root FOLDER   keep the Debian in FOLDER; one that is there is used again as it was left.
                  Without it, it is made in a temporary folder (TMPDIR) and removed: 4 GB
  COMMAND         for bash, run in the cloned checkout instead of the demo and its check
USAGE
}

refuse() {
  echo "fresh_root_demo.sh: $*" >&2
  exit 2
}

root=''
command='scripts/demo.sh && echo && scripts/check_demo_cost.sh'
while (($# > 0)); do
  case "$1" in
    -h | --help)
      usage
      exit 0
      ;;
    --root)
      if (($# < 2)); then
        usage >&2
        exit 2
      fi
      root=$2
      shift
      ;;
    *)
      if (($# > 1)) || [[ $1 == -* ]]; then
        usage >&2
        exit 2
      fi
      command=$1
      ;;
  esac
  shift
done

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [[ $(id -u) != 0 ]]; then refuse "only root can make another root"; fi
for program in debootstrap unshare git; do
  if ! command -v "$program" >/dev/null; then
    refuse "no $program here; apt-get install debootstrap util-linux git"
  fi
done

# One-line sources of bookworm, however this machine writes them down, without those of others.
# shellcheck disable=SC2016 # apt fills these in
sources=$(apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' \
  'Created-By: Packages' | awk '$3 ~ /^bookworm(-updates|-security)?$/ && $4 == "main"' | sort -u)
mirror=$(awk '$3 == "bookworm" { print $2; exit }' <<<"$sources")
if [[ -z $mirror ]]; then refuse "this machine's apt has no source of bookworm"; fi

# The rest runs in a mount and a process namespace of its own: whatever ends it, nothing stays
# mounted and no process stays behind.
make_root() {
  local root=$1 checkout=$2 mirror=$3 sources=$4 include=''
  # 755: apt fetches as a user of its own
  chmod 755 "$root"
  if [[ $sources == *"https://"* ]]; then include=--include=ca-certificates; fi
  if ! debootstrap --variant=minbase ${include:+"$include"} bookworm "$root" "$mirror" \
    >"$root/debootstrap.log" 2>&1; then
    tail --lines=5 "$root/debootstrap.log" >&2
    return 1
  fi
  echo "$sources" >"$root/etc/apt/sources.list"
  # How this machine reaches its mirror, and whether that is a snapshot of another day.
  apt-config dump Acquire::http::Proxy Acquire::https::Proxy Acquire::Check-Valid-Until \
    Acquire::Check-Date >"$root/etc/apt/apt.conf.d/90machine"
  git clone --quiet "$checkout" "$root/srv/vernier"
  touch "$root/srv/made"
}

run_in_root() {
  local root=$1 command=$2
  cp --dereference /etc/resolv.conf "$root/etc/resolv.conf"
  mount -t proc proc "$root/proc"
  mount -t sysfs sysfs "$root/sys"
  mount --rbind /dev "$root/dev"
  chroot "$root" /usr/bin/env --ignore-environment HOME=/root TERM=dumb LANG=C.UTF-8 \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    bash -c "cd /srv/vernier && $command"
}

in_namespace() {
  unshare --mount --propagation private --pid --fork --kill-child \
    bash -euo pipefail -c "$(declare -f "$1"); \"\$@\"" bash "$@"
}

if [[ -z $root ]]; then
  root=$(mktemp --directory)
  trap 'rm --recursive --force --one-file-system "$root"' EXIT
else
  mkdir --parents "$root"
  root=$(cd "$root" && pwd)
fi
if [[ ! -e $root/srv/made ]]; then
  if [[ -n $(ls --almost-all "$root") ]]; then refuse "$root is neither empty nor such a root"; fi
  echo "making a Debian bookworm in $root" >&2
  in_namespace make_root "$root" "$checkout" "$mirror" "$sources"
  echo "made in $SECONDS s" >&2
fi
in_namespace run_in_root "$root" "$command"
