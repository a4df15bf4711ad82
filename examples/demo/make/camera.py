"""Cameras and paths in double precision. Knows nothing of Blender.

World: millimetres, z up, the table's top at z = 0. Camera: OpenCV axes, pixel (0, 0) is the centre of the top-left pixel.
"""

import math

import numpy as np

WIDTH, HEIGHT = 960, 720

# Every number here has an exact 32-bit form, so that what the renderer uses is what the files say.
LENS_MM, SENSOR_MM = 43.4375, 36.0
PIXEL_ASPECT = 129.0 / 128.0  # a pixel's height over its width
SHIFT_X, SHIFT_Y = 3.0 / 256.0, -1.0 / 64.0  # of the image's width
FOCUS_FNUMBER = 5.6


def intrinsics():
    """K of the renderer's camera, as Blender documents lens, sensor, aspect and shift.

    Its image plane spans the photo from edge to edge, [0, W] x [0, H], hence the half pixel.
    """
    fx = LENS_MM / SENSOR_MM * WIDTH
    fy = fx / PIXEL_ASPECT
    cx = WIDTH / 2.0 - SHIFT_X * WIDTH - 0.5
    cy = HEIGHT / 2.0 + SHIFT_Y * WIDTH / PIXEL_ASPECT - 0.5
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def look_at(azimuth_deg, elevation_deg, distance, target, roll_deg):
    """camera_from_world as (R, t). Azimuth 0 looks along +y; positive goes to the right around the table."""
    azimuth, elevation, roll = map(math.radians, (azimuth_deg, elevation_deg, roll_deg))
    target = np.array(target, float)
    away = np.array(
        [math.sin(azimuth) * math.cos(elevation), -math.cos(azimuth) * math.cos(elevation), math.sin(elevation)]
    )
    position = target + distance * away
    forward = -away
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    c, s = math.cos(roll), math.sin(roll)
    rotation = np.array([c * right + s * down, -s * right + c * down, forward])
    return rotation, -rotation @ position


# Azimuth, elevation, distance, roll: small steps first (about 3 degrees), then 12 to 18 degrees apart.
STATIC_VIEWS = [
    (-33.0, 30.0, 800.0, -1.2),
    (-30.2, 30.4, 796.0, -0.8),
    (-27.3, 31.2, 790.0, -0.1),
    (-24.6, 31.5, 786.0, 0.6),
    (-21.9, 32.2, 780.0, 0.4),
    (-19.0, 32.4, 778.0, 0.9),
    (-6.0, 34.0, 765.0, 0.2),
    (6.5, 33.0, 770.0, -1.0),
    (19.0, 31.0, 790.0, -0.4),
    (33.5, 28.0, 800.0, 1.1),
    (48.0, 26.0, 810.0, 1.8),
    (60.0, 33.0, 790.0, 0.5),
    (46.0, 43.0, 770.0, -2.4),
    (29.0, 49.0, 760.0, -1.0),
    (9.0, 53.0, 750.0, 3.0),
    (-12.0, 46.0, 700.0, -3.5),
]
TARGET = (5.0, 5.0, 38.0)


def static_cameras():
    return [look_at(a, e, d, TARGET, r) for a, e, d, r in STATIC_VIEWS]


def moving_cameras():
    """On a tripod."""
    return [look_at(-9.0, 36.0, 790.0, (10.0, -15.0, 35.0), 0.7)] * 12


def rotation_z(angle_deg):
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


# Where the objects stand: (x, y, height of the origin over the table, heading in degrees).
PLACES = {
    1: (-112.0, 72.0, 64.0, 24.0),
    2: (52.0, 124.0, 85.4, 0.0),
    3: (128.0, -92.0, 17.0, 11.0),
    4: (92.0, 42.0, 48.0, -38.0),
    5: (-62.0, -44.0, 32.0, -28.0),
}
CAR = 5


def world_from_object(place):
    x, y, z, heading = place
    return rotation_z(heading), np.array([x, y, z])


def static_poses():
    return [{obj_id: world_from_object(place) for obj_id, place in PLACES.items()}] * len(STATIC_VIEWS)


def moving_poses():
    """The car drives a bend from the left to the front, turning as it goes; all else stays."""
    frames = []
    for i in range(12):
        t = i / 11.0
        s = t * t * (3.0 - 2.0 * t) * 0.5 + t * 0.5
        x = -172.0 + 165.0 * s
        y = -20.0 - 135.0 * math.sin(s * math.pi * 0.62)
        # Along the path's tangent.
        slope = math.atan2(-135.0 * math.pi * 0.62 * math.cos(s * math.pi * 0.62), 165.0)
        places = dict(PLACES)
        places[CAR] = (x, y, 32.0, math.degrees(slope))
        frames.append({obj_id: world_from_object(place) for obj_id, place in places.items()})
    return frames


def sequences():
    """Scene id: (camera_from_world per frame, world_from_object per frame and object)."""
    return {1: (static_cameras(), static_poses()), 2: (moving_cameras(), moving_poses())}
