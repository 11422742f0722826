#!/usr/bin/env python3
"""A program that passes the probe and misbehaves in the fifth step of any other scene, as MODE says; MODE hello-* misbehaves
at once, and MODE random SEED damages one of its answers."""

import array
import json
import os
import pathlib
import random
import struct
import subprocess
import sys
import time

MODE = sys.argv[1]
OUT = sys.stdout.buffer
CHANCE = random.Random(sys.argv[2] if MODE == "random" else 0)
left = CHANCE.choice([0, 0, *range(1, 14)]) if MODE == "random" else -1  # answers until the damaged one


def answer(told, more=b""):
    global left
    text = json.dumps(told).encode() + b"\n" + more
    if left == 0:
        sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "fuzz"))
        text = __import__("generate").mutate(CHANCE, text)
    left -= real
    OUT.write(text)
    OUT.flush()


real = True  # a scene that is not part of the probe


def spin(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def misbehave():
    if MODE == "hang":
        time.sleep(1000)
    if MODE == "flood":
        while True:
            OUT.write(b"x" * 65536)
    if MODE == "lines":
        while True:
            OUT.write(b"{}\n" * 10000)
    if MODE == "exit":
        print("enough of this", file=sys.stderr)
        os._exit(3)
    if MODE == "abort":
        os.abort()
    if MODE == "garbage":
        OUT.write(b"step 5 done, residual 1e-3\n")
        OUT.flush()
    if MODE == "close":
        os.close(1)
        time.sleep(1000)
    if MODE == "memory":
        hoard = []
        while True:
            hoard.append(bytearray(1 << 24))
    if MODE == "error":
        answer({"error": "the matrix is singular"})
    if MODE == "fork":
        for words in (["sleep", "1000"], ["setsid", "-f", "sleep", "1001"]):
            subprocess.Popen(words, stdout=subprocess.DEVNULL)
        subprocess.Popen(["sleep", "1002"], start_new_session=True)


def main():
    if MODE == "hello-hang":
        time.sleep(1000)
    if MODE == "hello-garbage":
        print("Loading model...", flush=True)
    global real
    n = x = v = gravity = None
    steps = queue = 0
    for line in sys.stdin.buffer:
        request = json.loads(line)
        op = request["op"]
        real = n != 16
        if op == "hello":
            answer({"protocol": "taut-solver/1", "name": "hostile", "version": MODE})
        elif op == "scene":
            scene = json.load(open(request["file"]))
            if scene["pin_motions"]:
                answer({"cannot": ["pins that move"]})
                continue
            n, gravity, w, steps = scene["vertices"], scene["gravity"], scene["inverse_mass"], 0
            answer({"vertices": n})
        elif op == "load":
            queue = 0
            values = array.array("d", sys.stdin.buffer.read(request["bytes"]))
            x, v = values[:3 * n], values[3 * n:]
            answer({})
        elif op == "step":
            steps += request["count"]
            if real and steps == 5:
                misbehave()
            if real and MODE == "lie":
                spin(0.002 * request["count"])
            if real and MODE == "slow":
                spin(0.002)
            if real and MODE == "later":
                queue += request["count"]
            for k in range(3 * n * request["count"]):
                k %= 3 * n
                if w[k // 3] > 0:
                    v[k] += request["dt"] * gravity[k % 3]
                    x[k] += request["dt"] * v[k]
            if real and MODE == "nan" and steps == 5:
                x[7] = float("nan")
            if not (real and steps == 5 and MODE in ("garbage", "error")):
                answer({"cpu_ns": 1000} if MODE == "lie" else {})
        elif op == "store":
            spin(0.01 if real and MODE == "slow" else 0.002 * queue)
            queue = 0
            state = x.tobytes() + v.tobytes()
            if real and steps == 5 and MODE == "half":
                answer({"bytes": len(state)}, state[:len(state) // 2])
                time.sleep(1000)
            elif real and steps == 5 and MODE == "size":
                answer({"bytes": 48}, struct.pack("<6d", *range(6)))
            else:
                answer({"bytes": len(state)}, state)


main()
