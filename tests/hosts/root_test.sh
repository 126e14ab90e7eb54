#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tests root.sh with a root that is there already: exit codes, what is mounted, refusals, removal.
#
# usage: root_test.sh ROOT     a root made by root.sh
set -euo pipefail

[ $# -eq 1 ] || { sed -n 's/^# usage: //p' "$0" >&2; exit 2; }
root=$(realpath "$1")
root_sh=$(dirname "$(realpath "$0")")/root.sh
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
failures=0

check() {
  local what=$1
  shift
  if "$@"; then
    echo "ok: $what"
  else
    echo "FAILED: $what"
    failures=$((failures + 1))
  fi
}

# refused SENTENCE COMMAND...: it fails, and says why
refused() {
  local sentence=$1 output status=0
  shift
  output=$("$@" 2>&1) || status=$?
  if [ "$status" -eq 0 ] || ! grep -q "$sentence" <<<"$output"; then
    echo "$output"
    return 1
  fi
}

ends_with() {
  local expected=$1 status=0
  shift
  "$@" || status=$?
  [ "$status" -eq "$expected" ]
}

mounts() {
  sort /proc/self/mountinfo
}
before=$(mounts)

own_mounts() {
  # shellcheck disable=SC2016
  "$root_sh" run "$root" --bind-ro "$place=/given" -- sh -c 'mount | grep -q " /proc " && ! touch /given/file 2>/dev/null'
}
sees_environment() {
  # shellcheck disable=SC2016
  SECRET=1 "$root_sh" run "$root" --env A=b --directory /usr -- sh -c '[ "$A$PWD${SECRET:-}" = b/usr ]'
}
# Killed without a chance to tidy up, it leaves no process and no mount.
leaves_nothing_when_killed() {
  local number=$((RANDOM + 100000)) script
  # So that it does not find itself.
  local pattern="[${number:0:1}]${number:1}"
  # shellcheck disable=SC2016
  "$root_sh" run "$root" --bind "$place=/given" -- sh -c 'touch /given/started; sleep "$0"; true' "$number" &
  script=$!
  for _ in $(seq 100); do
    [ ! -e "$place/started" ] || break
    sleep 0.1
  done
  if [ ! -e "$place/started" ] || ! grep -qs "$pattern" /proc/[0-9]*/cmdline; then
    echo "It did not start."
    return 1
  fi
  kill -KILL "$script"
  wait "$script" 2>/dev/null || true
  for _ in $(seq 100); do
    grep -qs "$pattern" /proc/[0-9]*/cmdline || break
    sleep 0.1
  done
  ! grep -qs "$pattern" /proc/[0-9]*/cmdline && [ "$(mounts)" = "$before" ] && [ -e "$place/started" ]
}
removes() {
  mkdir -p "$place/hosts/sid-clean/etc" "$place/hosts/sid-ccache"
  touch "$place/hosts/sid-clean/.lapedit-root" "$place/hosts/sid-clean.lock"
  LAPEDIT_HOSTS_DIR=$place/hosts "$root_sh" remove "$@" && [ ! -e "$place/hosts/sid-clean" ]
}

check "a command's exit code is the script's" ends_with 7 "$root_sh" run "$root" -- sh -c 'exit 7'
check "a command that dies of a signal" ends_with 143 "$root_sh" run "$root" -- sh -c 'kill -TERM $$'
check "mounts in the root, read-only where asked for" own_mounts
check "a clean environment" sees_environment
check "nothing is left when the script is killed" leaves_nothing_when_killed
check "nothing is mounted afterwards" [ "$(mounts)" = "$before" ]
check "one root is removed" removes sid clean
check "all are removed, with what is kept beside them" removes all
check "and their folder" [ ! -e "$place/hosts" ]

check "a folder that is no root" refused "is no root made by this script" "$root_sh" run "$place" -- true
check "no debootstrap" refused "debootstrap is missing: .*install_dependencies" \
  env PATH=/usr/bin:/bin LAPEDIT_HOSTS_DIR="$place/none" "$root_sh" make sid clean
check "roots can be used" "$root_sh" check
for command in "run $root -- true" "make sid clean" check; do
  # shellcheck disable=SC2086
  check "no right to mount: ${command%% *}" refused "lets nobody make mount namespaces" \
    env LAPEDIT_HOSTS_DIR="$place/none" setpriv --bounding-set=-sys_admin --inh-caps=-sys_admin "$root_sh" $command
done
check "no such release" refused usage "$root_sh" make ../sid clean
check "no such kind" refused usage "$root_sh" make sid dirty

[ "$failures" -eq 0 ] || { echo "$failures failed"; exit 1; }
