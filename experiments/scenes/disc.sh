#!/usr/bin/env bash
# Writes disc.obj: a disc of radius 0.5 m in the plane y = 0, made of 8 rings of triangles (ring k has 6 k vertices).
# Usage: disc.sh > disc.obj
awk 'BEGIN {
  rings = 8; radius = 0.5; pi = atan2(0, -1)
  print "# A disc of radius 0.5 m: 8 rings of triangles, made by disc.sh"
  print "v 0 0 0"; first[0] = 1; next_vertex = 2
  for (k = 1; k <= rings; ++k) {
    first[k] = next_vertex
    for (m = 0; m < 6 * k; ++m) {
      angle = 2 * pi * m / (6 * k)
      printf "v %.6f 0 %.6f\n", radius * k / rings * cos(angle), -radius * k / rings * sin(angle)
      ++next_vertex
    }
  }
  for (k = 1; k <= rings; ++k)
    for (sector = 0; sector < 6; ++sector)
      for (m = 0; m < k; ++m) {
        outer = sector * k + m; inner = sector * (k - 1) + m
        print "f", at(k, outer), at(k, outer + 1), at(k - 1, inner)
        if (m + 1 < k) print "f", at(k, outer + 1), at(k - 1, inner + 1), at(k - 1, inner)
      }
}
function at(k, m) { return k == 0 ? 1 : first[k] + m % (6 * k) }' | sed 's/-0\.000000/0.000000/g'
