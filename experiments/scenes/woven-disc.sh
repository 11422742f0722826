#!/usr/bin/env bash
# Writes a disc of radius 0.15 m in the plane y = 0: a grid of squares along warp (z) and weft (x) whose outermost vertices are
# moved to the circle.
# Usage: woven-disc.sh > woven-disc.obj (squares of 1 cm); woven-disc.sh 30 > woven-disc-fine.obj (30 in the radius, 5 mm)
awk -v n="${1:-15}" 'BEGIN {
  radius = 0.15; side = radius / n
  printf "# A disc of radius 0.15 m: squares of %g cm, the outermost vertices on the circle, made by woven-disc.sh\n", 100 * side
  for (j = -n; j < n; ++j)
    for (i = -n; i < n; ++i)
      if (side * sqrt((i + 0.5) ^ 2 + (j + 0.5) ^ 2) < radius) {
        kept[i, j] = 1
        ++cells[i, j]; ++cells[i + 1, j]; ++cells[i, j + 1]; ++cells[i + 1, j + 1]
      }
  for (j = -n; j <= n; ++j)
    for (i = -n; i <= n; ++i) {
      if (!cells[i, j]) continue
      number[i, j] = ++count
      scale = cells[i, j] < 4 ? radius / sqrt(i * i + j * j) : side
      printf "v %.6f 0 %.6f\n", scale * i, scale * j
    }
  for (j = -n; j < n; ++j)
    for (i = -n; i < n; ++i)
      if (kept[i, j]) print "f", number[i, j], number[i, j + 1], number[i + 1, j + 1], number[i + 1, j]
}' | sed 's/-0\.000000/0.000000/g'
