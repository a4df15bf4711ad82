#!/bin/sh
# Rebuilds the demo scene: make.sh [BUILD_FOLDER]. Needs Blender 3.4 with numpy, Python 3 with numpy and Pillow (10.1 or
# newer), and PinPose's command line (PINPOSE=… if it is not on the path). Takes half an hour on two cores.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
demo=$(dirname "$here")
build=${1:-$(mktemp -d)}
pinpose=${PINPOSE:-pinpose}
blender=${BLENDER:-blender}
python=${PYTHON:-python3}
export PYTHONDONTWRITEBYTECODE=1

for program in "$blender" "$python" "$pinpose"; do
    command -v "$program" >/dev/null || { echo "make.sh: $program is needed and was not found" >&2; exit 1; }
done

"$python" "$here/label.py" "$build"
"$blender" -b --factory-startup --python-exit-code 1 -P "$here/render.py" -- "$build"
rm -rf "$demo/bop"
"$python" "$here/pack.py" "$build" "$demo" --pinpose "$pinpose"
du -sb "$demo"
