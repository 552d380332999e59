#!/bin/sh
# A run as Slurm arrays: one array of shards per stage, each after all tasks of the one
# before (afterok), and one job that finishes. Prints the ids of the jobs.
#
#   slurm.sh N WORKSPACE [OPTIONS OF patch_match_stereo...]
#
# SBATCH_OPTIONS: more options of sbatch, such as "--gres=gpu:1 --cpus-per-task=8".
# HPM_MVS: the program. All nodes must see program and workspace under the same path.
# A task whose node dies is put back by Slurm (--requeue) and goes on where it stopped.
set -eu
if [ $# -lt 2 ]; then
  echo "usage: $0 N WORKSPACE [OPTIONS...]" >&2
  exit 2
fi
count=$1 workspace=$2
shift 2
hpm_mvs=${HPM_MVS:-hpm_mvs}
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)

# Exit 8, not complete, is what is expected.
status=$("$hpm_mvs" status --workspace_path "$workspace" --format json "$@") || [ $? -eq 8 ] || exit 3
stages=$(printf '%s' "$status" | grep -o '"name":"[^"]*"' | cut -d'"' -f4)

# The words of a command, quoted for the shell that reads them again.
quoted() {
  for word in "$@"; do
    printf "'%s' " "$(printf '%s' "$word" | sed "s/'/'\\\\''/g")"
  done
}

submit() { # OPTIONS_OF_SBATCH COMMAND
  # shellcheck disable=SC2086 # options are words
  sbatch --parsable --requeue --kill-on-invalid-dep=yes --open-mode=append ${SBATCH_OPTIONS:-} $1 \
    --wrap "HPM_MVS=$(quoted "$hpm_mvs") HPM_TRIES=40 exec sh $2"
}

after=
for stage in $stages; do
  after=$(submit "--job-name=hpm_$stage --array=0-$((count - 1)) ${after:+--dependency=afterok:$after}" \
    "$(quoted "$here/shard.sh") \"\$SLURM_ARRAY_TASK_ID\" $count $(quoted "$workspace" "$@") --Hpm.stage $stage")
  echo "$after"
done
submit "--job-name=hpm_finish --dependency=afterok:$after" \
  "$(quoted "$here/shard.sh") 0 1 $(quoted "$workspace" "$@") --Hpm.stage finish"
