#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Does the jobs of a list on a cluster: each task of the array takes every n-th of them. The same command again does
# what is left.
#
#   sbatch --array=0-9 slurm_array.sh LIST [FOLDER_FOR_LOGS]
#
#SBATCH --job-name=laplacian-edit
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=01:00:00
#SBATCH --signal=B:TERM@60
set -eu

list=$1
logs=${2:-laplacian-edit-logs}
tasks=${SLURM_ARRAY_TASK_COUNT:?start this with sbatch --array=0-9}
task=$(((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN) / ${SLURM_ARRAY_TASK_STEP:-1}))
mkdir -p "$logs"
part=$logs/$((task + 1))-of-$tasks

awk -v tasks="$tasks" -v task="$task" '!/^#/ && NF { if (n++ % tasks == task) print }' "$list" >"$part.tsv"
# In place of the shell, so that the scheduler's signals reach it.
exec "${LAPLACIAN_EDIT:-laplacian-edit}" --list "$part.tsv" --jobs "${SLURM_CPUS_PER_TASK:-1}" \
  --job-log "$part.jsonl" --resume
