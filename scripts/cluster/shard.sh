#!/bin/sh
# One shard's share of a run, with the patience that a cluster needs: waits while maps of
# other shards are not there yet (exit 8), and while the lock of a process that died with
# its machine expires (exit 7). A process that was killed, as systems short of memory do, is
# started again; it goes on where it was. Exit codes are those of hpm_mvs, but 0 in place of
# 4 (some images cannot be computed), which must not stop the others; `finish` says it in
# the end.
#
#   shard.sh I N WORKSPACE [OPTIONS OF patch_match_stereo...]
#
# HPM_MVS: the program. HPM_WAIT: seconds between tries (30). HPM_TRIES: how many tries
# may find nothing to do (2880: a day). HPM_RESTARTS: how often a killed process is
# started again (3).
set -u
if [ $# -lt 3 ]; then
  echo "usage: $0 I N WORKSPACE [OPTIONS...]" >&2
  exit 2
fi
index=$1 count=$2 workspace=$3
shift 3
tries=${HPM_TRIES:-2880}
restarts=${HPM_RESTARTS:-3}
while :; do
  "${HPM_MVS:-hpm_mvs}" patch_match_stereo --workspace_path "$workspace" \
    --Hpm.shard "$index/$count" "$@"
  code=$?
  case $code in
  7 | 8) ;;
  4) case " $* " in *" finish "* | *"stage=finish "*) exit 4 ;; esac; exit 0 ;;
  129 | 130 | 143) exit $code ;; # it was asked to stop
  *)
    if [ $code -lt 128 ] || [ "$restarts" -le 0 ]; then exit $code; fi
    restarts=$((restarts - 1))
    echo "$0: the process of shard $index/$count was killed by signal $((code - 128)); starting it again" >&2
    continue
    ;;
  esac
  tries=$((tries - 1))
  if [ $tries -le 0 ]; then exit $code; fi
  sleep "${HPM_WAIT:-30}"
done
