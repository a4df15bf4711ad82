"""Solves 2D-3D problems with OpenCV: SQPNP, then Levenberg-Marquardt. Called by the benchmark `solvers`."""

import json
import sys
import time

import cv2
import numpy as np

cv2.setNumThreads(1)
with open(sys.argv[1], encoding="utf-8") as file:
    problems = json.load(file)
camera = np.array(problems["K"])
answers = []
for problem in problems["problems"]:
    points = np.array(problem["points"])
    pixels = np.array(problem["pixels"])
    start = time.perf_counter()
    found, turn, shift = cv2.solvePnP(points, pixels, camera, None, flags=cv2.SOLVEPNP_SQPNP)
    if found:
        turn, shift = cv2.solvePnPRefineLM(points, pixels, camera, None, turn, shift)
    seconds = time.perf_counter() - start
    if not found:
        answers.append({"seconds": seconds, "pose": None})
        continue
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(turn)[0]
    pose[:3, 3] = shift.ravel()
    answers.append({"seconds": seconds, "pose": pose.tolist()})
with open(sys.argv[2], "w", encoding="utf-8") as file:
    json.dump({"version": cv2.__version__, "answers": answers}, file)
