#!/usr/bin/env bash
# Presses the Stereo button of COLMAP's window on a virtual display, as a person would, and
# waits until the maps are there. The places of the buttons are those of COLMAP 3.8 and
# 3.12 with Debian's Qt 5.
# usage: press_stereo_button.sh COLMAP WORKSPACE PICTURE. All images of the workspace are
# references. PICTURE, a .png, shows the window while it computes. SECONDS_TO_WAIT: 1200 unless
# given. Exit code 77 (= skipped) without the programs of scripts/install_dependencies.sh --gui.
set -euo pipefail
colmap=$(realpath "${1:?usage: press_stereo_button.sh COLMAP WORKSPACE PICTURE}")
workspace=$(realpath "${2:?usage: press_stereo_button.sh COLMAP WORKSPACE PICTURE}")
picture=${3:?usage: press_stereo_button.sh COLMAP WORKSPACE PICTURE}

for program in Xvfb xdotool scrot; do
  command -v "$program" >/dev/null || {
    echo "skipped: no $program; run scripts/install_dependencies.sh --gui" >&2
    exit 77
  }
done

# The button is grey until these are there; COLMAP's image_undistorter makes them.
mkdir -p "$workspace"/stereo/{depth_maps,normal_maps,consistency_graphs}
fail() { echo "FAILED: $*; see $workspace/gui.log and $workspace/xvfb.log" >&2; exit 1; }
home=$(mktemp -d) # for the settings of the window
gui='' xvfb=''
stop() {
  [[ -z $gui ]] || { kill "$gui" 2>/dev/null && wait "$gui"; } || true
  [[ -z $xvfb ]] || kill "$xvfb" 2>/dev/null || true
  rm -rf "$home"
}
trap stop EXIT

exec 3< <(exec Xvfb -displayfd 1 -screen 0 1280x800x24 +extension GLX 2>"$workspace/xvfb.log")
xvfb=$!
read -r -t 20 number <&3 || fail "no virtual display"
export DISPLAY=:$number
HOME=$home LIBGL_ALWAYS_SOFTWARE=1 "$colmap" gui >"$workspace/gui.log" 2>&1 &
gui=$!

window() { # NAME: the window of that name, once it shows
  timeout 60 xdotool search --sync --onlyvisible --name "^$1$" | tail -1
}
press() { xdotool mousemove --window "$1" "$2" "$3" click 1; sleep 1; } # WINDOW X Y

main=$(window COLMAP) || fail "COLMAP's window does not show"
sleep 3 # until it is drawn
press "$main" 431 38 # Dense reconstruction
dense=$(window 'Dense reconstruction') || fail "no window for dense reconstruction"
press "$dense" 750 23 # the field of the workspace
xdotool type --delay 20 "$workspace"
press "$dense" 866 23 # Refresh
press "$dense" 145 23 # Stereo
sleep 5
scrot --overwrite "$picture"

wanted=$(find "$workspace/images" -type f | wc -l)
for ((second = 0; second < ${SECONDS_TO_WAIT:-1200}; ++second)); do
  kill -0 "$gui" 2>/dev/null || fail "the window is gone"
  [[ $(find "$workspace/stereo/depth_maps" -name '*.geometric.bin' | wc -l) == "$wanted" ]] && break
  sleep 1
done
[[ $(find "$workspace/stereo/normal_maps" -name '*.geometric.bin' | wc -l) == "$wanted" ]] ||
  fail "not all maps are there after $second s"
