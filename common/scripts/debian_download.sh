#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Downloads packages of any Debian release from the mirror of this machine's apt sources, with apt's check of signatures. The
# system's own apt sources and lists are not changed, and nothing is installed.
#
# usage: debian_download.sh SUITE FOLDER PACKAGE...     a package's .deb, PACKAGE:arm64 for another processor than this one; for
#                                                       src:PACKAGE the upstream tarball of its source
set -eu

[ $# -ge 3 ] || { sed -n '/^# usage/,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
suite=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
shift 2
# shellcheck disable=SC2016
mirror=$(apt-get indextargets --format '$(REPO_URI) $(COMPONENT) $(ORIGIN)' 2>/dev/null |
  awk '$2 == "main" && $3 == "Debian" && $1 !~ /security/ { print $1; exit }')
[ -n "$mirror" ] || { echo "debian_download.sh: apt knows no Debian mirror; run apt-get update first." >&2; exit 1; }

apt=$(mktemp -d)
trap 'rm -rf "$apt"' EXIT
mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$apt/parts"
: >"$apt/status"
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
for type in deb deb-src; do
  echo "$type [signed-by=$keyring] $mirror $suite main"
done >"$apt/sources.list"
# A mirror may be a snapshot, whose lists are no longer valid by their dates.
cat >"$apt/apt.conf" <<END
Dir::Etc::sourcelist "$apt/sources.list";
Dir::Etc::sourceparts "$apt/parts";
Dir::State::lists "$apt/lists";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
APT::Sandbox::User "root";
APT::Architectures { $(dpkg --print-architecture);$(printf '%s\n' "$@" | sed -n '/^src:/d; s/.*:\(.*\)/ \1;/p' | sort -u | tr -d '\n') };
Acquire::Check-Valid-Until "false";
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
END
export LC_ALL=C.UTF-8
apt-get -c "$apt/apt.conf" -q update >"$apt/log" 2>&1 || { cat "$apt/log" >&2; exit 1; }
cd "$folder"
for package in "$@"; do
  case $package in
  src:*) apt-get -c "$apt/apt.conf" -q source --download-only --tar-only "${package#src:}" ;;
  *) apt-get -c "$apt/apt.conf" -q download "$package" ;;
  esac >"$apt/log" 2>&1 || { cat "$apt/log" >&2; exit 1; }
done
