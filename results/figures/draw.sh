#!/usr/bin/env bash
# Draws the pictures of this folder again, byte for byte on one machine. Usage: draw.sh [FOLDER]
# Our side is as published: one substep, the links in the scene's own order.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=${1:-$here}
taut=$here/../../taut
ours=jakobsen:substeps=1,order=mesh,iterations=

mkdir -p "$folder"
"$taut" render cape --solver ${ours}16 --solver bullet:iterations=16 --solver pd --at 1 --size 1920x720 -o "$folder/cape.png"
