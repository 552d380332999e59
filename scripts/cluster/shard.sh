#!/bin/sh
# One shard's share of a run, with the patience that a cluster needs: waits while maps of
# other shards are not there yet (exit 8), and while the lock of a process that died with
# its machine expires (exit 7). Exit codes are those of hpm_mvs, but 0 in place of 4 (some
# images cannot be computed), which must not stop the others; `finish` says it in the end.
#
#   shard.sh I N WORKSPACE [OPTIONS OF patch_match_stereo...]
#
# HPM_MVS: the program. HPM_WAIT: seconds between tries (30). HPM_TRIES: how many tries
# in a row may find nothing to do (2880: a day).
set -u
if [ $# -lt 3 ]; then
  echo "usage: $0 I N WORKSPACE [OPTIONS...]" >&2
  exit 2
fi
index=$1 count=$2 workspace=$3
shift 3
tries=${HPM_TRIES:-2880}
while :; do
  "${HPM_MVS:-hpm_mvs}" patch_match_stereo --workspace_path "$workspace" \
    --Hpm.shard "$index/$count" "$@"
  code=$?
  case $code in
  7 | 8) ;;
  4) case " $* " in *" finish "* | *"stage=finish "*) exit 4 ;; esac; exit 0 ;;
  *) exit $code ;;
  esac
  tries=$((tries - 1))
  if [ $tries -le 0 ]; then exit $code; fi
  sleep "${HPM_WAIT:-30}"
done
