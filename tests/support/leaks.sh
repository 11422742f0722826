#!/usr/bin/env bash
# Runs a command whose leaks are looked for when it ends; once more if the search itself crashed ("Tracer caught signal 11"), which
# says nothing about the command: it happens to a thread that ends while the search looks at it.
said=$(mktemp)
trap 'rm -f "$said"' EXIT
"$@" 2> >(tee "$said" >&2)
status=$?
if [[ $status != 0 ]] && grep -q "LeakSanitizer has encountered a fatal error" "$said"; then
  exec "$@"
fi
exit "$status"
