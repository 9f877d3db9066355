#!/usr/bin/env python3
"""How well trajectories agree with a 7-Scenes folder's colour images, without depth and without a reference.

    epipolar_error.py FOLDER TRAJECTORY.txt [TRAJECTORY.txt ...]

Needs python3-opencv. SIFT matches between frames 10, 20, 30 and 40 apart (every 10th frame) that some epipolar geometry
explains; of each trajectory the distance of these from the epipolar lines of its own relative poses (Sampson error, pixels):
median and 75th percentile. Trajectories are in TUM format, of the colour camera; stamps are frame / 30 s. A frame that a
trajectory lacks is left out for all.
"""
import os
import sys

import cv2
import numpy as np

EVERY = 10
STEPS = (1, 2, 3, 4)
RATIO = 0.75  # of the best match's distance to the second best's
FEWEST_MATCHES = 40
INLIER_PX = 2.0


def pose_of(numbers):
    x, y, z, w = np.array(numbers[3:]) / np.linalg.norm(numbers[3:])
    pose = np.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    pose[:3, 3] = numbers[:3]
    return pose


def read_trajectory(path):
    rows = np.loadtxt(path, comments="#", ndmin=2)
    return {round(row[0] * 30): pose_of(row[1:8]) for row in rows}


def read_camera(folder):
    text = open(os.path.join(folder, "camera.yaml")).read()
    color = next(line for line in text.splitlines() if line.startswith("color:"))
    number = lambda name: float(color.split(name + ":")[1].split(",")[0].strip(" }"))
    matrix = np.array([[number("fx"), 0, number("cx")], [0, number("fy"), number("cy")], [0, 0, 1]])
    distortion = [float(x) for x in color.split("distortion:")[1].split("[")[1].split("]")[0].split(",")]
    return matrix, np.array(distortion)


def features(folder, frame, sift, matrix, distortion):
    image = cv2.imread(os.path.join(folder, "frame-%06d.color.jpg" % frame), cv2.IMREAD_GRAYSCALE)
    points, descriptors = sift.detectAndCompute(image, None)
    pixels = np.array([point.pt for point in points])[:, None]
    return cv2.undistortPoints(pixels, matrix, distortion)[:, 0], descriptors


def sampson_px(T_ba, a, b, focal_px):
    t = T_ba[:3, 3]
    essential = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]]) @ T_ba[:3, :3]
    a, b = np.c_[a, np.ones(len(a))], np.c_[b, np.ones(len(b))]
    lines_b, lines_a = a @ essential.T, b @ essential
    scale = np.sqrt((lines_b[:, :2] ** 2).sum(1) + (lines_a[:, :2] ** 2).sum(1))
    return np.abs((b * lines_b).sum(1) / scale) * focal_px


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    folder, paths = sys.argv[1], sys.argv[2:]
    trajectories = {path: read_trajectory(path) for path in paths}
    frames = sorted(f for f in set.intersection(*(set(t) for t in trajectories.values())) if f % EVERY == 0)
    matrix, distortion = read_camera(folder)
    sift, matcher = cv2.SIFT_create(1500), cv2.BFMatcher()
    seen = {frame: features(folder, frame, sift, matrix, distortion) for frame in frames}
    for step in STEPS:
        errors = {path: [] for path in paths}
        for i, j in zip(frames, frames[step:]):
            pairs = [m for m, n in matcher.knnMatch(seen[i][1], seen[j][1], k=2) if m.distance < RATIO * n.distance]
            if len(pairs) < FEWEST_MATCHES:
                continue
            a = seen[i][0][[m.queryIdx for m in pairs]]
            b = seen[j][0][[m.trainIdx for m in pairs]]
            _, inlier = cv2.findEssentialMat(a, b, np.eye(3), cv2.RANSAC, 0.9999, INLIER_PX / matrix[0, 0])
            if inlier is None:
                continue
            keep = inlier.ravel() > 0
            for path, T_WC in trajectories.items():
                errors[path].append(sampson_px(np.linalg.inv(T_WC[j]) @ T_WC[i], a[keep], b[keep], matrix[0, 0]))
        for path, parts in errors.items():
            all_px = np.concatenate(parts)
            print("%3d frames apart, %5d matches: median %.3f px, 75 %% %.3f px  %s"
                  % (step * EVERY, len(all_px), np.median(all_px), np.percentile(all_px, 75), path))


if __name__ == "__main__":
    main()
