#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the edits of a list on a cluster: task k of the array takes every n-th line, which has IN, OUT and EDIT, separated
# by tabs. Outputs that are newer than mesh and edit are skipped.
#
#   sbatch --array=0-9 slurm_array.sh LIST
#
#SBATCH --job-name=laplacian-edit
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=01:00:00
set -u
tasks=${SLURM_ARRAY_TASK_COUNT:?start this with sbatch --array=0-9} code=0
while IFS=$'\t' read -r in out edit; do
  [[ $out -nt $in && $out -nt $edit ]] || laplacian-edit --quiet "$in" "$out" "$edit" </dev/null || code=$?
done < <(awk -v n="$tasks" -v k="$SLURM_ARRAY_TASK_ID" 'NR % n == k % n' "$1")
exit "$code"
