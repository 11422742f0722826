#!/usr/bin/env bash
# Draws the pictures of this folder again, byte for byte on one machine. Usage: draw.sh [FOLDER]
# Our side is as published: one substep, the links in the scene's own order.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=${1:-$here}
taut=$here/../../taut
ours=jakobsen:substeps=1,order=mesh,iterations=

mkdir -p "$folder"
"$taut" render ball --solver ${ours}16 --solver bullet:iterations=16 --at 1 --size 1280x720 -o "$folder/ball.png"
"$taut" render hang --solver ${ours}4 --solver bullet:iterations=4 --solver ${ours}64 --solver bullet:iterations=64 \
  --at 2 --size 1080x1080 -o "$folder/hang.png"
"$taut" render box --solver ${ours}16 --solver bullet:iterations=16 --at 1 --colour penetration --size 1280x720 \
  -o "$folder/box-penetration.png"
