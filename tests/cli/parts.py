"""What an entry of a store is made of."""

import json


def parts_of(entry):
    """An entry of a store: its seal, and its parts by name."""
    line, rest = entry.read_bytes().split(b"\n", 1)
    seal, parts = json.loads(line), {}
    for name, size in seal["sizes"].items():
        parts[name], rest = rest[:size], rest[size:]
    return seal, parts
