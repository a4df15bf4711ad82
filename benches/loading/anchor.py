"""Loads a mesh's file with trimesh several times. Called by the benchmark `loading`."""

import json
import sys
import time

import trimesh

path, repetitions = sys.argv[1], int(sys.argv[2])
seconds = []
for _ in range(repetitions):
    start = time.perf_counter()
    # As it is in the file: no merging of vertices, which ours does not do either.
    mesh = trimesh.load(path, force="mesh", process=False)
    seconds.append(time.perf_counter() - start)
print(json.dumps({"version": trimesh.__version__, "seconds": min(seconds), "triangles": len(mesh.faces)}))
