#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs Debian's colmap on the fisheye pictures of a studio take, beside `mixrig learn`.

usage: colmap.py TAKE WORK    WORK: a new folder
Prints the pictures with a pose, the error of the camera centres after alignment by similarity, and
the time. colmap is given the true lens (OPENCV_FISHEYE).
"""
import math, os, re, subprocess, sys, time


def camera_of(take):
    text = open(os.path.join(take, "truth/calibration.toml")).read()
    table = re.search(r"\[cameras\.fisheye\](.*?)(?=\n\[|\Z)", text, re.S).group(1)
    number = lambda key: float(re.search(rf"^{key} = (\S+)", table, re.M).group(1))
    lens = re.search(r"distortion = \[([^]]*)\]", table).group(1).split(",")
    k = [float(v) for v in lens if v.strip()] + [0.0] * 4
    return [number("fx"), number("fy"), number("cx"), number("cy")] + k[:4]


def colmap(work, command, *words):
    subprocess.run(["colmap", command, *words], check=True, stdout=subprocess.DEVNULL,
                   env=dict(os.environ, QT_QPA_PLATFORM="offscreen"))


def reconstruct(take, work):
    data = os.path.join(work, "database.db")
    # Pixel (0, 0) is the corner of the first pixel there, its middle here.
    f = camera_of(take)
    f[2] += 0.5
    f[3] += 0.5
    threads = os.environ.get("THREADS", "1")
    colmap(work, "feature_extractor", "--database_path", data, "--image_path",
           os.path.join(take, "fisheye"), "--ImageReader.single_camera", "1",
           "--ImageReader.camera_model", "OPENCV_FISHEYE", "--ImageReader.camera_params",
           ",".join(map(str, f)), "--SiftExtraction.use_gpu", "0",
           "--SiftExtraction.num_threads", threads)
    colmap(work, "sequential_matcher", "--database_path", data, "--SiftMatching.use_gpu", "0",
           "--SiftMatching.num_threads", threads)
    sparse = os.path.join(work, "sparse")
    os.makedirs(sparse)
    colmap(work, "mapper", "--database_path", data, "--image_path", os.path.join(take, "fisheye"),
           "--output_path", sparse, "--Mapper.ba_refine_focal_length", "0",
           "--Mapper.ba_refine_extra_params", "0", "--Mapper.num_threads", threads)
    best = {}
    for model in sorted(os.listdir(sparse)):
        folder = os.path.join(sparse, model)
        colmap(work, "model_converter", "--input_path", folder, "--output_path", folder,
               "--output_type", "TXT")
        centres = read_centres(os.path.join(folder, "images.txt"))
        best = max(best, centres, key=len)
    return best


def turn(q, v):
    """v turned by the unit quaternion q = (w, x, y, z)."""
    w, u = q[0], q[1:]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                          a[0] * b[1] - a[1] * b[0]]
    t = [2 * c for c in cross(u, v)]
    c = cross(u, t)
    return [v[i] + w * t[i] + c[i] for i in range(3)]


def read_centres(path):
    """Camera centres by picture, from camera_from_map."""
    lines = [line for line in open(path) if not line.startswith("#")]
    centres = {}
    for line in lines[::2]:
        cells = line.split()
        q, t = [float(c) for c in cells[1:5]], [float(c) for c in cells[5:8]]
        inverse = [q[0], -q[1], -q[2], -q[3]]
        centres[int(re.search(r"\d+", cells[9]).group())] = [-c for c in turn(inverse, t)]
    return centres


def rms_after_similarity(a, b):
    """Of b - (s R a + t), by the quaternion of the largest eigenvalue (Horn 1987)."""
    mean = lambda p: [sum(v[i] for v in p) / len(p) for i in range(3)]
    ma, mb = mean(a), mean(b)
    a = [[v[i] - ma[i] for i in range(3)] for v in a]
    b = [[v[i] - mb[i] for i in range(3)] for v in b]
    s = [[sum(p[i] * q[j] for p, q in zip(a, b)) for j in range(3)] for i in range(3)]
    n = [[s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
         [0, s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
         [0, 0, s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
         [0, 0, 0, s[2][2] - s[0][0] - s[1][1]]]
    shift = sum(abs(v) for row in n for v in row) + 1e-30
    n = [[n[min(i, j)][max(i, j)] + (shift if i == j else 0) for j in range(4)] for i in range(4)]
    q = [1.0, 0.1, 0.2, 0.3]
    for _ in range(20000):
        q = [sum(n[i][j] * q[j] for j in range(4)) for i in range(4)]
        length = math.sqrt(sum(c * c for c in q))
        q = [c / length for c in q]
    turned = [turn(q, v) for v in a]
    scale = (sum(x * y for p, r in zip(turned, b) for x, y in zip(p, r)) /
             sum(x * x for p in turned for x in p))
    return math.sqrt(sum((scale * x - y) ** 2 for p, r in zip(turned, b) for x, y in zip(p, r)) /
                     len(a))


def main():
    take, work = sys.argv[1:3]
    os.makedirs(work)
    truth = [[float(c) for c in line.split()[1:4]]
             for line in open(os.path.join(take, "truth/fisheye.tum")) if not line.startswith("#")]
    wall, used = time.monotonic(), os.times()
    centres = reconstruct(take, work)
    now = os.times()
    cpu = now.children_user + now.children_system - used.children_user - used.children_system
    numbers = sorted(centres)
    true = [truth[i - 1] for i in numbers]
    rms = rms_after_similarity([centres[i] for i in numbers], true)
    extent = max(math.dist(p, q) for p in true for q in true)
    print(f"{len(numbers)} of {len(truth)} pictures have a pose; {1e3 * rms:.2f} mm RMS, "
          f"{100 * rms / extent:.2f} % of {extent:.3f} m; {cpu:.0f} s of processor time, "
          f"{time.monotonic() - wall:.0f} s")


main()
