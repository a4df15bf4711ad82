"""Runs the project.py of an export as its users would, and prints what it projects.

    python3 project_all.py EXPORT FILE [FOLDER]

FILE is in the folder EXPORT, as project.py takes it. Prints a list of {photo, object, pixels}, of every 50th vertex; where
OpenCV is there, its projectPoints has to say the same.
"""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, sys.argv[1])
import project

try:
    import cv2
except ImportError:
    cv2 = None

found = []
for photo, name, vertices, pose, K, distortion in project.poses(Path(sys.argv[1]) / sys.argv[2], *sys.argv[3:4]):
    pixels = project.project(vertices, pose, K, distortion)
    if cv2 is not None:
        lens = np.zeros(5) if distortion is None else np.array(distortion)
        theirs, _ = cv2.projectPoints(vertices, cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3], K, lens)
        # Rodrigues' vector and back costs some digits.
        assert np.abs(theirs[:, 0] - pixels).max() < 1e-6, (photo, name)
    found.append({"photo": photo, "object": name, "pixels": pixels[::50].tolist()})

# Every .npy holds the matrix that poses.json has.
listed = json.loads((Path(sys.argv[1]) / "poses.json").read_text())
checked = 0
for photo in listed["photos"]:
    if photo["k_npy"] is not None:
        assert (np.load(Path(sys.argv[1]) / photo["k_npy"]) == np.array(photo["K"])).all()
    for pose in photo["poses"]:
        if pose["npy"] is not None:
            assert (np.load(Path(sys.argv[1]) / pose["npy"]) == np.array(pose["matrix"])).all()
            checked += 1

print(json.dumps({"opencv": None if cv2 is None else cv2.__version__, "npy": checked, "poses": found}))
