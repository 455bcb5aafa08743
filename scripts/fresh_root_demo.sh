#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Runs the demo as a new user would: in a fresh, minimal Debian in a separate folder.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/fresh_root_demo.sh [--root FOLDER] [COMMAND]
Must be run as root. Creates a minimal Debian bookworm with debootstrap from this machine's apt sources,
clones this checkout into it (committed files only) and runs scripts/demo.sh and then
scripts/check_demo_cost.sh there. Returns their exit code.
  --root FOLDER   keep the Debian in FOLDER, and reuse it if it exists. Default: a temporary folder
                  (TMPDIR, 4 GB) that is removed at the end
  COMMAND         bash command to run in the cloned checkout instead of the demo and its check
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
if [[ $(id -u) != 0 ]]; then refuse "must be run as root"; fi
for program in debootstrap unshare git; do
  if ! command -v "$program" >/dev/null; then
    refuse "$program not found; run apt-get install debootstrap util-linux git"
  fi
done

# One-line apt sources of bookworm, from whatever format this machine uses, without third-party ones.
# shellcheck disable=SC2016 # expanded by apt
sources=$(apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' \
  'Created-By: Packages' | awk '$3 ~ /^bookworm(-updates|-security)?$/ && $4 == "main"' | sort -u)
mirror=$(awk '$3 == "bookworm" { print $2; exit }' <<<"$sources")
if [[ -z $mirror ]]; then refuse "this machine's apt has no bookworm source"; fi

# The rest runs in separate mount and process namespaces, so that no mounts or processes remain.
make_root() {
  local root=$1 checkout=$2 mirror=$3 sources=$4 include=''
  # 755: apt downloads as a separate user
  chmod 755 "$root"
  if [[ $sources == *"https://"* ]]; then include=--include=ca-certificates; fi
  if ! debootstrap --variant=minbase ${include:+"$include"} bookworm "$root" "$mirror" \
    >"$root/debootstrap.log" 2>&1; then
    tail --lines=5 "$root/debootstrap.log" >&2
    return 1
  fi
  echo "$sources" >"$root/etc/apt/sources.list"
  # Proxy settings of this machine, and date checks in case the mirror is a snapshot.
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
  if [[ -n $(ls --almost-all "$root") ]]; then refuse "$root is neither empty nor created by this script"; fi
  echo "creating a Debian bookworm in $root" >&2
  in_namespace make_root "$root" "$checkout" "$mirror" "$sources"
  echo "created in $SECONDS s" >&2
fi
in_namespace run_in_root "$root" "$command"
